"""The first lines of a page: COR at a velocity, the pair, and what else is asked first."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from restitution.curve.columns import array
from restitution.curve.point import Point
from restitution.display import counted, quantity
from restitution.errors import CaseError
from restitution.laws.coverage import at_coverage
from restitution.laws.from_results import bare_law
from restitution.laws.law import Law
from restitution.laws.particle import Particle
from restitution.pages.page import Answer, Cell, PageTable
from restitution.pages.words import e_in_words, si
from restitution.results.reader import EnsembleResults, RunResults
from restitution.runs.attraction import in_words

_ROUNDING = 1e-4  # relative difference of velocities that a run reaches only nearly
_DIGITS = (1.0, 2.0, 5.0)


def round_velocities(low: float, high: float) -> list[float]:
    """The velocities 1, 2 and 5 times powers of ten from `low` to `high` (m/s)."""
    decades = range(math.floor(math.log10(low)), math.ceil(math.log10(high)) + 1)
    values = [float(f"{digit}e{k}") for k in decades for digit in _DIGITS]
    return [V for V in values if low * (1 - _ROUNDING) <= V <= high * (1 + _ROUNDING)]


def middle_of(velocities: Sequence[float]) -> float:
    """The one of `velocities` that is nearest to the middle of their range, in ln V."""
    centre = math.sqrt(velocities[0] * velocities[-1])
    return min(velocities, key=lambda V: abs(math.log(V / centre)))


def answer_of(run: RunResults, velocity: float | None) -> Answer:
    """The answer of a run, at `velocity` (m/s) or in the middle of its velocities.

    Raises `DomainError` if `velocity` is outside those computed.
    """
    try:
        law = bare_law(run)
    except CaseError:
        return Answer(facts=[_surface(run)])
    attraction = in_words(run.summary["sticking"], run.curve.points)
    facts = list(filter(None, (f"{_pair(law)}; {_surface(run)}", attraction)))
    if law.run_in:
        return _worn(law, facts, velocity)
    velocities = round_velocities(law.lowest, law.highest)
    velocities = velocities or [point.velocity for point in law.points]
    chosen = middle_of(velocities) if velocity is None else velocity
    rows: list[list[Cell]] = []
    for V in sorted({velocities[0], chosen, velocities[-1]}):
        estimate, model = law.at(V), _model_error(run.curve.impacts.points, V)
        e = e_in_words(estimate.restitution, _error(run, law, V))
        rows.append(
            [
                quantity(V, "m/s"),
                e,
                "–" if math.isnan(model) else f"{model:.2g}",
                "yes" if estimate.resolved else "no",
            ]
        )
    which = "total" if run.case.total_error else "solver"
    return Answer(
        _line(law.at(chosen).restitution, _error(run, law, chosen), chosen),
        facts,
        PageTable(
            "Restitution at three velocities",
            ["impact velocity", f"e ± {which}", "± model", "resolved"],
            rows,
        ),
    )


def _line(e: float, error: float, velocity: float) -> str:
    what = f"e = {e_in_words(e, error)}" if e > 0 else "The bodies stick"
    return f"{what} at {quantity(velocity, 'm/s')}"


def _worn(law: Law, facts: Sequence[str], velocity: float | None) -> Answer:
    """The answer after many impacts, beside that of new surfaces."""
    laws = [at_coverage(law, coverage) for coverage in _coverages(law)]
    velocities = [float(V) for V in laws[0].column("velocity")]
    chosen = middle_of(velocities) if velocity is None else velocity
    new, last = laws[0].at(chosen), laws[-1].at(chosen)
    rows: list[list[Cell]] = []
    for V in sorted({velocities[0], chosen, velocities[-1]}):
        estimates = [one.at(V) for one in laws]
        rows.append(
            [quantity(V, "m/s"), *(e_in_words(one.restitution, one.error) for one in estimates)]
        )
    heads = ["new surfaces", *(f"coverage {one.coverage:.3g}" for one in laws[1:])]
    return Answer(
        f"{_line(new.restitution, new.error, chosen)}, "
        f"run in {e_in_words(last.restitution, last.error)}",
        facts,
        PageTable("Restitution after many impacts", ["impact velocity", *heads], rows),
    )


def _coverages(law: Law) -> list[float]:
    """The coverages that all velocities of `law` reach, without those that nearly equal others."""
    highest = [
        max(one.coverage for one in law.run_in if one.velocity == V)
        for V in {one.velocity for one in law.run_in}
    ]
    first = law.run_in[0].velocity
    own = [one.coverage for one in law.run_in if one.velocity == first]
    return [min(coverage, *highest) for coverage in own]


def _error(run: RunResults, law: Law, velocity: float) -> float:
    """The error of e at `velocity`; NaN if the total error of a point beside it is unknown."""
    points = run.curve.impacts.points
    V = array(points, "impact_velocity")
    after = int(np.clip(np.searchsorted(V, velocity), 1, max(len(V) - 1, 1)))
    near = points[after - 1 : after + 1]
    if run.case.total_error and any(math.isnan(point.total_error) for point in near):
        return math.nan
    return law.at(velocity).error


def _model_error(points: Sequence[Point], velocity: float) -> float:
    V, error = (array(points, name) for name in ("impact_velocity", "model_error"))
    return float(np.interp(math.log(velocity), np.log(V), error))


def _pair(law: Law) -> str:
    first, second = body_in_words(law.first), body_in_words(law.second)
    if first == second:
        return f"Two bodies: {first}"
    return f"{first[0].upper()}{first[1:]} on {second}"


def body_in_words(body: Particle) -> str:
    """Material and size of a body, such as "steel, R = 200 µm"."""
    size = "flat" if body.radius is None else f"R = {si(body.radius, 'm')}"
    shape = "wall" if body.wall else "sphere"
    return f"{body.material or shape}, {size}"


def _surface(run: RunResults) -> str:
    statistics = run.summary.get("surface_statistics", {})
    height = statistics.get("Sq_m")
    rough = f"Sq {si(height, 'm')}" if height else "smooth"
    means = (
        f", mean of {counted(run.surfaces, 'surface')}" if isinstance(run, EnsembleResults) else ""
    )
    return f"{rough}{means}"
