"""Read Digital Surf files (.sur): each surface is a header of 512 bytes and its heights.

SurfaceTopography 1.27.1 reads only the first surface of a file, does not read compressed heights,
and takes the bytes of a UTF-8 micro sign for two letters. This module splits the file, expands the
heights and rewrites the units.
"""

from __future__ import annotations

import struct
import zlib
from dataclasses import dataclass, replace
from pathlib import Path

from restitution.errors import SurfaceError
from restitution.surfaces.reading.instrument_files import read_instrument
from restitution.surfaces.reading.scan import LineScanError, Scan, in_metres

PLAIN, COMPRESSED = b"DIGITAL SURF", b"DSCOMPRESSED"

_HEADER = 512  # bytes
_UNITS = range(180, 276, 16)  # offsets of the units: steps of x, y and z, then axes x, y and z
_FORCE_CURVES = (14, 15)  # types of content
_PICTURES = (3, 10, 12)  # binary, intensity and colour images


@dataclass(frozen=True)
class _Part:
    content: bytes
    kind: int
    name: str
    unit: str
    points: int
    lines: int

    @property
    def heights(self) -> bool:
        length = in_metres(1.0, self.unit) is not None
        return length and self.lines > 1 and self.kind not in (*_PICTURES, *_FORCE_CURVES)


def read_sur(path: Path, channel: int | None) -> Scan:
    """Read the surface with the number `channel`; None selects the first that contains heights.

    Raises `SurfaceError` if it does not exist, is not a height map, or is damaged.
    """
    parts = _parts(path)
    if parts is None:
        return read_instrument(path, channel)
    heights = [number for number, part in enumerate(parts) if part.heights]
    number = next(iter(heights), 0) if channel is None else channel
    names = ", ".join(f"{n} ('{parts[n].name}')" for n in heights)
    if not 0 <= number < len(parts):
        raise SurfaceError(f"{path}: there is no channel {number}; choose from {names}")
    if not parts[number].heights:
        _refuse(path, number, parts, names)
    scan = read_instrument(path, None, parts[number].content, "sur")
    others = ", ".join(f"{n} ('{parts[n].name}')" for n in heights if n != number)
    if not others:
        return scan
    own: dict[str, str | float] = {
        "channel": number,
        "channel_name": parts[number].name,
        "other_height_channels": others,
    }
    return replace(scan, details={**scan.details, **own})


def _refuse(path: Path, number: int, parts: list[_Part], names: str) -> None:
    part = parts[number]
    if part.kind in _FORCE_CURVES:
        raise SurfaceError(f"{path}: holds force curves, not a height map; export a height map")
    if not names and part.lines == 1:
        raise LineScanError(path, part.points)
    said = ", ".join(
        f"{n} ('{p.name}', values in {p.unit or 'no stated unit'})" for n, p in enumerate(parts)
    )
    raise SurfaceError(
        f"{path}: "
        + (f"channel {number} is not a height map" if names else "contains no height map")
        + f" (channels: {said}); "
        + (f"choose from {names}" if names else "export a height map with its unit")
    )


def _parts(path: Path) -> list[_Part] | None:
    raw, at = path.read_bytes(), 0
    parts: list[_Part] = []
    while raw[at : at + 12] in (PLAIN, COMPRESSED) and len(raw) >= at + _HEADER:
        part, at = _part(path, raw, at, len(parts))
        parts.append(part)
    return parts or None


def _part(path: Path, raw: bytes, start: int, number: int) -> tuple[_Part, int]:
    """The surface whose header begins at `start`, and where the next one begins."""
    header = bytearray(raw[start : start + _HEADER])
    (kind,), (bits,) = struct.unpack_from("<H", header, 18), struct.unpack_from("<H", header, 98)
    nx, ny, count = struct.unpack_from("<3i", header, 108)
    for at in _UNITS:
        text = (
            bytes(header[at : at + 16]).replace(b"\xc2\xb5", b"\xb5").replace(b"\xce\xbc", b"\xb5")
        )
        header[at : at + 16] = text.ljust(16)
    begin = start + _HEADER + sum(struct.unpack_from("<2H", header, 334))
    length = max(count, 0) * bits // 8
    if header[:12] == COMPRESSED:
        header[:12] = PLAIN
        data, end = _expanded(path, raw, begin, length)
    else:
        data, end = raw[begin : begin + length], begin + length
    unit = bytes(header[_UNITS[2] : _UNITS[2] + 16]).decode("latin-1").strip("\0 ")
    title = bytes(header[20:50]).decode("latin-1").strip("\0 ") or f"surface {number + 1}"
    unit = "um" if unit == "\xe6m" else unit  # the micro sign of MS-DOS
    content = bytes(header) + raw[start + _HEADER : begin] + data
    return _Part(content, kind, title, unit, nx, ny), end


def _expanded(path: Path, raw: bytes, at: int, length: int) -> tuple[bytes, int]:
    """The heights of a compressed surface, `length` bytes, and where its data end."""
    try:
        (streams,) = struct.unpack_from("<I", raw, at)
        sizes = struct.unpack_from(f"<{2 * min(streams, 2**16)}I", raw, at + 4)
        at, data = at + 4 + 8 * streams, b""
        for packed in sizes[1::2]:
            data += zlib.decompressobj().decompress(raw[at : at + packed], length + 1)
            at += packed
    except (struct.error, zlib.error) as error:
        raise _incomplete(path) from error
    if len(data) != length:
        raise _incomplete(path)
    return data, at


def _incomplete(path: Path) -> SurfaceError:
    return SurfaceError(
        f"{path}: is a compressed Digital Surf file whose heights are damaged or incomplete; save "
        "it again, without compression"
    )
