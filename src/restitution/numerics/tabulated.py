"""A smooth function of one variable on a uniform table, with its derivative and integral."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Tabulated:
    """Monotone cubic interpolation of `values` at `first` + k `step`, linear beyond both ends.

    Source:
        Fritsch and Carlson (1980), SIAM J. Numer. Anal. 17, 238–246.
    """

    first: float
    step: float
    values: Array

    @property
    def last(self) -> float:
        return self.first + self.step * (self.values.size - 1)

    @property
    def points(self) -> Array:
        """The arguments of `values`."""
        return np.asarray(self.first + self.step * np.arange(self.values.size))

    @property
    def whole(self) -> float:
        """Integral from `first` to `last`."""
        return float(self._sums[-1] * self.step)

    def linear(self, values: Array, x: Array) -> Array:
        """Interpolate other `values` on this table, constant beyond both ends."""
        at = (np.asarray(x) - self.first) / self.step
        return np.asarray(np.interp(at, np.arange(values.size), values))

    @cached_property
    def _coefficients(self) -> tuple[Array, Array, Array, Array]:
        """Coefficients of each cell for 1, t, t² and t³, with t from 0 to 1."""
        from scipy.interpolate import PchipInterpolator

        c = PchipInterpolator(np.arange(self.values.size), self.values).c
        return c[3], c[2], c[1], c[0]

    @cached_property
    def _sums(self) -> Array:
        """Integral from `first` to the left end of each cell, in units of `step`."""
        a, b, c, d = self._coefficients
        return np.concatenate([[0.0], np.cumsum(a + b / 2 + c / 3 + d / 4)])

    def __call__(self, x: Array) -> tuple[Array, Array, Array]:
        """The integral from `first` to `x`, the value and the derivative at `x`."""
        a, b, c, d = self._coefficients
        at = (np.asarray(x, dtype=float) - self.first) / self.step
        cell = np.clip(at.astype(np.intp), 0, a.size - 1)
        inside = np.clip(at, 0.0, float(a.size))
        t, beyond = inside - cell, at - inside
        a, b, c, d = a[cell], b[cell], c[cell], d[cell]
        value = a + t * (b + t * (c + t * d))
        slope = b + t * (2 * c + 3 * t * d)
        total = self._sums[cell] + t * (a + t * (b / 2 + t * (c / 3 + t * d / 4)))
        total += beyond * (value + 0.5 * slope * beyond)
        value += slope * beyond
        return total * self.step, value, slope / self.step
