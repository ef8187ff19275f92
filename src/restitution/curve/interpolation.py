"""Interpolation of W_u/W_l between the computed velocities, with an error estimate.

    W_u/W_l = q(ln V) − s/V²

A monotone cubic (PCHIP) interpolates q. s/V² is a loss by adhesion that is the same at every
velocity (Thornton & Ning 1998: s is the square of the sticking velocity); s makes q equal at the
two lowest velocities, and is at least 0. docs/dem.md says how often the error estimate holds.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

# Ratio of the error estimate in the middle of an interval to the leave-one-out residual.
_SAFETY = 1.5


class RatioCurve:
    """W_u/W_l between impact velocities.

    `velocities` (m/s, increasing) and `ratios` have shape (points,).
    """

    def __init__(self, velocities: Array, ratios: Array, *, adhesive: bool) -> None:
        self.velocities, self.ratios = velocities, ratios
        self.adhesion = 0.0
        if adhesive and velocities.size > 1:
            V0, V1 = velocities[:2]
            self.adhesion = max(0.0, float((ratios[1] - ratios[0]) / (V0**-2 - V1**-2)))
        self._L = np.log(velocities)
        self._q = ratios + self.adhesion / velocities**2

    def at(self, velocity: float) -> float:
        """The ratio at `velocity` (m/s), which must be in the range of `velocities`."""
        return float(self._cubic(math.log(velocity))) - self.adhesion / velocity**2

    def error(self, velocity: float) -> float:
        """Error estimate of the ratio at `velocity` (m/s), continuous and zero at the points.

        The larger of two: 1.5 times the larger leave-one-out residual of the two points beside it,
        times 2 (t (1 − t))^½ (as of a random walk with both ends fixed), where t is the position
        between them; and the difference from linear interpolation.
        """
        if self.velocities.size == 1:
            return 0.0
        L = math.log(velocity)
        after, t = self.interval(velocity)
        line = abs(float(self._cubic(L)) - float(np.interp(L, self._L, self._q)))
        middle = _SAFETY * float(self._left_out[after - 1 : after + 1].max())
        return max(middle * 2 * math.sqrt(t * (1 - t)), line)

    def interval(self, velocity: float) -> tuple[int, float]:
        """Index of the point above `velocity` (m/s), and the position (0 to 1) of ln V below it."""
        L = math.log(velocity)
        after = min(max(int(np.searchsorted(self._L, L)), 1), self._L.size - 1)
        below, above = self._L[after - 1 : after + 1]
        return after, min(max(float((L - below) / (above - below)), 0.0), 1.0)

    def begins(self) -> float | None:
        """The velocity (m/s) above which the pair rebounds.

        None if it rebounds at every computed velocity, or at none.
        """
        sticking = np.flatnonzero(self.ratios <= 0)
        if not sticking.size or sticking[-1] == self.ratios.size - 1:
            return None
        from scipy.optimize import brentq

        below, above = self.velocities[sticking[-1] : sticking[-1] + 2]
        if self.ratios[sticking[-1]] == 0:
            return float(below)
        # Rounding can change the sign of a nearly zero ratio. `brentq` needs opposite signs.
        if self.at(above) <= 0 or self.at(below) >= 0:
            return float(above if self.at(above) <= 0 else below)
        return float(brentq(self.at, below, above))

    @cached_property
    def _cubic(self) -> Callable[[float], Array]:
        return _pchip(self._L, self._q)

    @cached_property
    def _left_out(self) -> Array:
        """Leave-one-out residuals; an end point has that of its neighbour."""
        n = self._L.size
        if n == 2:
            return np.full(2, abs(self._q[1] - self._q[0]) / _SAFETY)
        miss = np.zeros(n)
        for k in range(1, n - 1):
            others = np.arange(n) != k
            left = _pchip(self._L[others], self._q[others])
            miss[k] = abs(float(left(float(self._L[k]))) - self._q[k])
        miss[0], miss[-1] = miss[1], miss[-2]
        return miss


def root(ratio: float) -> float:
    """COR of W_u/W_l."""
    return math.sqrt(min(max(ratio, 0.0), 1.0))


def _pchip(x: Array, y: Array) -> Callable[[float], Array]:
    from scipy.interpolate import PchipInterpolator

    if x.size == 1:
        return lambda _: y[0]
    # PCHIP divides by the slopes between the points. A slope of 1e-308 makes the quotient infinite,
    # and the derivative at the point becomes 0, which is accurate enough.
    with np.errstate(over="ignore"):
        cubic: Callable[[float], Array] = PchipInterpolator(x, y)
    return cubic
