"""Read NanoFocus files (.nms): a header of 3468 bytes, then 16-bit heights.

SurfaceTopography 1.27.1 takes the pixel sizes for millimetres; they are in nanometres.
"""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np

from restitution.errors import SurfaceError
from restitution.surfaces.reading.scan import Y_DOWN, Scan

NMS_SUFFIX = ".nms"

_HEADER = 3468  # bytes
_RANGE, _POINTS = 16, 1368  # offsets of the range of heights (µm), and of the numbers of pixels
_TOP = 2**16 - 2  # the integer of the largest height; the next one marks an undefined pixel


def read_nms(path: Path) -> Scan:
    """Read the heights. Raises `SurfaceError` if the file is not such a file, or is incomplete."""
    raw = path.read_bytes()
    if len(raw) < _HEADER:
        raise _damaged(path, f"has {len(raw)} bytes, fewer than the header of a NanoFocus file")
    low, high = struct.unpack_from("<2d", raw, _RANGE)
    nx, ny, hx, hy = struct.unpack_from("<2I2d", raw, _POINTS)
    if not (0 < nx < 2**16 and 0 < ny < 2**16 and hx > 0 and hy > 0):
        raise _damaged(path, "has no header of a NanoFocus file")
    if len(raw) < _HEADER + 2 * nx * ny:
        raise _damaged(path, f"ends before the last of its {nx} x {ny} heights")
    number = np.frombuffer(raw, "<u2", nx * ny, _HEADER).reshape(ny, nx).T
    height = np.where(number > _TOP, np.nan, 1e-6 * (low + number * ((high - low) / _TOP)))
    return Scan(
        height,
        (nx * hx / 1e9, ny * hy / 1e9),
        {"format": "NanoFocus NMS", **Y_DOWN, "file_unit": "um"},
        unit="um",
    )


def _damaged(path: Path, why: str) -> SurfaceError:
    return SurfaceError(f"{path}: {why}; export it again, or as a text matrix of heights")
