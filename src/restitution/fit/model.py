"""COR of a case over a range of impact velocities, as a function of the free parameters.

The depths of a curve form a geometric sequence, between which W_u/W_l is interpolated. Without
adhesion, the depths do not shift when parameters change, so COR is a smooth function of them.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w
from numpy.typing import NDArray

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.schema import UnloadingTable
from restitution.case.tables import DEPTHS
from restitution.collision import collide
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.curve.columns import array
from restitution.curve.curve import Curve, UnloadingCurve
from restitution.curve.follow import Load, Unloading, follow
from restitution.curve.point import Point
from restitution.fit.parameters import Parameter, with_factors
from restitution.losses.losses import Losses
from restitution.runs.companions import coarser_contact
from restitution.runs.log import Say, ignore
from restitution.runs.losses import unloading_of, with_losses
from restitution.runs.messages import naming_keys, require_possible

Array = NDArray[np.float64]
Cost = Literal["full", "coarser", "quick"]
"""The grid of the case, cells twice as large, or these cells and only `_FEW` surfaces."""

_RATIO = 1.3  # ratio of each depth to the previous depth
SURFACES = 8  # number of surfaces of a curve if `realisations` of the case is 1
_FEW = 3  # number of surfaces of a quick curve
MOST_VELOCITIES = 12  # largest number of velocities in the fitted case file


@dataclass(frozen=True)
class Mean:
    """Mean COR of several surfaces of a case, and the largest errors among their `curves`."""

    curves: tuple[Curve, ...]

    def restitution(self, velocity: Array) -> Array:
        """Mean COR at `velocity` (m/s)."""
        return np.asarray(np.mean([restitution(curve, velocity) for curve in self.curves], axis=0))

    def error(self, velocity: Array, name: Literal["restitution_error", "model_error"]) -> Array:
        """Solver error or model error of COR at `velocity` (m/s), the largest over the surfaces."""
        errors = [_interpolated(curve, name, velocity) for curve in self.curves]
        return np.asarray(np.max(errors, axis=0))

    def resolved_at(self, velocity: Array) -> NDArray[np.bool_]:
        """Whether the grid resolves the computed contacts next to `velocity` (m/s).

        These are the contacts at the next lower and the next higher computed velocity. The result
        is true only if the grid resolves both contacts for every surface.
        """
        resolved = [_interpolated(curve, "resolved", velocity) for curve in self.curves]
        return np.asarray(np.min(resolved, axis=0) > 1 - 1e-9)


def restitution(curve: Curve, velocity: Array) -> Array:
    """COR with all losses at `velocity` (m/s); constant beyond the ends of `curve`."""
    return curve.with_losses_at(np.clip(velocity, *curve.velocities))


def _interpolated(curve: Curve, name: str, velocity: Array) -> Array:
    V = np.log(curve.impact_velocity)
    return np.asarray(np.interp(np.log(velocity), V, array(curve.points, name)))


def curve_of(
    contact: Contact,
    losses: Losses,
    low: float,
    high: float,
    unloading: UnloadingTable,
    near: float = math.nan,
) -> Curve:
    """Compute the curve of `contact` with `losses` from velocity `low` to at least `high` (m/s).

    `near` (m), if given, is the first depth of an earlier curve of the same surface with other
    parameters. Each depth is then `near` times a power of `_RATIO`, so both curves use depths of
    one geometric sequence. `near` is ignored for adhesive contacts and if `low` equals `high`.
    Raises the errors of `solve` and `solve_at_velocity`.
    """
    points: list[Point] = []

    def loads() -> Iterator[Load]:
        begin = partial(_first_state, contact, low, math.nan if low == high else near)
        yield Load(contact, lambda _: begin(), low)
        # If `low` equals `high`, one depth is enough, although its velocity can be slightly below
        # `high`.
        while _velocity(points[-1]) < high and low < high:
            depth = _RATIO * deepest[-1]
            yield Load(contact, partial(_deeper, contact, depth), depth)

    how = Unloading(unloading.method, tolerance=unloading.restitution_error)
    deepest: list[float] = []
    back: dict[float, UnloadingCurve] = {}
    with naming_keys("impact"):
        for impact in follow(loads(), how):
            deepest.append(impact.state.indentation)
            if losses.present and (unloaded := unloading_of(impact)) is not None:
                back[impact.point.indentation] = unloaded
            if not points or _velocity(impact.point) > _velocity(points[-1]):
                points.append(impact.point)
    points = with_losses(contact.pair, losses, points, back)
    first = max(sum(_velocity(point) <= low for point in points) - 1, 0)
    return Curve(tuple(points[first:]))


def _deeper(contact: Contact, depth: float, start: State | None) -> State:
    return solve(contact, depth, start=start)


def _first_state(contact: Contact, low: float, near: float) -> State:
    if math.isnan(near) or contact.adhesive:
        return solve_at_velocity(contact, low)
    state = solve(contact, near)
    while (collide(state).impact_velocity or 0.0) > low:
        state = solve(contact, state.indentation / _RATIO)
    return state


def _velocity(point: Point) -> float:
    return 0.0 if math.isnan(point.impact_velocity) else point.impact_velocity


@dataclass
class CaseModel:
    """COR of a case from velocity `low` to `high` (m/s), as a function of the free `parameters`.

    File names in the tables `content` are relative to `folder`. The argument x of the methods holds
    ln(value/first guess) of each parameter. COR is the mean over several random surfaces with the
    statistics of the case, because no single one equals the measured surface.
    """

    content: Mapping[str, Any]
    folder: Path
    parameters: Sequence[Parameter]
    low: float
    high: float
    progress: Say = ignore
    evaluations: int = 0
    _known: dict[tuple[Any, ...], Mean] = field(default_factory=dict)
    _first_depths: dict[tuple[int, Cost], float] = field(default_factory=dict)

    def text(self, x: Array, velocities: Sequence[float] | None = None, digits: int = 17) -> str:
        """The case file with `x` (`digits` significant digits) and velocities (m/s) as depths."""
        tables = with_factors(self.content, self.parameters, np.exp(x), digits)
        for name in DEPTHS:
            tables.pop(name, None)
        given = [self.low, self.high] if velocities is None else velocities
        tables["impact"] = {"velocity": [f"{V!r} m/s" for V in sorted(set(given))]}
        return tomli_w.dumps(tables)

    def case(self, x: Array) -> Case:
        return parse_case(self.text(x))

    def at(self, x: Array, cost: Cost = "full") -> Mean:
        key = (x.tobytes(), cost)
        if key in self._known:
            return self._known[key]
        case = self.case(x)
        curves = []
        for number in range(min(_FEW, self.surfaces) if cost == "quick" else self.surfaces):
            contact = case.variant(number).contact(self.folder)
            if cost != "full":
                contact = coarser_contact(contact)
            near = self._first_depths.get((number, cost), math.nan)
            curve = curve_of(contact, case.losses(), self.low, self.high, case.unloading, near)
            self._first_depths[number, cost] = curve.points[0].indentation
            curves.append(curve)
        self.evaluations += len(curves)
        self.progress(f"{self.evaluations} curves")
        self._known[key] = Mean(tuple(curves))
        return self._known[key]

    @property
    def surfaces(self) -> int:
        case = self.case(np.zeros(len(self.parameters)))
        if not case.roughness:
            return 1
        return case.realisations if case.realisations > 1 else SURFACES

    def require_possible(self, x: Array) -> None:
        case = self.case(x)
        require_possible(case.contact(self.folder), deepest_indentation(case))

    def restitution(self, x: Array, velocity: Array, cost: Cost = "full") -> Array:
        return self.at(x, cost).restitution(velocity)


def velocities_to_run(measured: Array) -> list[float]:
    """The measured velocities (m/s), or `MOST_VELOCITIES` of the same range if they are more."""
    own = np.unique(measured)
    if own.size <= MOST_VELOCITIES:
        return [float(V) for V in own]
    spread = np.geomspace(own[0], own[-1], MOST_VELOCITIES)
    return [float(f"{V:.6g}") for V in spread]
