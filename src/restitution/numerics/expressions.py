"""Array expressions whose compiled loops have the same names (see `kernels`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double or single precision


@use_loop
def max_magnitude(values: Array) -> float:
    """Largest magnitude; NaN if a value is NaN."""
    return float(np.maximum(values.max(), -values.min()))


@use_loop
def dot(a: Array, b: Array) -> float:
    """Σ a b, summed in double precision."""
    # np.vdot would use threads, whose synchronisation takes longer than the products themselves.
    return float(np.einsum("ij,ij->", a, b, dtype=np.float64))


@use_loop
def diffuse(neighbours: NDArray[np.intp], weights: Array, steps: int, values: Array) -> None:
    """Replace the two values at each node by weighted sums over its neighbours, `steps` times.

    `neighbours` (node indices) and `weights` have shape (nodes, neighbours), `values` (nodes, 2).
    An index above nodes − 1 raises `IndexError`.
    """
    for _ in range(steps):
        values[...] = np.einsum("ij,ijk->ik", weights, values[neighbours])


@use_loop
def multipoles(x: Array, y: Array, moments: Array, out: Array) -> None:
    """Write Σ_kl moments[k, l] c^l / r^(2k + 1) into `out`, with c = x²/r² and r² = x² + y².

    `x` has shape (nx, 1), `y` (1, ny), `moments` (3, 3) and `out` (nx, ny).
    """
    s = 1.0 / (x * x + y * y)
    c = x * x * s
    out[...] = 0.0
    for row in moments[::-1]:
        out *= s
        out += (row[2] * c + row[1]) * c + row[0]
    out *= np.sqrt(s)
