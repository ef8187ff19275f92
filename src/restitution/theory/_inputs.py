"""What the closed forms accept: numbers or arrays, with one rule for what does not touch."""

from __future__ import annotations

from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError

Array: TypeAlias = NDArray[np.float64]
Values: TypeAlias = float | Array


def positive(**quantities: Values) -> tuple[Array, ...]:
    """Return the named quantities as float arrays; `CaseError` unless all are positive and finite.

    The keyword becomes the name in the message, so pass each under its public argument name.
    """
    arrays = []
    for name, value in quantities.items():
        array = np.asarray(value, dtype=np.float64)
        bad = ~(np.isfinite(array) & (array > 0))
        if bad.any():
            raise CaseError(
                f"{name}: {array[bad].flat[0]:g} is not a positive finite number; "
                f"give {name} in SI units, greater than zero"
            )
        arrays.append(array)
    return tuple(arrays)


def between(low: Values, high: Values, **quantities: Values) -> tuple[Array, ...]:
    """Return the named quantities as float arrays; `CaseError` unless finite and within bounds.

    The keyword becomes the name in the message, so pass each under its public argument name.
    """
    arrays = []
    for name, value in quantities.items():
        array = np.asarray(value, dtype=np.float64)
        bad = ~(np.isfinite(array) & (array >= low) & (array <= high))
        if bad.any():
            found, least, most = (np.broadcast_to(x, bad.shape)[bad][0] for x in (array, low, high))
            raise CaseError(
                f"{name}: {found:g} is not a finite number from {least:g} to {most:g}; "
                f"give {name} in SI units, within that range"
            )
        arrays.append(array)
    return tuple(arrays)


def touching(value: Values) -> Array:
    """Return a state variable (indentation, force, velocity) with negative values set to zero."""
    return scalar_or_array(np.maximum(np.asarray(value, dtype=np.float64), 0.0))


def scalar_or_array(values: Array) -> Array:
    """Return a NumPy scalar in place of an array without dimensions, any other array as it is."""
    result: Array = values[()]
    return result
