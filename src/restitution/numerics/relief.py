"""Ridges and valleys of an array of heights."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double precision

_FROM, _TO = slice(1, None), slice(None, -1)
_ALL = slice(None)
_STRIP = 32  # rows computed at a time, so that intermediate arrays stay in the cache
# Two blocks of the grid for each of the eight directions. The first block contains all nodes that
# have a neighbour in this direction. The second block contains these neighbours.
_NEIGHBOURS = [
    ((to_x, to_y), (from_x, from_y))
    for to_x, from_x in ((_TO, _FROM), (_ALL, _ALL), (_FROM, _TO))
    for to_y, from_y in ((_TO, _FROM), (_ALL, _ALL), (_FROM, _TO))
    if (to_x, to_y) != (_ALL, _ALL)
]


@use_loop
def ridge_shape(heights: Array, hx: float, hy: float, out: Array) -> None:
    """Write (1 − κ₂/κ₁)² into `out`, and 0 at the outermost nodes.

    κ₁ ≥ κ₂ are the magnitudes of the principal curvatures, from second differences on nodes with
    the distances `hx` and `hy`.
    """
    rows = heights.shape[0]
    for first in range(0, rows, _STRIP):
        last, above = min(first + _STRIP, rows), max(first - 1, 0)
        strip = _ridge_shape(heights[above : last + 1], hx, hy)
        out[first:last] = strip[first - above : last - above]


@use_loop
def lowest_downhill(heights: Array, out: Array) -> None:
    """Write the height at the end of the steepest descent from each node into `out`.

    A step leads to the lowest of the eight neighbours; of equal ones, to the first in memory.
    """
    nodes = np.arange(heights.size).reshape(heights.shape)
    lowest = heights.copy()
    _take_smaller_neighbours(lowest, heights, axis=0)
    _take_smaller_neighbours(lowest, lowest.copy(), axis=1)
    following = nodes.copy()
    for at, neighbour in _NEIGHBOURS:
        np.copyto(following[at], nodes[neighbour], where=heights[neighbour] == lowest[at])
    np.copyto(following, nodes, where=heights == lowest)
    path = following.ravel()
    while True:  # each pass doubles the length of the paths
        longer = np.take(path, path, mode="clip")
        if np.array_equal(longer, path):
            out[...] = heights.ravel()[path].reshape(heights.shape)
            return
        path = longer


def _ridge_shape(heights: Array, hx: float, hy: float) -> Array:
    inner = slice(1, -1)
    shape = np.zeros(heights.shape)
    xx = (heights[2:, inner] - 2 * heights[inner, inner] + heights[:-2, inner]) / hx**2
    yy = (heights[inner, 2:] - 2 * heights[inner, inner] + heights[inner, :-2]) / hy**2
    xy = heights[2:, 2:] - heights[2:, :-2] - heights[:-2, 2:] + heights[:-2, :-2]
    xy /= 4 * hx * hy
    mean, spread = 0.5 * np.abs(xx + yy), np.sqrt(0.25 * (xx - yy) ** 2 + xy**2)
    larger = mean + spread
    ratio = np.divide(np.abs(mean - spread), larger, out=np.ones_like(larger), where=larger > 0)
    shape[inner, inner] = (1 - ratio) ** 2
    return shape


def _take_smaller_neighbours(lowest: Array, values: Array, axis: int) -> None:
    ahead, behind = ((_ALL,) * axis + (part,) for part in (_FROM, _TO))
    np.minimum(lowest[behind], values[ahead], out=lowest[behind])
    np.minimum(lowest[ahead], values[behind], out=lowest[ahead])
