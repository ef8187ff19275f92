"""Name a file by its first bytes, if no reader here knows it: what people have beside scans."""

from __future__ import annotations

import zipfile
from pathlib import Path

_UNPACK = "unpack it, and give the scan in it"
_MEASURED = "give the measured heights, in the instrument's own format or as a text matrix"
_GWYDDION = "open it in Gwyddion, and save it as .gwy"
_MESH = "give heights on a regular grid; CloudCompare and Gwyddion make them from points"

# Offset, first bytes, what the file is, and what to do.
_SIGNATURES: tuple[tuple[int, bytes, str, str], ...] = (
    (0, b"\x1f\x8b", "is compressed (gzip)", _UNPACK),
    (0, b"BZh", "is compressed (bzip2)", _UNPACK),
    (0, b"\xfd7zXZ\0", "is compressed (xz)", _UNPACK),
    (0, b"\x28\xb5\x2f\xfd", "is compressed (zstd)", _UNPACK),
    (0, b"7z\xbc\xaf\x27\x1c", "is an archive (7z)", _UNPACK),
    (0, b"Rar!\x1a\x07", "is an archive (rar)", _UNPACK),
    (257, b"ustar", "is an archive (tar)", _UNPACK),
    (0, b"\x89PNG\r\n", "is a picture (PNG) without heights", _MEASURED),
    (0, b"\xff\xd8\xff", "is a picture (JPEG) without heights", _MEASURED),
    (0, b"GIF8", "is a picture (GIF) without heights", _MEASURED),
    (0, b"BM", "is a picture (BMP) without heights", _MEASURED),
    (0, b"II*\0", "is a picture (TIFF) without heights in a unit of length", _MEASURED),
    (0, b"MM\0*", "is a picture (TIFF) without heights in a unit of length", _MEASURED),
    (0, b"II+\0", "is a picture (BigTIFF) without heights in a unit of length", _MEASURED),
    (0, b"%PDF", "is a document (PDF)", _MEASURED),
    (0, b"<!DOCTYPE html", "is a web page, perhaps of a failed download", "download it again"),
    (0, b"<html", "is a web page, perhaps of a failed download", "download it again"),
    (0, b"version https://git-lfs", "is a pointer of Git LFS, not the file", "git lfs pull"),
    (0, b"ply\n", "is a mesh or a point cloud (PLY)", _MESH),
    (0, b"ply\r", "is a mesh or a point cloud (PLY)", _MESH),
    (0, b"solid ", "is a mesh (STL)", _MESH),
    (0, b"LASF", "is a point cloud (LAS)", _MESH),
    (0, b"glTF", "is a mesh (glTF)", _MESH),
    (0, b":NANONIS_VERSION:", "is a Nanonis scan (.sxm)", _GWYDDION),
    (0, b"Gwyddion Simple Field 1.0", "is a Gwyddion simple field (.gsf)", _GWYDDION),
    (0, b"Gwyddion XYZ Field 1.0", "is a Gwyddion XYZ field (.gxyzf)", _GWYDDION),
    (0, b"ISO/TC 201 SPM data transfer format", "is an ISO 28600 file (.spm)", _GWYDDION),
    (0, b"MAP_SIZE", "is an RHK file", _GWYDDION),
    (0, b"ONTMATRX0101", "is an Omicron Matrix file (.mtrx)", _GWYDDION),
    (0, b"#R3", "is an Omicron parameter file (.par)", _GWYDDION),
    (0, b"SPMLab", "is a Thermicroscopes SPMLab file", _GWYDDION),
    (0, b"SIMPLE  =", "is a FITS file", _GWYDDION),
    (0, b"SDF_", "is an IntelliWave or other SDF file, not ISO 25178-71", _GWYDDION),
    (0, b"\xd0\xcf\x11\xe0", "is an OLE file (such as .xls, .oib or .mnt)", "export it as .sur"),
    (0, b"MATLAB 5.0", "is a MATLAB file without a matrix of real numbers", _MEASURED),
    (0, b"\x89HDF\r\n", "is an HDF5 file without a height map that is known here", _MEASURED),
)
_CONTAINERS = frozenset({"meta.yml", "meta.yaml", "meta.json", "index.json"})


def identified(path: Path) -> str | None:
    """What the file is and what to do, from its first bytes; None if it is unknown."""
    with path.open("rb") as stream:
        head = stream.read(512)
    if head.startswith(b"PK"):
        return _archive(path)
    for offset, magic, what, remedy in _SIGNATURES:
        if head[offset:].startswith(magic):
            return f"{what}; {remedy}"
    return None


def _archive(path: Path) -> str | None:
    try:
        with zipfile.ZipFile(path) as archive:
            names = [name for name in archive.namelist() if not name.endswith("/")]
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return None
    files = {name.rpartition("/")[2] for name in names}
    if files & _CONTAINERS:
        return (
            "is a contact.engineering container; unpack it, and give one of the scans in it "
            '(.nc), or join all of them (kind = "joined")'
        )
    if "[Content_Types].xml" in files:
        return "is an Office document without a table of heights; save the heights as .csv"
    if "header.properties" in files:
        return "holds force curves (JPK), not a height map; export a height map"
    shown = ", ".join(sorted(files)[:3])
    return f"is an archive (zip) of {len(names)} files, such as {shown}; {_UNPACK}"
