"""Read-only arrays for frozen objects."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def freeze(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Make `values` itself read-only and return it. The caller must be its only owner."""
    values.flags.writeable = False
    return values


def read_only(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Return `values` as an array that cannot be written to.

    If `values` and all arrays of which it is a view are already read-only, `values` itself is
    returned. Otherwise the result is a copy, and `values` stays writeable for its owner.
    """
    owner: object = values
    while isinstance(owner, np.ndarray) and not owner.flags.writeable:
        owner = owner.base
    return values if owner is None else freeze(values.copy())
