"""Weighted least squares over the logarithms of parameters, from several first guesses."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from restitution.errors import CaseError, RestitutionError
from restitution.fit.model import Array, CaseModel, Cost

RANGE = 30.0  # the search covers values from 1/30 to 30 times the first guess

# Step of finite differences in the logarithm of a parameter. The noise of the solver (1e-8) would
# allow a smaller step. But over changes of a parameter by about 1 %, the COR of shallow contacts is
# not smooth, because nodes begin to yield one at a time.
_STEP = 0.03
# `search_widely` computes the sum of squares at `_SCANNED` points. It then starts searches from the
# first guess and from the best `_STARTS` of these points.
_SCANNED, _STARTS = 15, 2
# Two minima count as different if the logarithm of a parameter differs by more than this value.
DISTANCE = math.log(1.5)
# `distinct` drops a minimum if its sum of squares is above this multiple of the smallest sum of
# squares.
_WORTH = 3.0
_FAILED = 1e3  # residual (in standard deviations) assigned to a case that cannot be solved
_EVALUATIONS = 40  # largest number of function evaluations of a search

# Relative tolerance of a search, for the sum of squares and for the logarithms of the parameters. A
# quick search needs less accuracy, because a full search starts from its result.
_TOLERANCE: dict[Cost, float] = {"full": 1e-4, "quick": 1e-3}


@dataclass(frozen=True)
class Data:
    """Measured COR at impact velocities (m/s).

    `deviation` contains the standard deviations by which residuals are divided.
    """

    velocity: Array
    restitution: Array
    deviation: Array


@dataclass(frozen=True)
class Minimum:
    """The parameters at which a search ended, and their sum of squares.

    `x` holds ln(value/first guess) of each parameter, and `squares` is the sum of squared weighted
    residuals.
    """

    x: Array
    squares: float


def jacobian(
    model: CaseModel, x: Array, velocity: Array, *, cost: Cost = "full", central: bool = True
) -> Array:
    """∂COR/∂x at `velocity` (m/s), shape (velocities, parameters), by finite differences.

    The differences are one-sided if `central` is false. If the case cannot be solved on one side,
    only the other side is used. If it cannot be solved on either side, the derivative is set to 0.
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


def search(model: CaseModel, data: Data, start: Array, cost: Cost = "full") -> Minimum:
    """Search for a minimum from `start`.

    Raises `RestitutionError` if the case cannot be solved at `start`.
    """
    from scipy.optimize import least_squares

    def safe(x: Array) -> Array:
        """Return the residuals.

        If the case cannot be solved, return residuals so large that the step is rejected.
        """
        try:
            return _residuals(model, data, x, cost)
        except RestitutionError:
            return np.full(data.velocity.size, _FAILED)

    _residuals(model, data, start, cost)  # raises if the case cannot be solved at the start
    found = least_squares(
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
    return Minimum(np.asarray(found.x), 2 * float(found.cost))


def searches(
    model: CaseModel, data: Data, starts: Sequence[Array], cost: Cost = "full"
) -> Iterator[Minimum]:
    """Search from each of `starts`. Skip a start if the case cannot be solved there.

    If all starts are skipped, the `RestitutionError` of the first start is raised.
    """
    failures: list[RestitutionError] = []
    for start in starts:
        try:
            yield search(model, data, start, cost)
        except RestitutionError as error:
            failures.append(error)
    if len(failures) == len(starts):
        raise failures[0]


def search_widely(model: CaseModel, data: Data) -> list[Minimum]:
    """Return the minima of searches with `cost="quick"`, the best first.

    `_SCANNED` points are spread evenly over the range of the logarithms of the parameters. The
    searches start from the first guess, and from the `_STARTS` points with the smallest sums of
    squares. A start is skipped if the case cannot be solved there. Raises `CaseError` if all
    starts are skipped.
    """
    from scipy.stats.qmc import Halton

    guess = np.zeros(len(model.parameters))
    # Skip the first point of the sequence, which is at a corner of the range.
    even = Halton(guess.size, scramble=False).random(_SCANNED + 1)[1:]
    others = math.log(RANGE) * (2 * even - 1)
    scanned = [(_squares(model, data, x), k) for k, x in enumerate(others)]
    best = [others[k] for value, k in sorted(scanned)[:_STARTS] if math.isfinite(value)]
    try:
        found = list(searches(model, data, [guess, *best], "quick"))
    except RestitutionError as error:
        raise CaseError(
            f"the case cannot be solved at the first guess of the parameters: {error}"
        ) from None
    return sorted(found, key=lambda minimum: minimum.squares)


def distinct(minima: Sequence[Minimum]) -> list[Minimum]:
    """Select minima that differ from each other, as starts of further searches.

    The first of `minima` is always kept. Another minimum is kept if it meets two conditions. It
    must differ by more than `DISTANCE` from all minima that are already kept. Its sum of squares
    must be at most `_WORTH` times the smallest sum of squares of all minima except the first. The
    first minimum may come from a search at a different `Cost`, so its sum is not comparable.
    """
    first, *others = minima
    least = min((other.squares for other in others), default=0.0)
    kept = [first]
    for each in others:
        far = all(np.abs(each.x - other.x).max() > DISTANCE for other in kept)
        if far and each.squares <= _WORTH * least:
            kept.append(each)
    return kept


def _residuals(model: CaseModel, data: Data, x: Array, cost: Cost) -> Array:
    """Computed minus measured COR, divided by the standard deviations `data.deviation`."""
    return (model.restitution(x, data.velocity, cost) - data.restitution) / data.deviation


def _squares(model: CaseModel, data: Data, x: Array) -> float:
    """Sum of squared weighted residuals with `cost="quick"`; inf if the case cannot be solved."""
    try:
        return float(np.sum(_residuals(model, data, x, "quick") ** 2))
    except RestitutionError:
        return math.inf
