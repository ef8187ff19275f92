"""W_u/W_l between the velocities that were computed, and how far that may be off.

    W_u/W_l = q(ln V) − s/V²

q is interpolated by a monotone cubic (PCHIP). Adhesion takes about the same energy at every
velocity, which s/V² is (it is V_s² of an elastic pair: Thornton & Ning 1998); with s from the two
lowest velocities q is nearly level there, so that the ratio passes through zero where the pair
begins to rebound. Without adhesion s = 0.

What lies between two points is not known. Half way between them the error is the larger of one and
a half times what the two neighbours are off when they are interpolated from the others (leaving one
out), and of the difference to straight lines; of two points alone, all that they differ by. Towards
the points it falls to zero as 2 (t (1 − t))^½, t being the share of ln V within the interval: as
the standard deviation of a random walk that is known at both ends. How often it holds on rough
surfaces is in docs/dem.md.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_SAFETY = 1.5


class RatioCurve:
    """W_u/W_l against impact velocity, through points at increasing velocities (m/s)."""

    def __init__(self, velocities: Array, ratios: Array, *, adhesive: bool) -> None:
        self.velocities, self.ratios = velocities, ratios
        self.adhesion = 0.0
        if adhesive and velocities.size > 1:
            V0, V1 = velocities[:2]
            self.adhesion = max(0.0, float((ratios[1] - ratios[0]) / (V0**-2 - V1**-2)))
        self._L = np.log(velocities)
        self._q = ratios + self.adhesion / velocities**2

    def at(self, velocity: float) -> float:
        """The ratio at `velocity`, within those of the points."""
        return _pchip(self._L, self._q, math.log(velocity)) - self.adhesion / velocity**2

    def error(self, velocity: float) -> float:
        """How far the ratio may be off at `velocity`: continuous, and zero at the points."""
        if self.velocities.size == 1:
            return 0.0
        L = math.log(velocity)
        after, t = self.interval(velocity)
        line = abs(_pchip(self._L, self._q, L) - float(np.interp(L, self._L, self._q)))
        middle = _SAFETY * float(self._left_out[after - 1 : after + 1].max())
        return max(middle * 2 * math.sqrt(t * (1 - t)), line)

    def interval(self, velocity: float) -> tuple[int, float]:
        """The number of the point above `velocity`, and the share of ln V below it, 0 to 1."""
        L = math.log(velocity)
        after = min(max(int(np.searchsorted(self._L, L)), 1), self._L.size - 1)
        below, above = self._L[after - 1 : after + 1]
        return after, min(max(float((L - below) / (above - below)), 0.0), 1.0)

    def begins(self) -> float | None:
        """The velocity at which the pair begins to rebound.

        None where it does at every velocity that was computed, or at none of them.
        """
        sticking = np.flatnonzero(self.ratios <= 0)
        if not sticking.size or sticking[-1] == self.ratios.size - 1:
            return None
        from scipy.optimize import brentq

        below, above = self.velocities[sticking[-1] : sticking[-1] + 2]
        if self.ratios[sticking[-1]] == 0:
            return float(below)
        # Of ratios next to zero the sign may be lost in rounding.
        if self.at(above) <= 0 or self.at(below) >= 0:
            return float(above if self.at(above) <= 0 else below)
        return float(brentq(self.at, below, above))

    @cached_property
    def _left_out(self) -> Array:
        """Of each point, what it is off when interpolated from the others; the ends' neighbours."""
        n = self._L.size
        if n == 2:
            return np.full(2, abs(self._q[1] - self._q[0]) / _SAFETY)
        miss = np.zeros(n)
        for k in range(1, n - 1):
            others = np.arange(n) != k
            miss[k] = abs(_pchip(self._L[others], self._q[others], self._L[k]) - self._q[k])
        miss[0], miss[-1] = miss[1], miss[-2]
        return miss


def _pchip(x: Array, y: Array, at: float) -> float:
    from scipy.interpolate import PchipInterpolator

    with np.errstate(over="ignore"):  # the reciprocal of a slope of 1e-308, which is then zero
        return float(y[0]) if x.size == 1 else float(PchipInterpolator(x, y)(at))
