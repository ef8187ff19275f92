"""Numbers that belong to the items of a batch.

Arrays of a batch are of shape (*batch, nx, ny), and what is found for each item is of shape
(*batch, 1, 1), so that it goes with the arrays. One item alone is of shape (nx, ny), and what is
found for it a number: on small grids arithmetic with arrays of one number costs as much as that
with the grids.
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
# One for each item: an array, or NumPy's number, which has the methods of one.
Number = Array
Flag = Mask


def highest(values: Array) -> Number:
    """The largest value in each item."""
    most = values.max() if values.ndim == 2 else values.max(axis=(-2, -1), keepdims=True)
    return cast("Number", most)


def lowest(values: Array) -> Number:
    """The smallest value in each item."""
    least = values.min() if values.ndim == 2 else values.min(axis=(-2, -1), keepdims=True)
    return cast("Number", least)


def largest(values: Array) -> Number:
    """The largest magnitude in each item."""
    return np.maximum(highest(values), -lowest(values))


def total(values: Array) -> Number:
    """Σ values over each item."""
    axes = None if values.ndim == 2 else (-2, -1)
    return cast("Number", values.sum(axis=axes, dtype=np.float64, keepdims=axes is not None))


def count(mask: Mask) -> Number:
    """At how many nodes each item is true."""
    if mask.ndim == 2:  # much faster than a sum
        return cast("Number", np.float64(int(np.count_nonzero(mask))))
    return cast("Number", mask.sum(axis=(-2, -1), dtype=np.float64, keepdims=True))


def dot(a: Array, b: Array) -> Number:
    """Σ a b over each item."""
    # Not np.vdot: its threads wait for each other longer than these products take.
    product = np.einsum("...ij,...ij->...", a, b, dtype=np.float64)
    return cast("Number", product if a.ndim == 2 else product[..., None, None])


def anywhere(mask: Mask) -> Flag:
    """Whether each item is true at some node."""
    found = mask.any() if mask.ndim == 2 else mask.any(axis=(-2, -1), keepdims=True)
    return cast("Flag", found)


def ratio(a: Number, b: Number) -> Number:
    """a/b, and zero where b is not positive."""
    if b.ndim == 0:
        return a / b if b > 0 else 0 * a
    return np.where(b > 0, a / np.where(b > 0, b, 1.0), 0.0)


def choose(condition: Flag, a: Number | float, b: Number | float) -> Number:
    """`a` for the items where the condition holds, `b` for the others."""
    if condition.ndim == 0:
        chosen = a if condition else b
        return cast("Number", np.float64(chosen)) if isinstance(chosen, float) else chosen
    return np.where(condition, a, b)


def some(flags: Flag) -> bool:
    """Whether any item is true."""
    return bool(flags if flags.ndim == 0 else flags.any())


def every(flags: Flag) -> bool:
    """Whether all items are true."""
    return bool(flags if flags.ndim == 0 else flags.all())


def somewhere(mask: Mask) -> Mask:
    """The nodes that are true in any item, of shape (nx, ny)."""
    nodes = mask if mask.ndim == 2 else mask.any(axis=0)
    return cast("Mask", nodes)
