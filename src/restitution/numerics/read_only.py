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
    """`values`, or a copy if it or an array of which it is a view can be written to."""
    owner: object = values
    while isinstance(owner, np.ndarray) and not owner.flags.writeable:
        owner = owner.base
    return values if owner is None else freeze(values.copy())
