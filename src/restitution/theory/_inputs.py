"""Checks of the arguments of the laws, and the convention for separated spheres."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError

Array: TypeAlias = NDArray[np.float64]
Values: TypeAlias = float | Array


def positive(**quantities: Values) -> tuple[Array, ...]:
    """Return the named quantities as float arrays; `CaseError` unless positive and finite."""
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


def keep_positive(law: object, *names: str) -> None:
    for name in names:
        keep(law, name, *positive(**{name: getattr(law, name)}))


def keep_between(law: object, name: str, low: Values, high: Values = np.inf) -> None:
    array = np.asarray(getattr(law, name), dtype=np.float64)
    bad = ~(np.isfinite(array) & (array >= low) & (array <= high))
    if bad.any():
        value, least, most = (np.broadcast_to(x, bad.shape)[bad][0] for x in (array, low, high))
        raise CaseError(
            f"{name}: {value:g} is not a finite number from {least:g} to {most:g}; "
            f"give {name} in SI units, within that range"
        )
    keep(law, name, array)


@dataclass(frozen=True, eq=False)
class PositiveFields:
    """Base class of a law whose fields must all be positive and finite."""

    def __post_init__(self) -> None:
        keep_positive(self, *(field.name for field in fields(self)))


def touching(value: Values) -> Array:
    """Return `value` with negative values set to zero, for separated spheres."""
    return scalar_or_array(np.maximum(np.asarray(value, dtype=np.float64), 0.0))


def scalar_or_array(values: Values) -> Array:
    """Return a NumPy scalar for a zero-dimensional array, and any other array unchanged."""
    result: Array = np.asarray(values, dtype=np.float64)[()]
    return result


def keep(law: object, name: str, value: Values) -> None:
    """Store a copy of `value` as a read-only field of a frozen `law`."""
    kept = np.array(value, dtype=np.float64)
    kept.flags.writeable = False
    object.__setattr__(law, name, kept)
