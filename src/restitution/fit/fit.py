"""Fit parameters of a case to measured coefficients of restitution."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.case.case import Case
from restitution.case.case_file import parse_case, parse_toml
from restitution.display import counted
from restitution.errors import CaseError, RestitutionError
from restitution.fit.least_squares import (
    Data,
    SearchEnd,
    distinct,
    jacobian,
    search_widely,
    searches,
)
from restitution.fit.measured import ASSUMED, Measured
from restitution.fit.model import Array, CaseModel, restitution
from restitution.fit.parameters import Parameter, free_parameters
from restitution.fit.uncertainty import MODEL_SHARES, Deviations, Uncertainty
from restitution.runs.log import Say, ignore
from restitution.runs.refinement import with_chosen_grids
from restitution.sweeps.sweep import put

_FINE = 60  # number of velocities of the fitted curve
_LEAST_NOISE = 1e-4  # accuracy of the interpolation of COR between velocities


@dataclass(frozen=True)
class FittedCurve:
    """The fitted COR at velocities (m/s), with the half-width of its 95 % confidence band."""

    velocity: Array
    restitution: Array
    half_band: Array


@dataclass(frozen=True)
class Fit:
    """The result of a fit.

    `x` holds ln(value/first guess) of each parameter, `fitted` is COR at the measured velocities,
    and residuals were divided by `weights`. `minima` are the ends of all searches, best first.
    """

    model: CaseModel
    measured: Measured
    x: Array
    fitted: Array
    resolved: NDArray[np.bool_]
    weights: Array
    deviations: Deviations
    uncertainty: Uncertainty
    minima: Sequence[SearchEnd]
    curve: FittedCurve

    @property
    def parameters(self) -> Sequence[Parameter]:
        return self.model.parameters

    @property
    def factors(self) -> list[float]:
        """Ratios of fitted values to first guesses."""
        return [math.exp(x) for x in self.x.tolist()]

    @property
    def residuals(self) -> Array:
        return self.measured.restitution - self.fitted

    @property
    def chi_squared(self) -> float:
        return float(np.sum((self.residuals / self.weights) ** 2))

    @property
    def freedom(self) -> int:
        return self.measured.velocity.size - self.x.size


def fit(
    text: str,
    folder: Path,
    measured: Measured,
    names: Sequence[str],
    progress: Say = ignore,
) -> Fit:
    """Fit keys of a case to measured COR.

    Args:
        text: Content of the case file, with the first guesses.
        folder: File names in `text` are relative to it.
        measured: Its velocities replace the indentations, loads or velocities of the case.
        names: Keys to be fitted, whole ("roughness.rms") or their last parts.
        progress: Called with the number of curves computed so far, as a short text.

    Raises:
        RestitutionError: A key cannot be fitted, or the fitted case cannot be solved.
    """
    content = parse_toml(text)
    parse_case(text).require_impact()
    parameters = free_parameters(content, names)
    _check_points(measured, len(parameters))
    V = measured.velocity
    model = CaseModel(content, folder, parameters, float(V[0]), float(V[-1]), progress)
    start = np.zeros(len(parameters))
    case = model.case(start)
    if case.grid.refine == "auto":  # use the factor that resolves the case with the first guess
        put(content, "grid.refine", with_chosen_grids(case, folder).grid.factor)
    model.require_possible(start)
    given = measured.deviation
    data = Data(V, measured.restitution, np.full(V.size, ASSUMED) if given is None else given)
    minima = search_widely(model, data)
    # The minima are those on cells twice as large. On the grid of the case, start from the best at
    # which it can be solved.
    best = next(searches(model, data, [minimum.x for minimum in minima]))
    # Give less weight to points whose COR differs between random surfaces or between grids.
    noise = _noise(measured, model.restitution(best.x, V), best.x.size)
    data = replace(data, deviation=np.hypot(noise, _deviations(model, best.x, V).systematic))
    ends = searches(model, data, [minimum.x for minimum in distinct([best, *minima])])
    return _result(model, measured, data, sorted(ends, key=lambda end: end.squares))


def _check_points(measured: Measured, parameters: int) -> None:
    points = measured.velocity.size
    if points < parameters:
        raise CaseError(
            f"--free: {counted(points, 'measured point')} cannot determine "
            f"{counted(parameters, 'key')}; measure more points, or free fewer keys"
        )
    if points == parameters and measured.deviation is None:
        raise CaseError(
            "--free: the noise cannot be estimated from residuals, because there are as many keys "
            f"as measured points ({points}); add the column restitution_std, or measure more points"
        )


def _deviations(model: CaseModel, x: Array, velocity: Array) -> Deviations:
    """Deviations at the parameters `x`; `random` is only the error of the solver."""
    here = model.at(x)
    own = here.restitution(velocity)
    by_surface = np.array([restitution(curve, velocity) for curve in here.curves])
    try:
        grid: Array | None = model.restitution(x, velocity, "coarser") - own
    except RestitutionError:
        grid = None
    return Deviations(
        random=here.error(velocity, "restitution_error"),
        freedom=math.inf,
        surfaces=by_surface - own,
        grid=grid,
        model=here.error(velocity, "model_error"),
        model_share=_model_share(model.case(x)),
    )


def _model_share(case: Case) -> float:
    if case.interface.adhesive_energy > 0:
        return 1.0
    return MODEL_SHARES[case.yielding().plasticity]


def _noise(measured: Measured, fitted: Array, parameters: int) -> Array:
    if measured.deviation is not None:
        return measured.deviation
    freedom = fitted.size - parameters
    squares = float(np.sum((measured.restitution - fitted) ** 2))
    return np.full(fitted.size, max(math.sqrt(squares / freedom), _LEAST_NOISE))


def _result(model: CaseModel, measured: Measured, data: Data, minima: Sequence[SearchEnd]) -> Fit:
    best = minima[0]
    V, x, freedom = data.velocity, best.x, data.velocity.size - best.x.size
    here = model.at(x)
    noise = _noise(measured, here.restitution(V), x.size)
    if measured.deviation is not None and freedom > 0:
        noise = noise * math.sqrt(max(best.squares / freedom, 1.0))
    by = _deviations(model, x, V)
    deviations = replace(
        by,
        random=np.hypot(noise, by.random),
        freedom=float(freedom) if measured.deviation is None else math.inf,
    )
    uncertainty = Uncertainty.of(jacobian(model, x, V), data.deviation, deviations)
    fine = np.geomspace(V[0], V[-1], _FINE) if V[0] < V[-1] else V[:1]
    return Fit(
        model=model,
        measured=measured,
        x=x,
        fitted=here.restitution(V),
        resolved=here.resolved_at(V),
        weights=data.deviation,
        deviations=deviations,
        uncertainty=uncertainty,
        minima=minima,
        curve=FittedCurve(fine, here.restitution(fine), uncertainty.band(jacobian(model, x, fine))),
    )
