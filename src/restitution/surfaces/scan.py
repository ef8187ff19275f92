"""What a reader of height maps hands over, before it is checked and made a `Surface`."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

# How many of each unit make a metre: division by 1e6 gives 10 um as 1e-05, to the last bit.
_PER_METRE = {
    "km": 1e-3,
    "m": 1.0,
    "cm": 1e2,
    "mm": 1e3,
    "um": 1e6,
    "μm": 1e6,
    "nm": 1e9,
    "Å": 1e10,
    "A": 1e10,
    "pm": 1e12,
    "fm": 1e15,
}


# Of a scan: more would take gigabytes before anything is known of it.
MOST_PIXELS = 2**26

# For files of scan lines: y counts them, and they are drawn downwards, as instruments do.
Y_DOWN = {"y_axis": "down"}


@dataclass(frozen=True)
class Scan:
    """Heights in m, shape (nx, ny), NaN where undefined, and what the file says about them.

    `size` is the length of the x and the y edge in m, None where the file does not give it.
    `details` become part of the provenance, `Y_DOWN` among them where the file is an image whose
    first line is at the top.
    """

    height: NDArray[np.float64]
    size: tuple[float | None, float | None] = (None, None)
    details: Mapping[str, str | float] = field(default_factory=dict)


def in_metres(value: float, unit: object) -> float | None:
    """`value` of `unit` in metres, None when `unit` is not a unit of length."""
    if not isinstance(unit, str):
        return None
    # NFKC makes one letter of the two code points that look like µ, and of the two like Å.
    per_metre = _PER_METRE.get(unicodedata.normalize("NFKC", unit))
    return None if per_metre is None else value / per_metre
