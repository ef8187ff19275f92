"""Numbers that belong to the items of a batch.

Arrays of a batch are of shape (*batch, nx, ny), one item alone of shape (nx, ny); what is found for
each item is of shape (*batch, 1, 1), so that it goes with the arrays.
"""

from __future__ import annotations

from typing import cast

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def largest(values: Array) -> Array:
    """The largest magnitude in each item."""
    most: Array = values.max(axis=(-2, -1), keepdims=True)
    least: Array = values.min(axis=(-2, -1), keepdims=True)
    return np.maximum(most, -least)


def dot(a: Array, b: Array) -> Array:
    """Σ a b over each item."""
    # Not np.vdot: its threads wait for each other longer than these products take.
    product: Array = np.einsum("...ij,...ij->...", a, b)
    return product[..., None, None]


def ratio(a: Array, b: Array) -> Array:
    """a/b, and zero where b is not positive."""
    return np.where(b > 0, a / np.where(b > 0, b, 1.0), 0.0)


def somewhere(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """The nodes that are true in any item, of shape (nx, ny)."""
    nodes = mask if mask.ndim == 2 else mask.any(axis=0)
    return cast("NDArray[np.bool_]", nodes)
