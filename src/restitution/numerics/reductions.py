"""Sums and maxima over arrays, on any device."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double or single precision


@use_loop
def max_magnitude(values: Array) -> float:
    """Return the largest magnitude; NaN if a value is NaN."""
    return float(np.maximum(values.max(), -values.min()))


@use_loop
def dot(a: Array, b: Array) -> float:
    """Return Σ a b, summed in double precision."""
    # np.vdot would use threads, whose synchronisation takes longer than the products themselves.
    return float(np.einsum("ij,ij->", a, b, dtype=np.float64))
