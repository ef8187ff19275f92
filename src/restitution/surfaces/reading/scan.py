"""A scan as a file reader returns it, before it is checked and converted to a `Surface`."""

from __future__ import annotations

import codecs
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass

from restitution.errors import SurfaceError
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
UNITS = "m, mm, um, nm or pm"  # what a user may give as the unit of heights

# Largest number of pixels of a scan, which limits the memory needed for reading.
MOST_PIXELS = 2**26

# Provenance entry for files whose first scan line is at the top of the picture.
Y_DOWN = {"y_axis": "down"}

_UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


@dataclass(frozen=True)
class Scan:
    """Content of a topography file.

    Attributes:
        height: Heights (m), or numbers in an unknown unit if `unit` is None; shape (nx, ny); NaN
            where undefined.
        size: Lengths of the x and y edges (m); None where the file does not contain them.
        details: Entries of the provenance, such as `Y_DOWN`.
        unit: Unit in which the file contains the heights; None if unknown.
        stated: Whether the file itself, and not a convention, gives this unit.
        masked: Whether a mask in the file, and not the measurement, makes pixels undefined.
        notices: What the user should know about how the file was read.
    """

    height: Array
    size: tuple[float | None, float | None]
    details: Mapping[str, str | float]
    unit: str | None = "m"
    stated: bool = True
    masked: bool = False
    notices: tuple[str, ...] = ()


class LineScanError(SurfaceError):
    """A file that contains profiles only."""

    def __init__(self, path: object, points: int) -> None:
        super().__init__(
            f"{path}: is a line scan (a profile of {points} points), not a height map; measure an "
            'area, or describe the profile by roughness of kind = "gaussian" or "self-affine" with '
            "its rms"
        )


def in_metres(value: float, unit: object) -> float | None:
    """`value` in `unit`, converted to metres; None if `unit` is not a unit of length."""
    per_metre = _per_metre(unit)
    return None if per_metre is None else value / per_metre


def converted(heights: Array, old: str | None, new: str) -> Array:
    """Heights (m) of numbers that were taken to be in `old` but are in `new`."""
    per_old, per_new = _per_metre(old or "m"), _per_metre(new)
    if per_old is None or per_new is None:
        raise SurfaceError(f"height_unit: '{new}' is not a unit of length; give {UNITS}")
    return heights * per_old / per_new


def _per_metre(unit: object) -> float | None:
    if not isinstance(unit, str):
        return None
    # NFKC unifies the two code points that look like µ, and the two that look like Å.
    return _PER_METRE.get(unicodedata.normalize("NFKC", unit))


def decode(raw: bytes) -> str:
    """Decode UTF-8, UTF-16 with its mark, or else Latin-1."""
    if raw.startswith(_UTF16):
        return raw.decode("utf-16", errors="replace")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")
