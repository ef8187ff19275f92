"""Weighted least squares over the logarithms of parameters, from several first guesses.

lmfit does not replace this room: it computes no covariance of surfaces and grid, refuses profile
intervals of a single parameter, and computed 948 curves for those of two, where the whole fit
computes 276.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats.qmc import Halton

from restitution.errors import CaseError, RestitutionError
from restitution.fit.model import Array, CaseModel, Cost

RANGE = 30.0  # the search covers values from 1/30 to 30 times the first guess

# Step of finite differences in the logarithm of a parameter. The noise of the solver (1e-8) would
# allow a smaller one, but nodes of shallow contacts begin to yield one at a time, so COR is not
# smooth over changes by about 1 %.
_STEP = 0.03
_SCANNED, _STARTS = 15, 2  # points that `search_widely` tries, and searches from the best of them
DISTANCE = math.log(1.5)  # difference of a logarithm from which two minima count as different
_WORTH = 3.0  # `distinct` drops a minimum above this multiple of the smallest sum of squares
_FAILED = 1e3  # residual (in standard deviations) assigned to a case that cannot be solved
_EVALUATIONS = 40  # largest number of function evaluations of a search

# Relative tolerance for the sum of squares and for the logarithms. A full search starts from the
# result of a quick one.
_TOLERANCE: dict[Cost, float] = {"full": 1e-4, "quick": 1e-3}


@dataclass(frozen=True)
class Data:
    """Measured COR at velocities (m/s); residuals are divided by `deviation`."""

    velocity: Array
    restitution: Array
    deviation: Array


@dataclass(frozen=True)
class SearchEnd:
    """Where a search ended: ln(value/first guess), and the sum of squared weighted residuals."""

    x: Array
    squares: float


def jacobian(
    model: CaseModel, x: Array, velocity: Array, *, cost: Cost = "full", central: bool = True
) -> Array:
    """∂COR/∂x at `velocity` (m/s), shape (velocities, parameters), by finite differences.

    Sides on which the case cannot be solved are left out; without any, the derivative is 0.
    """
    here = model.restitution(x, velocity, cost)
    columns = []
    for axis in np.eye(x.size):
        slopes: list[Array] = []
        for step in (_STEP, -_STEP):
            if slopes and not central:
                break
            with suppress(RestitutionError):
                there = model.restitution(x + step * axis, velocity, cost)
                slopes.append((there - here) / step)
        columns.append(np.mean(slopes, axis=0) if slopes else np.zeros(velocity.size))
    return np.array(columns).T


def search(model: CaseModel, data: Data, start: Array, cost: Cost = "full") -> SearchEnd:
    """Search for a minimum from `start`; raise if the case cannot be solved there."""

    def safe(x: Array) -> Array:
        """Residuals, or values so large that the step is rejected."""
        try:
            return _residuals(model, data, x, cost)
        except RestitutionError:
            return np.full(data.velocity.size, _FAILED)

    _residuals(model, data, start, cost)  # may raise
    solution = least_squares(
        safe,
        start,
        jac=lambda x: (
            jacobian(model, x, data.velocity, cost=cost, central=False) / data.deviation[:, None]
        ),
        bounds=(-math.log(RANGE), math.log(RANGE)),
        ftol=_TOLERANCE[cost],
        xtol=_TOLERANCE[cost],
        gtol=1e-8,
        max_nfev=_EVALUATIONS,
    )
    return SearchEnd(np.asarray(solution.x), 2 * float(solution.cost))


def searches(
    model: CaseModel, data: Data, starts: Sequence[Array], cost: Cost = "full"
) -> Iterator[SearchEnd]:
    """Search from each of `starts` that can be solved; raise the first error if none can."""
    failures: list[RestitutionError] = []
    for start in starts:
        try:
            yield search(model, data, start, cost)
        except RestitutionError as error:
            failures.append(error)
    if len(failures) == len(starts):
        raise failures[0]


def search_widely(model: CaseModel, data: Data) -> list[SearchEnd]:
    """Search quickly from the first guess and the best of evenly spread points; best end first.

    Raises `CaseError` if the case can be solved at none of these starts.
    """

    guess = np.zeros(len(model.parameters))
    # Skip the first point of the sequence, which is at a corner of the range.
    even = Halton(guess.size, scramble=False).random(_SCANNED + 1)[1:]
    others = math.log(RANGE) * (2 * even - 1)
    scanned = [(_squares(model, data, x), k) for k, x in enumerate(others)]
    best = [others[k] for value, k in sorted(scanned)[:_STARTS] if math.isfinite(value)]
    try:
        minima = list(searches(model, data, [guess, *best], "quick"))
    except RestitutionError as error:
        raise CaseError(
            f"the case cannot be solved at the first guess of the parameters: {error}"
        ) from None
    return sorted(minima, key=lambda minimum: minimum.squares)


def distinct(minima: Sequence[SearchEnd]) -> list[SearchEnd]:
    """Select the first of `minima`, and others that differ from it and are not much worse.

    The first may come from a search at a different `Cost`, so its sum is not compared.
    """
    first, *others = minima
    least = min((other.squares for other in others), default=0.0)
    kept = [first]
    for minimum in others:
        far = all(np.abs(minimum.x - other.x).max() > DISTANCE for other in kept)
        if far and minimum.squares <= _WORTH * least:
            kept.append(minimum)
    return kept


def _residuals(model: CaseModel, data: Data, x: Array, cost: Cost) -> Array:
    return (model.restitution(x, data.velocity, cost) - data.restitution) / data.deviation


def _squares(model: CaseModel, data: Data, x: Array) -> float:
    try:
        return float(np.sum(_residuals(model, data, x, "quick") ** 2))
    except RestitutionError:
        return math.inf
