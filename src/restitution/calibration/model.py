"""COR of a case over a range of impact velocities, as a function of the free parameters.

A curve is COR of one surface against impact velocity. The contact is computed at depths (maximum
indentations) that form a geometric sequence. The impact velocities of these depths cover the range.
Between the depths, the ratio W_u/W_l of unloading work to loading work is interpolated
(`RatioCurve`). Without adhesion, the depths of a surface (at the same `Cost`) do not shift when the
parameters change. The interpolated COR is then a smooth function of the parameters.
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

from restitution.calibration.parameters import Parameter, with_factors
from restitution.case.case import DEPTHS, Case
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.case.schema import UnloadingTable
from restitution.collision import collide
from restitution.contact.checks.model_error import model_error
from restitution.contact.checks.resolution import resolves_contact
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.laws.interpolation import RatioCurve
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
class Curve:
    """COR of one surface at increasing impact velocities (m/s), shape (depths,).

    `ratio` is W_u/W_l, the work of unloading divided by the work of loading. `solver_error` and
    `model_error` are the errors of COR due to the solver, and due to the models of plasticity and
    adhesion. `resolved` is 1 if the grid resolves the contact, else 0.
    """

    ratio: RatioCurve
    solver_error: Array
    model_error: Array
    resolved: Array

    def restitution(self, velocity: Array) -> Array:
        """COR at `velocity` (m/s), by interpolation."""
        inside = np.clip(velocity, self.ratio.velocities[0], self.ratio.velocities[-1])
        ratios = np.array([self.ratio.at(V) for V in inside.tolist()])
        return np.asarray(np.sqrt(np.clip(ratios, 0.0, 1.0)))

    def interpolated(
        self, name: Literal["solver_error", "model_error", "resolved"], velocity: Array
    ) -> Array:
        """Return the value of the field `name` at `velocity` (m/s), by interpolation."""
        V = self.ratio.velocities
        return np.asarray(np.interp(np.log(velocity), np.log(V), getattr(self, name)))


@dataclass(frozen=True)
class Mean:
    """Mean COR of several surfaces of a case, and the largest errors among their `curves`."""

    curves: tuple[Curve, ...]

    def restitution(self, velocity: Array) -> Array:
        """Mean COR at `velocity` (m/s)."""
        return np.asarray(np.mean([each.restitution(velocity) for each in self.curves], axis=0))

    def error(self, velocity: Array, name: Literal["solver_error", "model_error"]) -> Array:
        """Solver error or model error of COR at `velocity` (m/s), the largest over the surfaces."""
        errors = [each.interpolated(name, velocity) for each in self.curves]
        return np.asarray(np.max(errors, axis=0))

    def resolved_at(self, velocity: Array) -> NDArray[np.bool_]:
        """Whether the grid resolves the computed contacts next to `velocity` (m/s).

        These are the contacts at the next lower and the next higher computed velocity. The result
        is true only if the grid resolves both contacts for every surface.
        """
        resolved = [each.interpolated("resolved", velocity) for each in self.curves]
        return np.asarray(np.min(resolved, axis=0) > 1 - 1e-9)


def curve_of(
    contact: Contact, low: float, high: float, unloading: UnloadingTable, near: float = math.nan
) -> tuple[Curve, float]:
    """Compute the curve of `contact` from velocity `low` to at least `high` (m/s).

    Returns the curve and its first depth (m). `near` (m), if given, is the first depth of an
    earlier curve of the same surface with other parameters. Each depth is then `near` times a power
    of `_RATIO`, so both curves use depths of one geometric sequence. `near` is ignored for adhesive
    contacts and if `low` equals `high`. Raises the errors of `solve` and `solve_at_velocity`.
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
    curve = Curve(RatioCurve(V, ratio, adhesive=contact.adhesive), solver, model, resolved)
    return curve, float(depth[0])


def _row(state: State, unloading: UnloadingTable) -> tuple[float, ...]:
    """Return the values of a `Curve` at one depth, and the depth.

    The values are the impact velocity (m/s), W_u/W_l, the solver error and the model error of COR,
    a flag that is true if the grid resolves the contact, and the depth (m).
    """
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
            curve, first = curve_of(contact, self.low, self.high, case.unloading, near)
            self._first_depths[number, cost] = first
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
