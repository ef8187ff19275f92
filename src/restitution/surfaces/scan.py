"""A scan as a file reader returns it, before it is checked and converted to a `Surface`."""

from __future__ import annotations

import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass

from restitution.surfaces.surface import Array

# Number of units per metre. Values are divided by these numbers, because 10/1e6 is exactly 1e-05,
# but 10 times 1e-6 is not.
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

# Largest number of pixels of a scan, which limits the memory needed for reading.
MOST_PIXELS = 2**26

# Provenance entry for files whose first scan line is at the top of the picture.
Y_DOWN = {"y_axis": "down"}


@dataclass(frozen=True)
class Scan:
    """Content of a topography file: the heights, the size of the scan, and further details.

    `height` is in m, has shape (nx, ny) and is NaN where undefined. `size` contains the lengths of
    the x and y edges (m); a length that the file does not contain is None. `details` become part of
    the provenance; they include `Y_DOWN` if the first line of the file is at the top of the
    picture.
    """

    height: Array
    size: tuple[float | None, float | None]
    details: Mapping[str, str | float]


def in_metres(value: float, unit: object) -> float | None:
    """`value` in `unit`, converted to metres; None if `unit` is not a unit of length."""
    if not isinstance(unit, str):
        return None
    # NFKC unifies the two code points that look like µ, and the two that look like Å.
    per_metre = _PER_METRE.get(unicodedata.normalize("NFKC", unit))
    return None if per_metre is None else value / per_metre
