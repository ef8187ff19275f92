"""Diffusion on a graph: each node repeatedly takes a weighted sum of its neighbours' values."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[np.float64]


@use_loop
def diffuse(neighbours: NDArray[np.intp], weights: Array, steps: int, values: Array) -> None:
    """Replace the two values at each node by weighted sums over its neighbours, `steps` times.

    `neighbours` (node indices) and `weights` have shape (nodes, neighbours). `values` has shape
    (nodes, 2) and is overwritten. The indices run from 0 to nodes − 1; a larger index raises
    `IndexError`.
    """
    for _ in range(steps):
        values[...] = np.einsum("ij,ijk->ik", weights, values[neighbours])
