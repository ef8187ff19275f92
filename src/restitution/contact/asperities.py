"""Shape and height of the asperity that each node belongs to, from the gap before loading."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.read_only import freeze

Array = NDArray[np.float64]

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


def elongation_of(gap: Array, spacing: tuple[float, float]) -> Array:
    """Elongation of the asperity at each node, (1 − κ₂/κ₁)².

    κ₂ and κ₁ are the magnitudes of the two principal curvatures of the gap, from second
    differences; κ₁ is the larger one.

    Args:
        gap: Gap before loading (m), shape (nx, ny).
        spacing: Distances between neighbouring nodes along x and y (m).

    Returns:
        Elongation (dimensionless), shape of `gap`, read-only: 0 at a round asperity, 1 along a
        ridge. It is 0 at the outermost nodes of the grid, which a contact must not reach.
    """
    elongation, rows = np.empty(gap.shape), gap.shape[0]
    for first in range(0, rows, _STRIP):
        last, above = min(first + _STRIP, rows), max(first - 1, 0)
        strip = _elongation(gap[above : last + 1], spacing)
        elongation[first:last] = strip[first - above : last - above]
    return freeze(elongation)


def crest_gap_of(gap: Array) -> Array:
    """Gap at the crest that a path of steepest descent over the eight neighbours comes to.

    Args:
        gap: Gap before loading (m), shape (nx, ny).

    Returns:
        Gap at the crests (m), shape of `gap`, read-only.
    """
    nodes = np.arange(gap.size).reshape(gap.shape)
    lowest = gap.copy()
    _take_smaller_neighbours(lowest, gap, axis=0)
    _take_smaller_neighbours(lowest, lowest.copy(), axis=1)
    following = nodes.copy()
    for at, neighbour in _NEIGHBOURS:
        np.copyto(following[at], nodes[neighbour], where=gap[neighbour] == lowest[at])
    np.copyto(following, nodes, where=gap == lowest)
    path = following.ravel()
    while True:  # each pass doubles the length of the paths
        longer = np.take(path, path, mode="clip")
        if np.array_equal(longer, path):
            return freeze(gap.ravel()[path].reshape(gap.shape))
        path = longer


def _elongation(gap: Array, spacing: tuple[float, float]) -> Array:
    inner = slice(1, -1)
    hx, hy = spacing
    elongation = np.zeros(gap.shape)
    xx = (gap[2:, inner] - 2 * gap[inner, inner] + gap[:-2, inner]) / hx**2
    yy = (gap[inner, 2:] - 2 * gap[inner, inner] + gap[inner, :-2]) / hy**2
    xy = (gap[2:, 2:] - gap[2:, :-2] - gap[:-2, 2:] + gap[:-2, :-2]) / (4 * hx * hy)
    mean, spread = 0.5 * np.abs(xx + yy), np.sqrt(0.25 * (xx - yy) ** 2 + xy**2)
    larger = mean + spread
    ratio = np.divide(np.abs(mean - spread), larger, out=np.ones_like(larger), where=larger > 0)
    elongation[inner, inner] = (1 - ratio) ** 2
    return elongation


def _take_smaller_neighbours(lowest: Array, values: Array, axis: int) -> None:
    ahead, behind = ((_ALL,) * axis + (part,) for part in (_FROM, _TO))
    np.minimum(lowest[behind], values[ahead], out=lowest[behind])
    np.minimum(lowest[ahead], values[behind], out=lowest[ahead])
