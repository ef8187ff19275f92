"""Read surface data files (.sdf): ISO 25178-71 (versions 1.0 and 2.0) and the older BCR form.

The lowest number of a data type marks an undefined point; in the BCR form, whose types may be
unsigned, the highest. SurfaceTopography 1.27.1 takes the marks of `float`, `double` and 8-bit types
for heights, and does not know the BCR form and version 2.0.
"""

from __future__ import annotations

import re
import struct
from pathlib import Path

import numpy as np

from restitution.errors import SurfaceError, shown
from restitution.surfaces.reading.scan import MOST_PIXELS, Y_DOWN, Scan
from restitution.surfaces.surface import Array

SDF_MAGIC = re.compile(rb"[ab](ISO-[12]\.0|BCR-1\.0)")

_TYPES = ("u1", "<u2", "<u4", "<f4", "i1", "<i2", "<i4", "<f8")  # by the number DataType
_NAMES = "NumPoints NumProfiles Xscale Yscale Zscale Zresolution Compression DataType CheckType"
_KEYS = {name.lower(): name for name in _NAMES.split()}


def read_sdf(path: Path) -> Scan:
    """Read the heights. Raises `SurfaceError` if the file is incomplete or compressed."""
    raw = path.read_bytes()
    dialect = raw[:8].decode("ascii")
    try:
        header, body = _header(raw)
        nx, ny, kind = int(header["NumPoints"]), int(header["NumProfiles"]), int(header["DataType"])
        if not (0 < nx * ny <= MOST_PIXELS and 0 <= kind < len(_TYPES)):
            raise ValueError(f"{nx} x {ny} points of type {kind}")
        if header.get("Compression", 0):
            raise SurfaceError(f"{path}: is a compressed {dialect} file; save it uncompressed")
        values = _text_values(body) if dialect[0] == "a" else _values(body, nx * ny, kind, dialect)
        height = values.reshape(ny, nx).T * header["Zscale"]
        size = nx * header["Xscale"], ny * header["Yscale"]
    except SurfaceError:
        raise
    except (KeyError, ValueError, struct.error) as error:
        raise SurfaceError(
            f"{path}: is a damaged or incomplete {dialect} file ({shown(str(error), 60)}); export "
            "it again"
        ) from error
    return Scan(
        np.ascontiguousarray(height), size, {"format": f"SDF {dialect}", **Y_DOWN, "file_unit": "m"}
    )


def _header(raw: bytes) -> tuple[dict[str, float], bytes]:
    if raw[:1] == b"a":
        head, star, body = raw[8:].partition(b"*")
        if not star:
            raise ValueError("the header has no end")
        entries = (line.partition("=") for line in head.decode("latin-1").splitlines())
        return {
            _KEYS[key.strip().lower()]: float(value)
            for key, _, value in entries
            if key.strip().lower() in _KEYS
        }, body
    form = "<10x24x" + ("2I" if raw[1:8] == b"ISO-2.0" else "2H") + "4d3B"
    end = 8 + struct.calcsize(form)
    return dict(zip(_KEYS.values(), struct.unpack(form, raw[8:end]), strict=True)), raw[end:]


def _text_values(body: bytes) -> Array:
    text = body.partition(b"*")[0].decode("latin-1")
    return np.array([np.nan if v.upper() == "BAD" else float(v) for v in text.split()])


def _values(body: bytes, count: int, kind: int, dialect: str) -> Array:
    data = np.frombuffer(body, _TYPES[kind], count)
    limits = np.finfo(data.dtype) if data.dtype.kind == "f" else np.iinfo(data.dtype)
    undefined = np.zeros(count, bool)
    if data.dtype.kind == "u" or "BCR" in dialect:
        undefined |= data == limits.max
    if data.dtype.kind != "u":
        undefined |= data == limits.min
    return np.where(undefined, np.nan, data.astype(np.float64))
