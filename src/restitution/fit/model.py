"""COR of a case over a range of impact velocities, as a function of the free parameters.

The depths of a curve form a geometric sequence, between which W_u/W_l is interpolated. Without
adhesion, the depths do not shift when parameters change, so COR is a smooth function of them.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

import numpy as np
import tomli_w
from numpy.typing import NDArray

from restitution.case.case import DEPTHS, Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.schema import UnloadingTable
from restitution.collision import collide
from restitution.contact.checks.resolution import resolves_contact
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.model_error import model_error
from restitution.contact.prescribed_velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.fit.parameters import Parameter, with_factors
from restitution.laws.interpolation import RatioCurve
from restitution.runs.companions import coarser_contact
from restitution.runs.log import Say, ignore
from restitution.runs.messages import naming_keys, require_possible

Array = NDArray[np.float64]
Cost = Literal["full", "coarser", "quick"]
"""The grid of the case, cells twice as large, or these cells and only `_FEW` surfaces."""

_RATIO = 1.3  # ratio of each depth to the previous depth
SURFACES = 8  # number of surfaces of a curve if `realisations` of the case is 1
_FEW = 3  # number of surfaces of a quick curve
MOST_VELOCITIES = 12  # largest number of velocities in the fitted case file


@dataclass(frozen=True)
class SurfaceCurve:
    """W_u/W_l of one surface with the errors of COR, shape (depths,); `resolved` is 1 or 0."""

    ratio: RatioCurve
    solver_error: Array
    model_error: Array
    resolved: Array

    def restitution(self, velocity: Array) -> Array:
        inside = np.clip(velocity, self.ratio.velocities[0], self.ratio.velocities[-1])
        ratios = np.array([self.ratio.at(V) for V in inside.tolist()])
        return np.asarray(np.sqrt(np.clip(ratios, 0.0, 1.0)))

    def interpolated(
        self, name: Literal["solver_error", "model_error", "resolved"], velocity: Array
    ) -> Array:
        V = self.ratio.velocities
        return np.asarray(np.interp(np.log(velocity), np.log(V), getattr(self, name)))


@dataclass(frozen=True)
class Mean:
    """Mean COR of several surfaces of a case, and the largest errors among their `curves`."""

    curves: tuple[SurfaceCurve, ...]

    def restitution(self, velocity: Array) -> Array:
        return np.asarray(np.mean([curve.restitution(velocity) for curve in self.curves], axis=0))

    def error(self, velocity: Array, name: Literal["solver_error", "model_error"]) -> Array:
        errors = [curve.interpolated(name, velocity) for curve in self.curves]
        return np.asarray(np.max(errors, axis=0))

    def resolved_at(self, velocity: Array) -> NDArray[np.bool_]:
        """Whether the grid resolves both computed contacts next to `velocity`, on all surfaces."""
        resolved = [curve.interpolated("resolved", velocity) for curve in self.curves]
        return np.asarray(np.min(resolved, axis=0) > 1 - 1e-9)


def curve_of(
    contact: Contact, low: float, high: float, unloading: UnloadingTable, near: float = math.nan
) -> tuple[SurfaceCurve, float]:
    """Compute the curve of `contact` from velocity `low` to at least `high` (m/s).

    Returns the curve and its first depth (m). Each depth is the first depth `near` (m) of an
    earlier curve times a power of `_RATIO`, unless the contact is adhesive or `low` equals `high`.
    """
    with naming_keys("impact"):
        if math.isnan(near) or contact.adhesive or low == high:
            state = solve_at_velocity(contact, low)
        else:
            state = solve(contact, near)
            while (collide(state).impact_velocity or 0.0) > low:
                state = solve(contact, state.indentation / _RATIO)
        rows = [_row(state, unloading)]
        # If `low` equals `high`, one depth is enough, although its velocity can be slightly below
        # `high`.
        while rows[-1][0] < high and low < high:
            state = solve(contact, _RATIO * state.indentation, start=state)
            row = _row(state, unloading)
            if row[0] > rows[-1][0]:
                rows.append(row)
    first = max(sum(row[0] <= low for row in rows) - 1, 0)
    V, ratio, solver, model, resolved, depth = np.array(rows[first:]).T
    curve = SurfaceCurve(RatioCurve(V, ratio, adhesive=contact.adhesive), solver, model, resolved)
    return curve, float(depth[0])


def _row(state: State, unloading: UnloadingTable) -> tuple[float, ...]:
    collision = collide(state, method=unloading.method, tolerance=unloading.restitution_error)
    return (
        collision.impact_velocity or 0.0,
        collision.unloading_work / collision.loading_work,
        collision.restitution_error,
        model_error(state, collision.restitution),
        resolves_contact(state),
        state.indentation,
    )


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
            curve, first = curve_of(contact, self.low, self.high, case.unloading, near)
            self._first_depths[number, cost] = first
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
