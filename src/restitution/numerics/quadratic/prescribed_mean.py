"""Minimisation within bounds at a prescribed mean of the unknowns, on a periodic grid.

    minimise  ½ pᵀK p + pᵀh   subject to   0 ≤ p ≤ upper,   mean(p) = `mean`.

For a given Lagrange multiplier D of the mean, p minimises ½ pᵀK p − pᵀ(D − h) within the bounds.
The mean increases with D, so a bracketed secant method finds D. Every solve starts from the
previous p, with a tolerance proportional to the estimated error of D.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from restitution.numerics.quadratic.grid_transfer import Fields, nested, prolonged
from restitution.numerics.quadratic.minimise import (
    Array,
    BoundedQuadratic,
    Minimum,
    minimise_quadratic,
)
from restitution.numerics.quadratic.multilevel import Operators

_MAX_SOLVES = 60  # largest number of solves on one grid

# Ratio of the tolerance of a solve to the estimated error of the multiplier D.
_ACCURACY = 0.05
# A violation of the optimality conditions causes an error of the mean. This is the largest allowed
# value of this error, as a fraction of the tolerance of the mean.
_MEAN_SHARE = 0.5
# `MeanTarget.residual` and `MeanTarget.precision` on coarser grids.
_COARSE_RESIDUAL, _COARSE_MEAN = 1e-2, 0.02


_Start = tuple[Array, float, float]  # p, multiplier D and slope dD/dmean


@dataclass(frozen=True)
class MeanTarget:
    """The prescribed mean of p with its relative tolerance `precision`.

    `compliance` is the value of K p for p = 1. `residual` limits the violation of the optimality
    conditions as a fraction of D − `compliance` · `mean`, with the multiplier D.
    """

    mean: float
    precision: float
    compliance: float
    residual: float

    def tolerance(self, multiplier: float, slope: float) -> float:
        """Largest allowed violation v of the optimality conditions, in the units of D.

        `slope` is dD/dmean: v changes the mean by at most v/slope.
        """
        by_residual = self.residual * abs(multiplier - self.compliance * self.mean)
        return min(by_residual, _MEAN_SHARE * self.precision * self.mean * slope)


@dataclass(frozen=True)
class MeanSolution:
    """The minimum, its Lagrange multiplier D, dD/dmean, and the products with K on its grid."""

    minimum: Minimum
    multiplier: float
    slope: float
    products: int


def minimise_at_mean(
    operators: Operators, h: Array, upper: float, target: MeanTarget, *, max_iterations: int
) -> MeanSolution:
    """Minimise ½ pᵀK p + pᵀh with 0 ≤ p ≤ `upper` at a prescribed mean of p, below `upper`.

    `h` has shape (nx, ny) and is not negative. The operators are periodic and positive definite.
    `max_iterations` limits the iterations of each solve. If the search does not converge,
    `converged` of the minimum is False.
    """

    def refine(coarse: Fields, start: _Start | None, fine: Fields, level: int) -> _Start:
        (h,), (finer,) = cast(tuple[Array], coarse), cast(tuple[Array], fine)
        rough = replace(target, precision=_COARSE_MEAN, residual=_COARSE_RESIDUAL)
        solution = _search(operators, h, upper, rough, start, max_iterations, level)
        return prolonged(solution.minimum.point, finer), solution.multiplier, solution.slope

    start = nested(refine, (h,), periodic=True)
    return _search(operators, h, upper, target, start, max_iterations, level=0)


def _search(
    operators: Operators,
    h: Array,
    upper: float,
    target: MeanTarget,
    start: _Start | None,
    max_iterations: int,
    level: int,
) -> MeanSolution:
    p, multiplier, slope = start or (
        np.zeros_like(h),
        target.compliance * target.mean + 0.5 * float(h.mean()),
        2 * target.compliance,
    )
    K, inverse = operators((h.shape[0], h.shape[1]), level)
    bracket = _Bracket(slope, target.compliance)
    # Estimated error of the multiplier D.
    error = _COARSE_RESIDUAL * abs(multiplier - target.compliance * target.mean)
    for _ in range(_MAX_SOLVES):
        b = multiplier - h
        tolerance = target.tolerance(multiplier, bracket.slope)
        minimum = minimise_quadratic(
            BoundedQuadratic.of(K, b, 0.0, upper),
            start=p,
            precondition=inverse,
            tolerance=max(tolerance, _ACCURACY * error),
            max_iterations=max_iterations,
            accept_estimated_gradient=level > 0,
        )
        mean = float(p.mean())
        meets = abs(mean - target.mean) <= target.precision * target.mean
        done = meets and minimum.residual <= tolerance
        if done or not minimum.converged:
            break
        if meets:  # the mean is accurate enough, but the solve needs a smaller tolerance
            error = 0.0
            continue
        following = bracket.following(multiplier, mean - target.mean, 2 * minimum.residual)
        multiplier, error = following, abs(following - multiplier)
    return MeanSolution(replace(minimum, converged=done), multiplier, bracket.slope, K.count)


class _Bracket:
    """Secant steps to the root of an increasing function that is negative at zero."""

    def __init__(self, slope: float, least_slope: float) -> None:
        """`slope` estimates dx/dy of the function y(x); later estimates are at least the least."""
        self.slope = slope
        self._least_slope = least_slope
        self._low, self._high = 0.0, math.inf
        self._before: tuple[float, float] | None = None

    def following(self, x: float, y: float, uncertainty: float) -> float:
        """Next argument to try, after the value `y` at an argument within `uncertainty` of `x`."""
        if y > 0:
            self._high = min(self._high, x + uncertainty)
        else:
            self._low = max(self._low, x - uncertainty)
        if self._before is not None and (y - self._before[1]) * (x - self._before[0]) > 0:
            secant = (x - self._before[0]) / (y - self._before[1])
            self.slope = max(secant, self._least_slope)
        self._before = x, y
        following = x - self.slope * y
        if self._low < following < self._high:
            return following
        return 0.5 * (self._low + self._high) if self._high < math.inf else 2 * x
