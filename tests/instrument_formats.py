"""Scans in formats of instruments that no available package writes.

Each function follows the public description of its format and writes only the entries that readers
need. Files store whole lines of pixels. SUR and TMD begin with the line at y = 0, the others end
with it.
"""

import hashlib
import struct
import zipfile
import zlib

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


def sur_dialect(raw, name="scan", *, compressed=False, unit=b"um", kind=2):
    """Change a file of `write_sur`: its title, its unit of heights, its kind; compress it."""
    header, data = bytearray(raw[:512]), raw[512:]
    header[20:50] = name.encode().ljust(30)
    header[18:20] = struct.pack("<H", kind)
    for at in (212, 260):
        header[at : at + 16] = unit.ljust(16)
    if compressed:
        packed = zlib.compress(data)
        header[:12] = b"DSCOMPRESSED"
        header[324:328] = struct.pack("<I", 12 + len(packed))
        data = struct.pack("<3I", 1, len(data), len(packed)) + packed
    return bytes(header) + data


def write_nms(path, height, size):
    """NanoFocus: a header of 3468 bytes with heights in um and pixels in nm, then integers."""
    (nx, ny), low, high = height.shape, 1e6 * height.min(), 1e6 * height.max()
    header = bytearray(3468)
    struct.pack_into("<2d", header, 16, low, high)
    spacing = (1e9 * edge / n for edge, n in zip(size, (nx, ny), strict=True))
    struct.pack_into("<2I2d", header, 1368, nx, ny, *spacing)
    number = np.rint((1e6 * height - low) / (high - low) * (2**16 - 2))
    path.write_bytes(bytes(header) + number.T.astype("<u2").tobytes())


def write_wyko(path, height, size, *, flag=0, mult=None, other=""):
    """Wyko text: heights in waves of 635.3 nm, or in nm; a block of another kind follows."""
    nx, ny = height.shape
    pixel = 1e3 * size[0] / nx
    factor = 1.0 if mult is None else float(mult.split("\t")[-1])
    values = 1e9 * height[:, ::-1] / (1.0 if flag else 635.3 / factor)
    lines = [
        f"Wyko ASCII Data File Format 0\t{flag}\t1",
        f"X Size\t{nx}",
        f"Y Size\t{ny}",
        "Block Name\tType\tLength\tValue",
        "Wavelength\t7\t4\t635.3",
        f"Aspect\t7\t4\t{1e3 * size[1] / ny / pixel!r}",
        f"Pixel_size\t7\t4\t{pixel!r}",
        *([f"Mult\t{mult}"] if mult else []),
        f"RAW_DATA\t3\t{4 * nx * ny}",
        *("\t".join(f"{v:.9g}" for v in row) for row in values),
        *([f"{other}\t6\t{nx * ny}", *nx * ["\t".join(ny * ["7"])]] if other else []),
    ]
    path.write_text("\n".join(lines) + "\n")


SDF_TYPES = ("u1", "<u2", "<u4", "<f4", "i1", "<i2", "<i4", "<f8")


def write_sdf(path, height, size, *, dialect="bISO-1.0", kind=7, step=1e-9):
    """ISO 25178-71 and the BCR form: NaN becomes the mark of an undefined point."""
    nx, ny = height.shape
    spacing = size[0] / nx, size[1] / ny
    type_ = np.dtype(SDF_TYPES[kind])
    limits = np.finfo(type_) if type_.kind == "f" else np.iinfo(type_)
    mark = limits.max if "BCR" in dialect else limits.min
    values = height.T / step if type_.kind == "f" else np.rint(height.T / step)
    values = np.where(np.isnan(values), np.nan, values)
    if dialect[0] == "a":
        names = "NumPoints NumProfiles Xscale Yscale Zscale Zresolution Compression DataType"
        entries = (nx, ny, *spacing, step, -1.0, 0, kind)
        head = "".join(f"{k} = {v!r}\n" for k, v in zip(names.split(), entries, strict=True))
        body = "\n".join("BAD" if np.isnan(v) else f"{v:.12g}" for v in values.ravel())
        path.write_text(f"{dialect}\nManufacID = own\n{head}CheckType = 0\n*\n{body}\n*\n")
        return
    counts = struct.pack("<2I" if dialect == "bISO-2.0" else "<2H", nx, ny)
    texts = dialect.encode() + b"own".ljust(10) + 2 * b"010120260000"
    rest = struct.pack("<4d3B", *spacing, step, -1.0, 0, kind, 0)
    data = np.where(np.isnan(values), mark, values).astype(type_)
    path.write_bytes(texts + counts + rest + data.tobytes())


def write_x3p(path, height, size, *, dash="-", folder="", feature="SUR"):
    """ISO 25178-72: an archive of an index in XML and doubles in m."""
    nx, ny = height.shape
    axes = "".join(
        f"<C{axis}><AxisType>{kind}</AxisType><DataType>D</DataType><Increment>{step!r}</Increment>"
        f"<Offset>0</Offset></C{axis}>"
        for axis, kind, step in (("X", "I", size[0] / nx), ("Y", "I", size[1] / ny), ("Z", "A", 1))
    )
    text = (
        '<?xml version="1.0" encoding="UTF-8"?>'
        '<p:ISO5436_2 xmlns:p="http://www.opengps.eu/2008/ISO5436_2"><Record1>'
        f"<Revision>ISO5436 {dash} 2000</Revision><FeatureType>{feature}</FeatureType>"
        f"<Axes>{axes}</Axes></Record1><Record3><MatrixDimension><SizeX>{nx}</SizeX>"
        f"<SizeY>{ny}</SizeY><SizeZ>1</SizeZ></MatrixDimension><DataLink>"
        "<PointDataLink>bindata/data.bin</PointDataLink></DataLink></Record3>"
        "<Record4><ChecksumFile>md5checksum.hex</ChecksumFile></Record4></p:ISO5436_2>"
    ).encode()
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr(f"{folder}main.xml", text)
        archive.writestr(f"{folder}bindata/data.bin", height.T.astype("<f8").tobytes())
        archive.writestr(f"{folder}md5checksum.hex", hashlib.md5(text).hexdigest())


def write_tmd(path, height, size, comment=b"Created by TrueMap v6\r\n"):
    """TrueMap: a text of fixed length, a comment, a binary header, then floats in mm."""
    nx, ny = height.shape
    header = struct.pack("<2I4f", nx, ny, *(1e3 * edge for edge in size), 0, 0)
    texts = (b"Binary TrueMap Data File v2.0\r\n\0", comment + b"\0")
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
