"""COR of a case over a range of impact velocities, as a function of the free parameters.

A curve is COR of one surface against impact velocity. The contact is computed at depths (maximum
indentations) that form a geometric sequence. The impact velocities of these depths cover the range.
Between the depths, the ratio W_u/W_l of unloading work to loading work is interpolated
(`RatioCurve`). Without adhesion, the depths of a surface (at the same `Cost`) do not shift when the
parameters change. The interpolated COR is then a smooth function of the parameters.
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

from restitution.calibration.parameters import Parameter, with_factors
from restitution.case.case import DEPTHS, Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.schema import UnloadingTable
from restitution.collision import collide
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.prescribed_velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.curve.columns import array
from restitution.curve.curve import Curve
from restitution.curve.follow import Load, Unloading, follow
from restitution.curve.point import Point
from restitution.runs.companions import coarser_contact
from restitution.runs.log import Say, ignore
from restitution.runs.messages import naming_keys, require_possible

Array = NDArray[np.float64]
Cost = Literal["full", "coarser", "quick"]
"""Cost of a curve: "full" uses the grid of the case and all surfaces, "coarser" uses cells twice as
large, and "quick" uses cells twice as large and only `_FEW` surfaces."""

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
    """COR at `velocity` (m/s); constant beyond the ends of `curve`."""
    return curve.at(np.clip(velocity, *curve.velocities))


def _interpolated(curve: Curve, name: str, velocity: Array) -> Array:
    V = np.log(curve.impact_velocity)
    return np.asarray(np.interp(np.log(velocity), V, array(curve.points, name)))


def curve_of(
    contact: Contact, low: float, high: float, unloading: UnloadingTable, near: float = math.nan
) -> Curve:
    """Compute the curve of `contact` from velocity `low` to at least `high` (m/s).

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
    with naming_keys("impact"):
        for impact in follow(loads(), how):
            deepest.append(impact.state.indentation)
            if not points or _velocity(impact.point) > _velocity(points[-1]):
                points.append(impact.point)
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

    `content` holds the tables of the case file. File names in it are relative to `folder`. The
    argument x of the methods holds ln(value/first guess) of each parameter. COR is the mean over
    several random surfaces, because no single random surface equals the measured surface. All
    these surfaces have the statistics that the case gives.
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
        """Return the text of the case file with the parameters `x`.

        `velocities` (m/s; None means `low` and `high`) replace the depths of the case. `digits` is
        the number of significant digits of the free keys.
        """
        tables = with_factors(self.content, self.parameters, np.exp(x), digits)
        for name in DEPTHS:
            tables.pop(name, None)
        given = [self.low, self.high] if velocities is None else velocities
        tables["impact"] = {"velocity": [f"{V!r} m/s" for V in sorted(set(given))]}
        return tomli_w.dumps(tables)

    def case(self, x: Array) -> Case:
        """Make the case with the parameters `x`. Raises `CaseError`."""
        return parse_case(self.text(x))

    def at(self, x: Array, cost: Cost = "full") -> Mean:
        """Compute the curve with the parameters `x`, averaged over the surfaces.

        Raises the errors of `curve_of`.
        """
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
            curve = curve_of(contact, self.low, self.high, case.unloading, near)
            self._first_depths[number, cost] = curve.points[0].indentation
            curves.append(curve)
        self.evaluations += len(curves)
        self.progress(f"{self.evaluations} curves")
        self._known[key] = Mean(tuple(curves))
        return self._known[key]

    @property
    def surfaces(self) -> int:
        """Number of surfaces over which COR is averaged.

        It is the number of realisations of the case, or `SURFACES` if the case has only one
        realisation. A case without roughness has one surface.
        """
        case = self.case(np.zeros(len(self.parameters)))
        if not case.roughness:
            return 1
        return case.realisations if case.realisations > 1 else SURFACES

    def require_possible(self, x: Array) -> None:
        """Raise `CaseError` or `SurfaceError` if the case at parameters `x` has no valid result.

        The case is checked at its deepest indentation. `contact.checks.inputs.impossible` lists the
        reasons, such as a predicted contact radius above R*.
        """
        case = self.case(x)
        require_possible(case.contact(self.folder), deepest_indentation(case))

    def restitution(self, x: Array, velocity: Array, cost: Cost = "full") -> Array:
        """COR at `velocity` (m/s) for the parameters `x`, averaged over surfaces.

        `cost` selects the cell size and the number of surfaces (`Cost`).
        """
        return self.at(x, cost).restitution(velocity)


def velocities_to_run(measured: Array) -> list[float]:
    """Velocities (m/s) of the fitted case.

    They are the measured velocities. If there are more than `MOST_VELOCITIES` of them,
    `MOST_VELOCITIES` velocities are spread evenly (on a logarithmic scale) over the same range.
    """
    own = np.unique(measured)
    if own.size <= MOST_VELOCITIES:
        return [float(V) for V in own]
    spread = np.geomspace(own[0], own[-1], MOST_VELOCITIES)
    return [float(f"{V:.6g}") for V in spread]
