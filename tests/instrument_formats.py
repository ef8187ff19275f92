"""Scans in formats of instruments that no available package writes.

Each function follows the public description of its format and writes only the entries that readers
need. Files store whole lines of pixels. SUR and TMD begin with the line at y = 0, the others end
with it.
"""

import struct

import numpy as np

HALF_RANGE = 32_000  # the 16-bit integer that stands for the largest height
UNDEFINED = -HALF_RANGE - 2  # SUR: two below the lowest height


def write_sur(path, height, size):
    """Digital Surf: a binary header of 512 bytes, then integers."""
    step = np.nanmax(np.abs(height)) / HALF_RANGE
    lines = np.where(np.isnan(height), UNDEFINED, np.rint(height / step)).T
    ny, nx = lines.shape
    special = int(np.isnan(height).any())
    texts = ["X", "Y", "Z", "um", "um", "um", "um", "um", "um"]
    header = b"".join(
        [
            struct.pack("<12s4H", b"DIGITAL SURF", 0, 1, 1, 2),  # one object, a surface
            struct.pack("<30s30s5H8x", b"scan", b"", 0, 0, 0, special, 1),
            struct.pack("<H5i", 16, -HALF_RANGE, HALF_RANGE, nx, ny, nx * ny),
            struct.pack(
                "<3f", *(1e6 * edge / n for edge, n in zip(size, (nx, ny), strict=True)), 1e6 * step
            ),
            *(struct.pack("16s", text.encode("latin-1")) for text in texts),
            struct.pack("<3f", 1, 1, 1),
            struct.pack("<3H12x", 0, 0, 0),
            struct.pack("<7Hf10x", 0, 30, 12, 24, 11, 2026, 2, 1.0),  # the time of the scan
            struct.pack("<2H128s3f34x", 0, 0, b"", 0, 0, 0),
        ]
    )
    assert len(header) == 512
    path.write_bytes(header + lines.astype("<i2").tobytes())


def write_tmd(path, height, size):
    """TrueMap: two texts of fixed length, a binary header, then floats in mm."""
    nx, ny = height.shape
    header = struct.pack("<2I4f", nx, ny, *(1e3 * edge for edge in size), 0, 0)
    texts = (b"Binary TrueMap Data File v2.0\r\n\0", b"Created by TrueMap v6\r\n\0")
    path.write_bytes(b"".join(texts) + header + (1e3 * height.T).astype("<f4").tobytes())


def write_nid(path, height, size):
    """Nanosurf: the text of an INI file, then after `#!` integers that fill a stated range."""
    peak = float(np.abs(height).max()) * 2**15 / HALF_RANGE
    nx, ny = height.shape
    text = f"""[DataSet]
Version=2
GroupCount=1
Gr0-Name=Scan forward
Gr0-Count=1
Gr0-Ch0=DataSet-0:1
[DataSet-Info]
Date=24-11-2026
Time=12:30:00
[DataSet-0:1]
Points={nx}
Lines={ny}
Frame=Scan forward
Dim0Unit=m
Dim0Range={size[0]!r}
Dim1Unit=m
Dim1Range={size[1]!r}
Dim2Name=Z-Axis
Dim2Unit=m
Dim2Min={-peak!r}
Dim2Range={2 * peak!r}
SaveMode=Binary
SaveBits=16
SaveSign=Signed
SaveOrder=Intel


"""
    path.write_bytes(text.replace("\n", "\r\n").encode("latin-1") + b"#!" + _integers(height))


def write_mi(path, height, size):
    """Molecular Imaging: keys of 14 characters, then the integers of each channel.

    A channel of deflections in V follows the heights.
    """
    nx, ny = height.shape
    peak = float(np.abs(height).max()) * 2**15 / HALF_RANGE
    entries = [
        ("fileType", "Image"),
        ("xPixels", nx),
        ("yPixels", ny),
        ("xLength", repr(size[0])),
        ("yLength", repr(size[1])),
        ("bufferLabel", "Topography"),
        ("bufferUnit", "m"),
        ("bufferRange", repr(peak)),
        ("bufferLabel", "Deflection"),
        ("bufferUnit", "V"),
        ("bufferRange", 10.0),
        ("data", "BINARY"),
    ]
    header = "".join(f"{key:<14}{value}\n" for key, value in entries)
    path.write_bytes(header.encode() + 2 * _integers(height))


def write_di(path, height, size):
    r"""Nanoscope: sections of lines that begin with \, then the integers of each channel.

    A channel of amplitudes in V and one of heights twice as large follow the heights.
    """
    nx, ny = height.shape
    data = _integers(height)
    volts = 2**16 / HALF_RANGE  # at the whole range of the integers
    nanometres = 1e9 * float(np.abs(height).max())
    channels = [("ZSensor", "Sens. Zsens"), ("Amplitude", "Sens. Amp"), ("Height", "Sens. Zscan")]
    lines = [
        r"\*File list",
        r"\Version: 0x05120000",
        r"\Date: 12:30:00 PM Tue Nov 24 2026",
        r"\*Scanner list",
        rf"\@Sens. Zsens: V {nanometres!r} nm/V",
        rf"\@Sens. Zscan: V {2 * nanometres!r} nm/V",
        r"\*Ciao scan list",
        rf"\Samps/line: {nx}",
        rf"\Lines: {ny}",
    ]
    for number, (name, sensitivity) in enumerate(channels):
        lines += [
            r"\*Ciao image list",
            rf"\Data offset: {4096 + number * len(data)}",
            rf"\Data length: {len(data)}",
            r"\Bytes/pixel: 2",
            rf"\Samps/line: {nx}",
            rf"\Number of lines: {ny}",
            rf"\Scan size: {1e6 * size[0]!r} {1e6 * size[1]!r} ~m",
            rf'\@2:Image Data: S [{name}] "{name}"',
            rf"\@2:Z scale: V [{sensitivity}] ({volts / 2**16!r} V/LSB) {volts!r} V",
        ]
    header = "\r\n".join([*lines, r"\*File list end", "\x1a"]).encode("latin-1")
    path.write_bytes(header.ljust(4096, b"\0") + len(channels) * data)


def _integers(height):
    lines = np.rint(height.T[::-1] * (HALF_RANGE / np.abs(height).max()))
    return lines.astype("<i2").tobytes()
