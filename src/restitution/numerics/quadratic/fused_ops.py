"""Steps of the minimiser. A compiled loop fuses the array operations of each step into one pass.

The symbols are those of `minimise`: p is the point, g the gradient at p, r the projected gradient,
z the preconditioned gradient, d the step, and Kd the product of K and d. p, g, b and the bounds
(numbers or arrays) have one precision, double or single, and the others one that is not higher.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.expressions import dot, max_magnitude
from restitution.numerics.kernels import loop_takes, use_loop

Array = NDArray[Any]
Bound = NDArray[np.float64] | float
Bounds = tuple[Bound, Bound]  # lower, upper


def as_rows(lower: Bound, upper: Bound, p: Array) -> Bounds:
    """Expand scalar bounds to a row broadcast to the shape of `p`, as compiled loops need them."""

    def rows(bound: Bound) -> Bound:
        if isinstance(bound, np.ndarray) or not loop_takes(p):
            return bound
        return _rows(float(bound), p.shape, p.dtype)

    return rows(lower), rows(upper)


@lru_cache(maxsize=64)
def _rows(value: float, shape: tuple[int, int], dtype: np.dtype[Any]) -> Array:
    return np.broadcast_to(np.full(shape[1], value, dtype), shape)


@use_loop
def projected_gradient(p: Array, g: Array, b: Array, bounds: Bounds, out: Array) -> float:
    """Replace K p in `g` by the gradient K p − b; write its projection to `out`.

    The projected gradient is zero at nodes that a descent step would move out of bounds, and the
    gradient at all others (free nodes). Return its largest magnitude, which is the violation of the
    optimality conditions.
    """
    g -= b
    free = g * _free(p, g, bounds)
    out[...] = free
    return max_magnitude(free)


@use_loop
def dot_products(z: Array, r: Array, r_old: Array) -> tuple[float, float]:
    """Return r·z and r_old·z."""
    return dot(r, z), dot(r_old, z)


@use_loop
def squares(r: Array) -> tuple[float, float]:
    """Return r·r and the number of values that are not zero."""
    return dot(r, r), float(np.count_nonzero(r))


@use_loop
def curvature(d: Array, Kd: Array) -> tuple[float, float]:
    """Return d·Kd and the largest magnitude of Kd."""
    return dot(d, Kd), max_magnitude(Kd)


@use_loop
def projected_direction(
    d: Array,
    beta: float,
    z: Array,
    length: float,
    p: Array,
    g: Array,
    r: Array,
    bounds: Bounds,
) -> tuple[float, bool]:
    """Overwrite the step d with `beta` d − `length` z on free nodes, cut to keep p + d in bounds.

    Return r·d and whether a bound truncated the step at any node.
    """
    np.multiply(d, beta, out=d, dtype=np.float64)
    np.subtract(d, np.multiply(z, length, dtype=np.float64), out=d)
    d *= _free(p, g, bounds)
    end = p + d
    cut = _is_outside(end, bounds)
    np.clip(end, *bounds, out=end)
    np.subtract(end, p, out=d)
    return dot(r, d), cut


@use_loop
def violates_bounds(p: Array, d: Array, step: float, bounds: Bounds) -> bool:
    """Whether p + `step` d is outside the bounds at any node."""
    return _is_outside(p + np.multiply(d, step, dtype=np.float64), bounds)


@use_loop
def take_step(
    p: Array, g: Array, d: Array, Kd: Array, step: float, bounds: Bounds, out: Array
) -> float:
    """Add `step` d to p and `step` Kd to g; write the projected gradient, return its magnitude.

    Where a bound has truncated d, a `step` of 1 sets p to exactly this bound, in spite of rounding.
    """
    lower, upper = bounds
    low, high = ((step == 1) & (d == (bound - p).astype(d.dtype, copy=False)) for bound in bounds)
    p += np.multiply(d, step, dtype=np.float64)
    np.clip(p, np.where(high, upper, lower), np.where(low, lower, upper), out=p)
    g += np.multiply(Kd, step, dtype=np.float64)
    np.multiply(g, _free(p, g, bounds), out=out)
    return max_magnitude(out)


def _free(p: Array, g: Array, bounds: Bounds) -> NDArray[np.bool_]:
    """Mask of free nodes: p is between the bounds, or on a bound with −g pointing inwards."""
    lower, upper = bounds
    free = p > lower
    free |= g < 0
    if _is_unbounded(upper):
        return free
    below = p < upper
    below |= g > 0
    free &= below
    return free


def _is_outside(p: Array, bounds: Bounds) -> bool:
    lower, upper = bounds
    outside = p < lower
    if not _is_unbounded(upper):
        outside |= p > upper
    return bool(outside.any())


def _is_unbounded(upper: Bound) -> bool:
    return isinstance(upper, float) and upper == np.inf
