"""Read TrueMap files (.tmd), in which a comment of any length precedes the header.

SurfaceTopography 1.27.1 expects a comment of 24 bytes.
"""

from __future__ import annotations

from pathlib import Path

from restitution.surfaces.reading.instrument_files import read_instrument
from restitution.surfaces.reading.scan import Scan

TMD_MAGIC = b"Binary TrueMap Data File v2.0"

_PREAMBLE, _COMMENT = 32, 24  # bytes


def read_tmd(path: Path, channel: int | None) -> Scan:
    """Read the heights; see `read_instrument`."""
    raw = path.read_bytes()
    comment, _, rest = raw[_PREAMBLE:].partition(b"\0")
    padded = comment[: _COMMENT - 1].ljust(_COMMENT, b"\0")
    return read_instrument(path, channel, raw[:_PREAMBLE] + padded + rest, "tmd")
