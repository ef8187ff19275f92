"""Roots of increasing functions, for whole arrays at once; each element has its own bracket.

T. R. Chandrupatla, Advances in Engineering Software 28 (1997) 145–149.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ._inputs import Array, Values

# Largest number of iterations. Usually about 10 suffice. Bisection alone would need about 100 for
# a root of 1e-14 in [0, 1].
_MAX_STEPS = 200
_EXACT = 2 * np.finfo(float).eps  # relative width of a converged bracket


def increasing_root(excess: Callable[[Array], Array], low: Values, high: Values) -> Array:
    """Root of the increasing function `excess`; the nearest bound if it lies outside the bounds."""
    low, high = (np.asarray(end, float) for end in np.broadcast_arrays(low, high))
    below, above = excess(low), excess(high)
    root = np.where(below >= 0, low, np.where(above <= 0, high, low + high + below + above))
    inside = (below < 0) & (above > 0)
    if inside.any():
        # The formulas divide by zero in elements that have converged; those values are not used.
        with np.errstate(all="ignore"):
            bracketed = _chandrupatla(excess, low, high, below, above, inside)
        root = np.where(inside, bracketed, root)
    return root


def _chandrupatla(
    excess: Callable[[Array], Array],
    low: Array,
    high: Array,
    below: Array,
    above: Array,
    inside: NDArray[np.bool_],
) -> Array:
    """Roots of `excess` where the mask `inside` is true; other elements are undefined.

    Point 1 is the newest point and one end of the bracket, point 2 the other end, and point 3 the
    end that point 1 has replaced.
    """
    x1, f1, x2, f2 = high, above, low, below
    root, share = np.full_like(x1, np.nan), np.full_like(x1, 0.5)
    waiting = inside
    for _ in range(_MAX_STEPS):
        x = x1 + share * (x2 - x1)
        f = excess(x)
        same = (f > 0) == (f1 > 0)
        x3, f3 = np.where(same, x1, x2), np.where(same, f1, f2)
        x2, f2 = np.where(same, x2, x1), np.where(same, f2, f1)
        x1, f1 = x, f
        best = np.where(np.abs(f1) < np.abs(f2), x1, x2)
        width, least = np.abs(x2 - x1), _EXACT * np.abs(best)
        done = (f1 == 0) | (width <= least) | np.isnan(f1)
        root = np.where(waiting & done, np.where(np.isnan(f1), np.nan, best), root)
        waiting = waiting & ~done
        if not waiting.any():
            break
        share = np.clip(
            _interpolated(x1, f1, x2, f2, x3, f3), 0.5 * least / width, 1 - 0.5 * least / width
        )
        share = np.where(waiting, share, 0.5)
    return np.where(waiting, best, root)


def _interpolated(x1: Array, f1: Array, x2: Array, f2: Array, x3: Array, f3: Array) -> Array:
    """Next trial, a fraction of the way from point 1 to 2: inverse quadratic or, if unsafe, ½."""
    xi, phi = (x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2)
    safe = (phi**2 < xi) & ((1 - phi) ** 2 < 1 - xi)
    quadratic = f1 / (f2 - f1) * f3 / (f2 - f3) + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (
        f3 - f2
    )
    return np.where(safe, quadratic, 0.5)
