"""Sums and maxima over arrays, on any device."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # of double or single precision


@use_loop
def max_magnitude(values: Array) -> float:
    """The largest magnitude; NaN if a value is NaN."""
    return float(np.maximum(values.max(), -values.min()))


def dot(a: Array, b: Array) -> float:
    """Σ a b in double precision."""
    # Not np.vdot: its threads wait for each other longer than these products take.
    return float(np.einsum("ij,ij->", a, b, dtype=np.float64))
