"""Minimisation within bounds at a prescribed mean of the unknowns, on a periodic grid.

    minimise  ½ pᵀK p + pᵀh   subject to   0 ≤ p ≤ upper,   mean(p) = `mean`.

The prescribed mean has a Lagrange multiplier D, which is a scalar. For a given D, p minimises
½ pᵀK p − pᵀ(D − h) within the bounds. The mean of p increases with D, so a bracketed secant method
finds the D at which the mean is as prescribed. Every solve for p starts from the previous p. Its
tolerance is proportional to the estimated error of D. The same problem is solved first on the next
coarser grid, which gives the initial D, p and slope dD/dmean.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from restitution.numerics.quadratic.grid_transfer import prolong
from restitution.numerics.quadratic.minimise import (
    Array,
    BoundedQuadratic,
    Minimum,
    minimise_quadratic,
)
from restitution.numerics.quadratic.multilevel import Operators, coarsened, may_coarsen

_MAX_SOLVES = 60  # largest number of solves on one grid

# Ratio of the tolerance of a solve to the estimated error of the multiplier D.
_ACCURACY = 0.05
# A violation of the optimality conditions causes an error of the mean. This is the largest allowed
# value of this error, as a fraction of the tolerance of the mean.
_MEAN_SHARE = 0.5
# `MeanTarget.residual` and `MeanTarget.precision` on coarser grids.
_COARSE_RESIDUAL, _COARSE_MEAN = 1e-2, 0.02


@dataclass(frozen=True)
class MeanTarget:
    """The prescribed mean of p, and the tolerances of `minimise_at_mean`.

    `mean` is the prescribed mean and `precision` its relative tolerance. `compliance` is the value
    of K p for a constant p = 1. `residual` limits the violation of the optimality conditions as a
    fraction of D − `compliance` · `mean`, where D is the multiplier.
    """

    mean: float
    precision: float
    compliance: float
    residual: float

    def tolerance(self, multiplier: float, slope: float) -> float:
        """Return the largest allowed violation of the optimality conditions.

        `multiplier` is the Lagrange multiplier D, and `slope` is dD/dmean. The result has the units
        of D. It is the smaller of two limits. The first limit is `residual` times
        |D − `compliance` · `mean`|. The second limit is `slope` times the allowed error of the
        mean, because a violation v changes the mean by at most v/slope.
        """
        by_residual = self.residual * abs(multiplier - self.compliance * self.mean)
        return min(by_residual, _MEAN_SHARE * self.precision * self.mean * slope)


@dataclass(frozen=True)
class MeanSolution:
    """The minimum at the prescribed mean, with its Lagrange multiplier D.

    `slope` is dD/dmean. `products` is the number of products with the matrix K on the grid of the
    minimum. It does not include products on coarser grids.
    """

    minimum: Minimum
    multiplier: float
    slope: float
    products: int


def minimise_at_mean(
    operators: Operators,
    h: Array,
    upper: float,
    target: MeanTarget,
    *,
    max_iterations: int,
    level: int = 0,
) -> MeanSolution:
    """Minimise ½ pᵀK p + pᵀh with 0 ≤ p ≤ `upper` at a prescribed mean of p.

    The mean must be below `upper`. `h` has shape (nx, ny) and is not negative. The operators are
    periodic and positive definite. `max_iterations` limits the iterations of each solve. `level` is
    the level of the grid of `h` (0: finest). If the search does not converge, `converged` of the
    minimum is False; no exception is raised.
    """
    p = np.zeros_like(h)
    multiplier = target.compliance * target.mean + 0.5 * float(h.mean())
    slope = 2 * target.compliance
    if may_coarsen(h.shape, periodic=True):
        coarse = minimise_at_mean(
            operators,
            coarsened(h),
            upper,
            replace(target, precision=_COARSE_MEAN, residual=_COARSE_RESIDUAL),
            max_iterations=max_iterations,
            level=level + 1,
        )
        prolong(coarse.minimum.point, p)
        multiplier, slope = coarse.multiplier, coarse.slope
    K, inverse = operators((h.shape[0], h.shape[1]), level)
    bracket = _Bracket(slope, target.compliance)
    # Estimated error of the multiplier D.
    error = _COARSE_RESIDUAL * abs(multiplier - target.compliance * target.mean)
    for _ in range(_MAX_SOLVES):
        b = multiplier - h
        tolerance = target.tolerance(multiplier, bracket.slope)
        found = minimise_quadratic(
            BoundedQuadratic(K, b, 0.0, upper, K.single_precision),
            start=p,
            precondition=inverse,
            tolerance=max(tolerance, _ACCURACY * error),
            max_iterations=max_iterations,
            accept_estimated_gradient=level > 0,
        )
        mean = float(p.mean())
        meets = abs(mean - target.mean) <= target.precision * target.mean
        done = meets and found.residual <= tolerance
        if done or not found.converged:
            break
        if meets:  # the mean is accurate enough, but the solve needs a smaller tolerance
            error = 0.0
            continue
        following = bracket.following(multiplier, mean - target.mean, 2 * found.residual)
        multiplier, error = following, abs(following - multiplier)
    return MeanSolution(replace(found, converged=done), multiplier, bracket.slope, K.count)


class _Bracket:
    """Secant steps to the root of an increasing function that is negative at zero."""

    def __init__(self, slope: float, least_slope: float) -> None:
        """Start with `slope` as the estimate of dx/dy for the function y(x).

        Later estimates are at least `least_slope`.
        """
        self.slope = slope
        self._least_slope = least_slope
        self._low, self._high = 0.0, math.inf
        self._before: tuple[float, float] | None = None

    def following(self, x: float, y: float, uncertainty: float) -> float:
        """Return the next argument to try.

        `y` is the latest function value, computed at the argument `x`. This value has an error: it
        is the exact value at an unknown argument, at most `uncertainty` away from `x`.
        """
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
