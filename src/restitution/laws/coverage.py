"""The law of a pair whose surfaces have been run in, from COR at several coverages."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace
from typing import cast

import numpy as np

from restitution.errors import CaseError, DomainError
from restitution.laws.law import QUANTILES, CoveredPoint, Law, LawPoint, Quantiles
from restitution.repeated.points import RunInPoint

_SAME = 0.02  # coverages whose difference is below this share of the largest one count as equal


def covered_points(points: Sequence[RunInPoint]) -> tuple[CoveredPoint, ...]:
    """What a law keeps of the results of repeated impacts."""
    return tuple(
        CoveredPoint(
            velocity=point.velocity,
            coverage=point.coverage,
            restitution=point.restitution,
            error=point.total_error
            if math.isfinite(point.total_error)
            else math.hypot(point.places_error, point.solver_error),
            deviation=point.restitution_std,
            quantiles=cast(Quantiles, tuple(getattr(point, f"restitution_{q}") for q in QUANTILES)),
            indentation=point.indentation,
            force=point.force,
            pull_off_force=point.pull_off_force,
        )
        for point in points
    )


def coverage_of(text: str) -> float:
    """The coverage that a text such as "3" gives. Raises `CaseError`."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not 0 <= value < math.inf:
        raise CaseError(f'coverage: "{text}" is not 0 or a positive number, such as 3')
    return value


def at_coverage(law: Law, coverage: float) -> Law:
    """The law of the same pair at `coverage`, without fits.

    COR is linear in the coverage between those of the run; its error is the larger one of both.
    Raises `CaseError` if the run had no repeated impacts, and `DomainError` outside its coverages.
    """
    if law.coverage is not None and math.isclose(law.coverage, coverage):
        return law
    if not law.run_in:
        raise CaseError(
            f"coverage: the law of {law.pair} is that of one coverage only; add [impacts] "
            f"coverage = {coverage or 1:g} to its case and run it again"
        )
    points = [_point(law, point, coverage) for point in law.points if _of(law, point.velocity)]
    if not points:
        raise CaseError(f"coverage: {law.pair} has no velocity with repeated impacts; run it again")
    covered = replace(
        law,
        points=tuple(points),
        coverage=coverage,
        run_in=(),
        sticks_below_error=None,
        fit=None,
        laws=(),
    )
    return replace(covered, sticks_below=covered.curve().begins())


def _of(law: Law, velocity: float) -> list[CoveredPoint]:
    return [one for one in law.run_in if math.isclose(one.velocity, velocity, rel_tol=1e-3)]


def _point(law: Law, point: LawPoint, coverage: float) -> LawPoint:
    known = sorted(_of(law, point.velocity), key=lambda one: one.coverage)
    C = np.array([one.coverage for one in known])
    # Impacts are whole, so the coverages of a run differ a little between its velocities.
    step = 1.5 * float(np.diff(C).min()) if C.size > 1 else 0.0
    room = max(_SAME * C[-1], min(0.1 * C[-1], step))
    if coverage > C[-1] + room:
        raise DomainError(
            f"coverage: {coverage:g} is beyond the computed coverages of {law.pair} (up to "
            f"{C[-1]:.3g}), and nothing is extrapolated; give less, or run the case with more"
        )

    def at(name: str) -> float:
        return float(np.interp(coverage, C, [getattr(one, name) for one in known]))

    after = int(np.searchsorted(C, min(coverage, C[-1])))
    around = known[max(after - 1, 0) : after + 1]
    e = at("restitution")
    # The other losses of an impact hardly depend on the roughness.
    share = math.prod(point.factors.values())
    error = share * max(one.error for one in around) + (point.loss_error or 0.0)
    table = share * np.array([one.quantiles for one in known]).T
    quantiles = tuple(float(np.interp(coverage, C, values)) for values in table)
    return replace(
        point,
        restitution=share * e,
        quasi_static=e if point.factors else None,
        ratio=(share * e) ** 2,
        error=min(error, max(share * e, 1 - share * e)),
        indentation=at("indentation"),
        force=at("force"),
        pull_off_force=at("pull_off_force"),
        pull_off_error=None,
        separation=None,
        deviation=share * at("deviation"),
        quantiles=cast(Quantiles, quantiles),
    )
