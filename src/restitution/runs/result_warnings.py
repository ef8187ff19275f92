"""Warnings about the results of a run: precision, velocities, energy balance, adhesion."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from restitution.case.case import Case
from restitution.contact.checks.resolution import unresolved_adhesion, unresolved_patches
from restitution.curve.periodic import PeriodicPoint
from restitution.curve.point import Point
from restitution.display import duration, quantity
from restitution.numerics.grid import Grid

# The time of a run grows with the inverse of the cell size to this power.
_GROWTH = 2.3
# Limits above which a warning is issued.
_VELOCITY = 1e-3  # relative error of a prescribed impact velocity
_IMPRECISE = 0.02  # numerical error of COR
_BALANCE = 0.01  # relative difference of unloading work and stored energy


def unresolved(points: Sequence[Point | PeriodicPoint]) -> Iterator[str]:
    depths = [point.indentation for point in points]
    patches = [point.median_patch_nodes for point in points]
    yield from (finding.text() for finding in unresolved_patches(depths, patches))


def too_coarse_for_adhesion(
    case: Case, grid: Grid, points: Sequence[Point], seconds: float
) -> Iterator[str]:
    """Yield a warning if cells are too large for adhesion, with the finer grid and its cost.

    `grid` is that of the deepest of `points`, and `seconds` the time of the run so far.
    """
    factor = case.grid.factor
    unrefined = factor * max(grid.spacing)
    adhesive = [point for point in points if not math.isnan(point.adhesive_spacing)]
    for finding in unresolved_adhesion(
        [point.indentation for point in adhesive],
        [unrefined / point.refine for point in adhesive],
        [point.adhesive_spacing for point in adhesive],
        unrefined,
    ):
        nx, ny = (n * finding.refine // factor for n in grid.nodes)
        finer = max(1.0, finding.spacing / finding.needed)
        cost = duration(seconds * finer**_GROWTH)
        yield f"{finding.text()} ({nx} x {ny} nodes, about {cost})"


def imprecise(points: Sequence[Point], case: Case) -> Iterator[str]:
    limit = max(_IMPRECISE, case.unloading.restitution_error)
    missed = [point for point in points if point.restitution_error > limit]
    if missed:
        worst = max(missed, key=lambda point: point.restitution_error)
        why = (
            'unloading is an estimate; set unloading.method = "path"'
            if case.unloading.method == "energy-estimate"
            else "contact forms and breaks in jumps at these depths; use a finer grid"
        )
        yield (
            f"restitution_error is above {limit:g} at {len(missed)} of {len(points)} depths, "
            f"at worst {worst.restitution_error:.2g} at "
            f"{quantity(worst.indentation, 'm')}: {why}"
        )


def velocities_missed(
    points: Sequence[Point], case: Case, prescribed: Sequence[float]
) -> Iterator[str]:
    if case.impact is None:
        return
    pairs = zip((point.impact_velocity for point in points), prescribed, strict=False)
    off = {velocity: abs(met / velocity - 1) for met, velocity in pairs}
    missed = [velocity for velocity, miss in off.items() if not miss <= _VELOCITY]
    if missed:
        worst = max(missed, key=off.__getitem__)
        yield (
            f"{len(missed)} of {len(off)} impact velocities differ from the requested values "
            f"because of the error of the loading work, at worst by {off[worst]:.1%} at {worst:g} "
            "m/s: use the velocities in curve.csv"
        )


def unbalanced(checks: list[dict[str, float]]) -> Iterator[str]:
    """Yield a warning if unloading without adhesion does not return the stored energy."""
    off = [check for check in checks if not abs(check["relative_to_stored_energy"]) <= _BALANCE]
    if off:
        worst = max(off, key=lambda check: abs(check["relative_to_stored_energy"]))
        yield (
            f"the work of {len(off)} of {len(checks)} unloading curves differs from the stored "
            f"energy, at worst by {worst['relative_to_stored_energy']:+.1%} at "
            f"{quantity(worst['max_indentation_m'], 'm')}: raise unloading.steps, or refine the "
            "grid"
        )
