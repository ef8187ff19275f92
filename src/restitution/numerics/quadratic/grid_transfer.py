"""Restriction to a grid with cells twice as wide, prolongation back, and nested iteration.

Along each axis, cells are merged in pairs, starting with the first cell. If the number of cells is
odd, the last cell is not merged.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[np.float64]
Guess = TypeVar("Guess")
Fields = tuple[Array | float, ...]

# A grid is coarsened if its shorter edge has at least this number of nodes. On smaller grids the
# guess costs more time than it saves.
_MIN_NODES_TO_COARSEN = 80


def nested(
    refine: Callable[[Fields, Guess | None, Fields, int], Guess],
    fine: Fields,
    *,
    periodic: bool = False,
    level: int = 1,
) -> Guess | None:
    """Guess on the grid of `fine` by nested iteration; None if this grid is not coarsened.

    Venner and Lubrecht 2000, *Multilevel Methods in Lubrication*.

    `fine` holds the arrays (nx, ny) and numbers of a problem. `refine(coarse, start, fine, level)`
    solves it with the restricted arrays `coarse`, on cells 2**level times as wide as the finest,
    from `start` (the guess on that grid), and returns the solution prolonged to the grid of `fine`.
    """
    if not may_coarsen(np.shape(fine[0]), periodic):
        return None
    coarse = tuple(field if isinstance(field, (int, float)) else coarsened(field) for field in fine)
    return refine(coarse, nested(refine, coarse, periodic=periodic, level=level + 1), fine, level)


def may_coarsen(shape: tuple[int, ...], periodic: bool) -> bool:
    """Whether a grid of this shape is large enough and, if periodic, of even size."""
    even = all(n % 2 == 0 for n in shape)
    return min(shape) >= _MIN_NODES_TO_COARSEN and (even or not periodic)


def coarsened(values: Array) -> Array:
    """Means of `values` over 2 × 2 nodes, in a new array."""
    rows, columns = values.shape
    coarse = np.empty_like(values, shape=((rows + 1) // 2, (columns + 1) // 2), order="C")
    restrict(values, coarse)
    return coarse


def prolonged(coarse: Array, like: Array) -> Array:
    """`coarse` interpolated to the nodes of `like`, in a new array."""
    fine = np.empty_like(like, order="C")
    prolong(coarse, fine)
    return fine


@use_loop
def restrict(fine: Array, coarse: Array) -> None:
    """Write means over 2 × 2 nodes to `coarse`; an odd last row or column counts twice."""
    rows, columns = (n % 2 for n in fine.shape)
    fine = np.pad(fine, [(0, rows), (0, columns)], mode="edge")
    np.add(fine[::2, ::2], fine[1::2, ::2], out=coarse)
    coarse += fine[::2, 1::2]
    coarse += fine[1::2, 1::2]
    coarse *= 0.25


@use_loop
def prolong(coarse: Array, fine: Array) -> None:
    """Interpolate `coarse` linearly to `fine`, constant beyond the outermost coarse nodes."""
    rows, columns = fine.shape
    taller = _doubled_rows(coarse)[:rows].T
    fine[...] = _doubled_rows(taller)[:columns].T


def _doubled_rows(coarse: Array) -> Array:
    before = np.concatenate([coarse[:1], coarse[:-1]])
    after = np.concatenate([coarse[1:], coarse[-1:]])
    n, columns = coarse.shape
    fine = np.empty_like(coarse, shape=(2 * n, columns), order="C")
    fine[::2] = 0.75 * coarse + 0.25 * before
    fine[1::2] = 0.75 * coarse + 0.25 * after
    return fine
