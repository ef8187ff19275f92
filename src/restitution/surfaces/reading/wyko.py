"""Read text files of Wyko interferometers (.asc).

Heights are in waves, `value * Wavelength / Mult`, or in nm if the second flag of the first line is
1. Each line of a block is one x; y runs upwards along it, as in the binary files (.opd).
SurfaceTopography 1.27.1 exchanges x and y, reads `Mult` only if its type is 7, and joins the lines
of several blocks.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from restitution.errors import SurfaceError
from restitution.surfaces.reading.scan import Y_DOWN, Scan, decode
from restitution.surfaces.surface import Array

WYKO_MAGIC = b"Wyko ASCII Data File Format"

_HEIGHTS = frozenset({"RAW_DATA", "RAW DATA", "OPD", "RAW", "SAMPLE_DATA"})
_ARRAY = "3"  # type of a block that is an array
_UNDEFINED = frozenset({"bad", "nan"})


def read_wyko(path: Path) -> Scan:
    """Read the first block of heights; raises `SurfaceError` if there is none that is complete."""
    lines = iter(decode(path.read_bytes()).splitlines())
    in_nm = re.split(r"\s+", next(lines).strip())[-2] == "1"
    header, name = _header(lines)
    try:
        nx, ny = int(header["X Size"]), int(header["Y Size"])
        waves = 1.0 if in_nm else header["Wavelength"] / header.get("Mult", 1.0)
    except KeyError as error:
        raise SurfaceError(f"{path}: is a Wyko file without {error}; export it again") from None
    values = _block(path, name, lines, (nx, ny))
    pixel = header.get("Pixel_size")
    size: tuple[float | None, float | None] = (None, None)
    if pixel is not None:
        size = (nx * pixel / 1e3, ny * pixel * header.get("Aspect", 1.0) / 1e3)
    return Scan(
        np.ascontiguousarray(values[:, ::-1]) * (1e-9 * waves),
        size,
        {"format": "Wyko ASCII", **Y_DOWN, "channel_name": name, "file_unit": "nm"},
        unit="nm",
    )


def _header(lines: Iterator[str]) -> tuple[dict[str, float], str]:
    header: dict[str, float] = {}
    for line in lines:
        key, *fields = (field.strip() for field in line.split("\t"))
        if key.upper() in _HEIGHTS and fields[:1] == [_ARRAY]:
            return header, key
        with suppress(ValueError, IndexError):
            header[key] = float(fields[-1])
    return header, ""


def _block(path: Path, name: str, lines: Iterator[str], shape: tuple[int, int]) -> Array:
    rows = [line.split() for _, line in zip(range(shape[0]), lines, strict=False)]
    if len(rows) != shape[0] or any(len(row) != shape[1] for row in rows):
        raise SurfaceError(
            f"{path}: its block {name or 'of heights'} is not complete: {shape[0]} lines of "
            f"{shape[1]} values are stated; export it again"
        )
    try:
        return np.array(
            [[np.nan if v.lower() in _UNDEFINED else float(v) for v in row] for row in rows]
        )
    except ValueError as error:
        raise SurfaceError(f"{path}: its block {name} is damaged ({error}); export it again") from (
            None
        )
