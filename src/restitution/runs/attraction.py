"""Pull-off force and sticking velocity of an adhesive pair, with their errors (docs/error.md)."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.collision import Collision, collide
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.curve.columns import Array, array
from restitution.curve.curve import Curve
from restitution.curve.point import Point
from restitution.curve.work_curve import WorkCurve
from restitution.display import quantity, with_error
from restitution.errors import RestitutionError
from restitution.numerics.intervals import half_interval
from restitution.runs.companions import Companions

_NEAR = 0.02  # relative change of the sticking velocity at which its search ends
_MOST_SOLVES = 6


@dataclass(frozen=True)
class Sticking:
    """The velocity (m/s) up to which a pair sticks; 0 if no velocity loses enough energy.

    `error` combines `solver_error` (m/s) and all other parts; None if unknown. `lowest` is the
    velocity at which the energy loss was last computed.
    """

    velocity: float
    solver_error: float
    lowest: float
    error: float | None = None


def sticking(
    case: Case, folder: Path, curve: Curve, deepest: State | None = None
) -> Sticking | None:
    """Find the velocity up to which the pair sticks, from the loss of energy L: ½ m* V² = L(V).

    The search begins at the lowest velocity at which the pair rebounds on `curve`. Its loading
    paths continue that to `deepest` if they can. Returns None without adhesion or impact
    velocities, or if the pair sticks at the highest velocity.
    """
    mass = case.pair().mass
    if mass is None or not case.interface.adhesive_energy or case.unloading.method != "path":
        return None
    impacts = curve.impacts.points
    if not impacts or impacts[-1].sticks:
        return None
    first = len(impacts)
    while first and not impacts[first - 1].sticks:
        first -= 1
    begins = impacts[first]
    contact = case.refined(int(begins.refine)).realisation(0).contact(folder)
    start = None
    follows = contact.adhesion is not None and contact.adhesion.follows_path
    if follows and deepest is not None and deepest.contact.grid == contact.grid:
        contact, start = deepest.contact, deepest
    begin = _Impact(
        begins.impact_velocity,
        begins.loading_work - begins.unloading_work,
        # The error of e is that of W_u/W_l divided by 2 e.
        2 * begins.restitution * begins.restitution_error * begins.loading_work,
    )

    def impact(velocity: float) -> _Impact:
        return _Impact.of(collide(solve_at_velocity(contact, velocity, start=start)), velocity)

    return _search(begin, impact, mass)


def with_errors(pair: Sticking, companions: Companions, *, scattered: bool) -> Sticking:
    """Add the errors due to grid, surfaces (if `scattered`) and materials to `pair`."""
    mass = companions.coarse.pair.mass
    assert mass is not None
    work = np.array([0.5 * mass * max(pair.velocity, pair.lowest) ** 2])

    def velocity(curve: WorkCurve) -> Array:
        lost = np.maximum(work * (1 - curve.ratio(work)), 0.0)
        return np.sqrt(np.where(lost > _NEGLIGIBLE * work, 2 * lost / mass, 0.0))

    parts = curve_errors(companions, velocity, np.array([pair.velocity]), scattered=scattered)
    error = math.hypot(pair.solver_error, *(float(part[0]) for part in parts))
    return Sticking(pair.velocity, pair.solver_error, pair.lowest, error)


def with_pull_off_errors(
    companions: Companions, points: Sequence[Point], *, scattered: bool = True
) -> list[Point]:
    """Add the errors due to grid, surfaces and materials to the `pull_off_error` of `points`."""
    if not companions.coarse.adhesive:
        return list(points)
    work, force = array(points, "loading_work"), array(points, "pull_off_force")
    parts = curve_errors(companions, lambda c: c.pull_off_at(work), force, scattered=scattered)
    return [
        replace(point, pull_off_error=math.hypot(point.pull_off_error, *errors))
        for point, errors in zip(points, np.transpose(parts).tolist(), strict=True)
    ]


def curve_errors(
    companions: Companions,
    quantity_of: Callable[[WorkCurve], Array],
    here: Array,
    *,
    scattered: bool,
) -> list[Array]:
    """Errors of a quantity, `here` on the grid of the run, due to grid, surfaces and materials."""
    kinds = errors_by_kind(companions, quantity_of, here, scattered=scattered)
    return [error for errors in kinds.values() for error in errors]


def errors_by_kind(
    companions: Companions,
    quantity_of: Callable[[WorkCurve], Array],
    here: Array,
    *,
    scattered: bool,
) -> dict[str, list[Array]]:
    """Errors of a quantity, `here` on the grid of the run, by the names of those of COR.

    One error due to the grid and one to patches, one due to scatter between surfaces (if
    `scattered` and the bodies are rough), and one for each kind of library value with a spread.
    """
    grid = [np.abs(here - quantity_of(companions.own))]
    if scales := companions.scales():
        grid.append(scales.error(quantity_of, companions.area_at_pull_off))
    surfaces, materials = [], []
    own = quantity_of(companions.reference)
    if companions.case.roughness and scattered:
        values = np.array([own, *map(quantity_of, companions.others())])
        half = half_interval(len(values)) * values.std(axis=0, ddof=1)
        surfaces.append(np.abs(own - values.mean(axis=0)) + half)
    if spectra := companions.spectra():
        changes = [np.abs(quantity_of(curve) - own) for curve in spectra]
        surfaces.append(np.max(changes, axis=0))
    for ends in companions.material_ends():
        reference = quantity_of(companions.curve(companions.of_materials))
        low, high = (np.abs(quantity_of(companions.curve(end)) - reference) for end in ends)
        materials.append(np.maximum(low, high))
    return {
        "discretisation_error": grid,
        "surface_scatter": surfaces,
        "material_error": materials,
    }


def in_words(known: Mapping[str, Any], points: Sequence[Point]) -> str:
    """Pull-off force and sticking velocity (`summary_of`) in one line; empty without adhesion."""
    adhesive = [point for point in points if point.loading_work > 0 and point.pull_off_force > 0]
    if not adhesive:
        return ""
    forces = [_pull_off(point) for point in (adhesive[0], adhesive[-1])]
    ratio = adhesive[0].pull_off_force / adhesive[-1].pull_off_force
    range_of = forces[0] if abs(ratio - 1) < _ALIKE else f"{forces[0]} to {forces[1]}"
    return f"{_sticks(known, adhesive)}; pull-off force {range_of}."


def summary_of(pair: Sticking | None) -> dict[str, float | bool]:
    """The entries of `summary.json` about sticking; empty if nothing is known."""
    if pair is None:
        return {}
    error = pair.solver_error if pair.error is None else pair.error
    return {
        "sticks_below_m_per_s": pair.velocity,
        "sticks_below_error_m_per_s": error,
        "error_is_total": pair.error is not None,
        "computed_down_to_m_per_s": pair.lowest,
    }


def stored(known: Mapping[str, Any]) -> Sticking | None:
    if not known:
        return None
    error = known["sticks_below_error_m_per_s"]
    total = error if known["error_is_total"] else None
    return Sticking(known["sticks_below_m_per_s"], error, known["computed_down_to_m_per_s"], total)


def mean_of(pairs: Sequence[Sticking], one: Sticking | None) -> Sticking | None:
    """Mean over several surfaces; `one` has the errors of one of them without scatter."""
    if not pairs:
        return None
    velocities = np.array([pair.velocity for pair in pairs])
    half = half_interval(len(pairs)) * float(velocities.std(ddof=1)) if len(pairs) > 1 else None
    error = (
        None if half is None or one is None or one.error is None else math.hypot(half, one.error)
    )
    lowest = min(pair.lowest for pair in pairs)
    return Sticking(float(velocities.mean()), half or pairs[0].solver_error, lowest, error)


# Losses below this fraction of the loading work are rounding, and pull-off forces that differ by
# less than this fraction are printed as one.
_NEGLIGIBLE, _ALIKE = 1e-6, 0.03


@dataclass(frozen=True)
class _Impact:
    """Velocity (m/s) of an impact, and the energy it loses (J) with its error."""

    velocity: float
    loss: float
    error: float

    @classmethod
    def of(cls, collision: Collision, velocity: float) -> _Impact:
        loss = collision.loading_work - collision.unloading_work
        error = math.hypot(collision.loading_work_error, collision.unloading_work_error)
        return cls(velocity, loss, error)

    def sticks_below(self, mass: float) -> float:
        """The sticking velocity (m/s) if the loss did not depend on velocity."""
        work = 0.5 * mass * self.velocity**2
        if self.loss <= max(self.error, _NEGLIGIBLE * work):
            return 0.0
        return math.sqrt(2 * self.loss / mass)

    def uncertainty(self, mass: float) -> float:
        velocity = self.sticks_below(mass)
        if velocity == 0:
            return math.sqrt(2 * max(self.loss, self.error, 0.0) / mass)
        return self.error / (mass * velocity)


def _search(begin: _Impact, impact: Callable[[float], _Impact], mass: float) -> Sticking:
    """Iterate V → sqrt(2 L(V)/m*) from above: L grows slowly with V, so this converges."""
    last = begin
    velocity = last.sticks_below(mass)
    for _ in range(_MOST_SOLVES):
        if velocity == 0 or abs(velocity / last.velocity - 1) <= _NEAR:
            return Sticking(velocity, last.uncertainty(mass), last.velocity)
        try:
            last = impact(velocity)
        except RestitutionError:
            break
        velocity = last.sticks_below(mass)
    change = abs(velocity - last.velocity)
    return Sticking(velocity, math.hypot(last.uncertainty(mass), change), last.velocity)


def _pull_off(point: Point) -> str:
    force, error = point.pull_off_force, point.pull_off_error
    at = point.impact_velocity
    where = "" if math.isnan(at) else f" after {quantity(at, 'm/s')}"
    return f"{with_error(force, error, 'N')}{where}"


def _sticks(known: Mapping[str, Any], points: Sequence[Point]) -> str:
    if not known and points[-1].sticks:
        last = quantity(points[-1].impact_velocity, "m/s")
        return f"Sticks at every computed velocity, up to {last}"
    if not known:
        return 'Sticking velocity unknown (it needs densities and unloading.method = "path")'
    velocity, error = known["sticks_below_m_per_s"], known["sticks_below_error_m_per_s"]
    if velocity == 0:
        return f"Sticks at no velocity above {quantity(error, 'm/s')}" if error else "Never sticks"
    return f"Sticks below {with_error(velocity, error, 'm/s')}"
