"""Arrays that nobody can write to: what frozen objects hold."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Scalar = TypeVar("Scalar", bound=np.generic)


def freeze(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """Make `values` itself read-only and return it. For arrays that the caller has just made."""
    values.flags.writeable = False
    return values


def read_only(values: NDArray[Scalar]) -> NDArray[Scalar]:
    """`values` as an array that nobody can write to.

    It is `values` itself where that, and the array that it is a view of, is read-only already. Else
    it is a copy, so that `values` stays writeable for its owner and changes nothing here.
    """
    owner: object = values
    while isinstance(owner, np.ndarray):
        if owner.flags.writeable:
            return freeze(values.copy())
        owner = owner.base
    return values if owner is None else freeze(values.copy())
