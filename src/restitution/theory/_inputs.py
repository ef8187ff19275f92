"""What the laws accept: numbers or arrays, checked by name, with one rule for no contact."""

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


def keep_positive(law: object, *names: str) -> None:
    """Check the named fields of a frozen `law` by `positive` and keep them as read-only arrays."""
    for name in names:
        keep(law, name, *positive(**{name: getattr(law, name)}))


def keep_between(law: object, name: str, low: Values, high: Values = np.inf) -> None:
    """Check a field of a frozen `law` by `between` and keep it as a read-only array."""
    keep(law, name, *between(low, high, **{name: getattr(law, name)}))


def touching(value: Values) -> Array:
    """Return a state variable (indentation, force, velocity) with negative values set to zero."""
    return scalar_or_array(np.maximum(np.asarray(value, dtype=np.float64), 0.0))


def scalar_or_array(values: Values) -> Array:
    """Return a NumPy scalar in place of an array without dimensions, any other array as it is."""
    result: Array = np.asarray(values, dtype=np.float64)[()]
    return result


def keep(law: object, name: str, value: Values) -> None:
    """Keep a field of a frozen `law` as a read-only array of its own."""
    kept = np.array(value, dtype=np.float64)
    kept.flags.writeable = False
    object.__setattr__(law, name, kept)
