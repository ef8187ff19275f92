"""Roots of increasing functions, for whole arrays at once."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ._inputs import Array, Values

_HALVINGS = 100  # from a bracket [0, 1], every root above 1e-14 to the last digit


def increasing_root(excess: Callable[[Array], Array], low: Values, high: Values) -> Array:
    """Where `excess`, which increases, passes zero between `low` and `high`; NaN stays NaN."""
    low, high = np.broadcast_arrays(np.asarray(low, float), np.asarray(high, float))
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        above = excess(middle) > 0
        low, high = np.where(above, low, middle), np.where(above, middle, high)
    root: Array = (low + high) / 2
    return root
