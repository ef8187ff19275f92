"""Restriction to a grid with cells twice as wide, and prolongation back to the finer grid.

Along each axis, cells are merged in pairs, starting with the first cell. If the number of cells is
odd, the last cell is not merged.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[np.float64]


@use_loop
def restrict(fine: Array, coarse: Array) -> None:
    """Write the means of `fine` over 2 × 2 nodes into `coarse`.

    If the number of rows is odd, the last row is used twice. The same holds for columns.
    """
    rows, columns = (n % 2 for n in fine.shape)
    fine = np.pad(fine, [(0, rows), (0, columns)], mode="edge")
    np.add(fine[::2, ::2], fine[1::2, ::2], out=coarse)
    coarse += fine[::2, 1::2]
    coarse += fine[1::2, 1::2]
    coarse *= 0.25


@use_loop
def prolong(coarse: Array, fine: Array) -> None:
    """Interpolate `coarse` linearly to the nodes of `fine`.

    Beyond the outermost coarse nodes the values are constant.
    """
    rows, columns = fine.shape
    taller = _doubled_rows(coarse)[:rows].T
    fine[...] = _doubled_rows(taller)[:columns].T


def _doubled_rows(coarse: Array) -> Array:
    """Interpolate linearly along the first axis to twice as many rows."""
    before = np.concatenate([coarse[:1], coarse[:-1]])
    after = np.concatenate([coarse[1:], coarse[-1:]])
    n, columns = coarse.shape
    fine = np.empty_like(coarse, shape=(2 * n, columns), order="C")
    fine[::2] = 0.75 * coarse + 0.25 * before
    fine[1::2] = 0.75 * coarse + 0.25 * after
    return fine
