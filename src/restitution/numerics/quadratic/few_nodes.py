"""The step of the minimiser where few nodes are free.

Of a contact that yields, nearly all nodes are at a bound after a few iterations. A dense matrix of
the others is small, so the minimum over these nodes, within their bounds, is found directly.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop
from restitution.numerics.quadratic.fused_ops import Bound, Bounds, squares

Array = NDArray[Any]
# Function that returns the kernel of K, transposed, at all lags along x and y below two numbers.
Lags = Callable[[int, int], Array]

# A matrix of n² elements is small if the grid has at least as many nodes, or up to this n².
_SMALL = 64**2
# The sweeps over the nodes end when no product of a change and the diagonal of K exceeds this
# fraction of the largest gradient, or after this number.
_UNTIL = 1e-5, 100


def few_free(r: Array) -> NDArray[np.int64] | None:
    """Nodes with a projected gradient `r`, shape (2, n); None if the matrix would be large."""
    if squares(r)[1] ** 2 > max(r.size, _SMALL):
        return None
    return np.array(np.nonzero(r))


def minimum_on(
    nodes: NDArray[np.int64], lags: Lags, p: Array, g: Array, bounds: Bounds, d: Array
) -> float:
    """Write the step from `p` to the minimum over `nodes` to `d`, zero elsewhere; return g·d."""
    extents = np.ptp(nodes, axis=1) + 1
    return step_on_few(d, nodes, lags(int(extents[0]), int(extents[1])), p, g, bounds, _UNTIL)


@use_loop
def step_on_few(
    d: Array,
    nodes: NDArray[np.int64],
    kernel: Array,
    p: Array,
    g: Array,
    bounds: Bounds,
    until: tuple[float, int],
) -> float:
    """Projected Gauss–Seidel sweeps over `nodes`, with the accuracy and the most sweeps `until`.

    Each sweep, and so the step, lowers ½ pᵀK p − pᵀb (Cryer 1971, SIAM J. Control 9, 385–392).
    """
    i, j = nodes

    def at_nodes(bound: Bound) -> Array:
        distance: Array = np.broadcast_to(bound, p.shape)[i, j] - p[i, j]
        return distance

    K = kernel[np.abs(j[:, None] - j), np.abs(i[:, None] - i)]
    least, most = map(at_nodes, bounds)
    slope, step = g[i, j].astype(np.float64), np.zeros(i.size)
    end = until[0] * np.abs(slope).max(initial=0.0)
    for _ in range(until[1]):
        largest = 0.0
        for k in range(i.size):
            wanted = min(max(step[k] - slope[k] / K[k, k], least[k]), most[k])
            change, step[k] = wanted - step[k], wanted
            slope += change * K[k]
            largest = max(largest, abs(change) * K[k, k])
        if largest <= end:
            break
    d[...] = 0
    d[i, j] = step
    return float(np.sum(d[i, j].astype(np.float64) * g[i, j]))
