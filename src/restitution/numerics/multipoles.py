"""Multipole series on a grid, for a source that is symmetric about both axes."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[np.float64]


@use_loop
def multipoles(x: Array, y: Array, moments: Array, out: Array) -> None:
    """Write Σ_kl moments[k, l] c^l / r^(2k + 1) into `out`, shape (nx, ny).

    The coordinates `x` and `y` of the nodes have shapes (nx, 1) and (1, ny), and r² = x² + y².
    c = x²/r² is the squared direction cosine along x. `moments` has shape (3, 3).
    """
    s = 1.0 / (x * x + y * y)
    c = x * x * s
    out[...] = 0.0
    for row in moments[::-1]:
        out *= s
        out += (row[2] * c + row[1]) * c + row[0]
    out *= np.sqrt(s)
