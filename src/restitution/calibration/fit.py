"""Find the parameters of a case that explain measured restitution."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.calibration.least_squares import (
    Data,
    Minimum,
    jacobian,
    search,
    search_widely,
)
from restitution.calibration.measured import Measured
from restitution.calibration.model import CaseModel, Mean
from restitution.calibration.parameters import Parameter, free_parameters
from restitution.calibration.uncertainty import Deviations, Uncertainty
from restitution.case.case_file import parse_case, parse_toml
from restitution.errors import CaseError, RestitutionError
from restitution.runs.companions import SURFACES
from restitution.runs.log import Say, ignore
from restitution.runs.refinement import settled

Array = NDArray[np.float64]

_FINE = 60  # velocities of the fitted curve


@dataclass(frozen=True)
class FittedCurve:
    """The fitted COR at velocities (m/s) that span the measured ones, with its 95 % band."""

    velocity: Array
    restitution: Array
    half_band: Array


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    `x` holds ln(value/first guess) of each parameter. `fitted` and `deviations` are at the
    measured velocities, `weights` the deviations that weighed the points. `minima` are those of all
    starts, on cells twice as large, the best first. `surfaces_asked` is the number of other surfaces
    that the uncertainty was to include; `grid_known` says whether the coarser grid could be solved.
    """

    model: CaseModel
    measured: Measured
    x: Array
    fitted: Array
    resolved: NDArray[np.bool_]
    weights: Array
    deviations: Deviations
    uncertainty: Uncertainty
    minima: Sequence[Minimum]
    curve: FittedCurve
    surfaces_asked: int
    grid_known: bool

    @property
    def parameters(self) -> Sequence[Parameter]:
        """The free parameters."""
        return self.model.parameters

    @property
    def factors(self) -> list[float]:
        """The fitted value of each parameter over its first guess."""
        return [math.exp(each) for each in self.x.tolist()]

    @property
    def residuals(self) -> Array:
        """Measured minus fitted COR."""
        return self.measured.restitution - self.fitted

    @property
    def chi_squared(self) -> float:
        """Σ (residual/weight)²."""
        return float(np.sum((self.residuals / self.weights) ** 2))

    @property
    def freedom(self) -> int:
        """Points less parameters."""
        return self.measured.velocity.size - self.x.size


def fit(
    text: str,
    folder: Path,
    measured: Measured,
    names: Sequence[str],
    progress: Say = ignore,
) -> Fit:
    """Fit the keys `names` of the case file `text` to `measured` restitution.

    Files are relative to `folder`. The impact velocities of the case are those of `measured`, and
    its values of the free keys are first guesses (`free_parameters`). `progress` is called with a
    few words after every curve. Raises `CaseError`, and what `solve_at_velocity` raises where the
    fitted case cannot be solved.
    """
    content = parse_toml(text)
    parse_case(text)
    parameters = free_parameters(content, names)
    _check_points(measured, len(parameters))
    V = measured.velocity
    model = CaseModel(content, folder, parameters, float(V[0]), float(V[-1]), progress)
    start = np.zeros(len(parameters))
    _settle_grid(model, start)
    model.require_possible(start)
    given = measured.deviation
    data = Data(V, measured.restitution, np.ones_like(V) if given is None else given)
    minima = search_widely(model, data)
    best = _best(model, data, minima)
    if given is not None:
        # Points where another surface or grid gives another COR count less.
        moved = _deviations(model, best.x, data, 0.0)[0]
        data = Data(V, measured.restitution, np.sqrt(given**2 + _systematic(moved) ** 2))
        best = search(model, data, best.x)
    return _result(model, measured, data, best, minima)


def _check_points(measured: Measured, parameters: int) -> None:
    points = measured.velocity.size
    if points < parameters:
        raise CaseError(
            f"--free: {parameters} keys are more than the {points} measured points can determine; "
            "measure more, or free fewer keys"
        )
    if points == parameters and measured.deviation is None:
        raise CaseError(
            f"--free: {parameters} keys and as many measured points leave no residuals to estimate "
            "the noise from; add the column restitution_std, or measure more"
        )


def _settle_grid(model: CaseModel, start: Array) -> None:
    """Replace `grid.refine = "auto"` in the case by the number for the first guess."""
    case = model.case(start)
    if case.grid is not None and case.grid.refine == "auto":
        factor = settled(case, model.folder).grid
        assert factor is not None  # it has `refine`
        content: dict[str, Any] = dict(model.content)
        content["grid"] = {**content["grid"], "refine": factor.factor}
        model.content = content


def _best(model: CaseModel, data: Data, minima: Sequence[Minimum]) -> Minimum:
    """The minimum on the case's own grid, from the best on cells twice as large that succeeds."""
    failure: RestitutionError | None = None
    for start in minima:
        try:
            return search(model, data, start.x)
        except RestitutionError as error:
            failure = failure or error
    assert failure is not None  # `search_widely` returns a minimum
    raise failure


def _deviations(
    model: CaseModel, x: Array, data: Data, random: Array | float, freedom: float = math.inf
) -> tuple[Deviations, bool]:
    """The deviations at `x`, and whether the curve on cells twice as large is known."""
    here = model.at(x)
    V, own = data.velocity, here.restitution(data.velocity)
    others = []
    for number in range(1, 1 + (SURFACES if model.case(x).roughness else 0)):
        try:
            others.append(model.at(x, surface=number).restitution(V) - own)
        except RestitutionError:
            continue
    try:
        grid, known = model.restitution(x, V, "coarser") - own, True
    except RestitutionError:
        grid, known = np.zeros(V.size), False
    solver = here.error(V, "solver_error")
    return (
        Deviations(
            np.hypot(random, solver),
            freedom,
            np.array(others).reshape(-1, V.size),
            grid,
            here.error(V, "model_error"),
        ),
        known,
    )


def _systematic(by: Deviations) -> Array:
    """Standard deviations of COR by surface, grid and solver."""
    n = max(len(by.surfaces), 1)
    return np.asarray(np.sqrt((by.surfaces**2).sum(axis=0) / n + by.grid**2 + by.random**2))


def _result(
    model: CaseModel, measured: Measured, data: Data, best: Minimum, minima: Sequence[Minimum]
) -> Fit:
    V, x, freedom = data.velocity, best.x, data.velocity.size - best.x.size
    here: Mean = model.at(x)
    reduced = best.squares / max(freedom, 1)
    if measured.deviation is None:
        random, known_from = math.sqrt(reduced) * np.ones(V.size), float(freedom)
        weights = random if reduced > 0 else np.full(V.size, 1e-9)
    else:
        random, known_from = measured.deviation * math.sqrt(max(reduced, 1.0)), math.inf
        weights = data.deviation
    deviations, grid_known = _deviations(model, x, data, random, known_from)
    uncertainty = Uncertainty.of(jacobian(model, x, V), weights, deviations)
    ends = (V[0], V[-1])
    fine = np.geomspace(*ends, _FINE) if V[0] < V[-1] else V[:1]
    return Fit(
        model=model,
        measured=measured,
        x=x,
        fitted=here.restitution(V),
        resolved=here.resolved_at(V),
        weights=weights,
        deviations=deviations,
        uncertainty=uncertainty,
        minima=minima,
        curve=FittedCurve(fine, here.restitution(fine), uncertainty.band(jacobian(model, x, fine))),
        surfaces_asked=SURFACES if model.case(x).roughness else 0,
        grid_known=grid_known,
    )
