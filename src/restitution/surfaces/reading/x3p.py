"""Read X3P files, a zip archive of `main.xml` and binary heights.

SurfaceTopography 1.27.1 refuses a revision that is not spelt "ISO5436 - 2000" with a hyphen, and
archives whose members are in a folder. Other programs, among them an R package, write both.
"""

from __future__ import annotations

import io
import re
import zipfile
from pathlib import Path

from restitution.errors import SurfaceError
from restitution.surfaces.reading.instrument_files import check_archive, read_instrument
from restitution.surfaces.reading.scan import LineScanError, Scan

_MAIN = "main.xml"
_REVISION = re.compile(r"(<Revision>)\s*ISO\s*5436\s*[-\u2010-\u2015\u2212]\s*2000\s*(</Revision>)")
_FEATURE = re.compile(r"<FeatureType>\s*(\w+)\s*</FeatureType>")
_POINTS = re.compile(r"<SizeX>\s*(\d+)\s*</SizeX>")


def is_x3p(path: Path) -> bool:
    """Whether the file is a zip archive that contains `main.xml`."""
    if not zipfile.is_zipfile(path):
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return any(name.rpartition("/")[2] == _MAIN for name in archive.namelist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return False


def read_x3p(path: Path, channel: int | None) -> Scan:
    """Read the heights; see `read_instrument`."""
    check_archive(path)
    try:
        content = _usual(path)
    except SurfaceError:
        raise
    except (zipfile.BadZipFile, ValueError, NotImplementedError, EOFError, OSError):
        content = None  # damaged: the reader of this format says how
    return read_instrument(path, channel, content, "x3p")


def _usual(path: Path) -> bytes | None:
    """The archive in the form that all readers accept; None if the file has this form."""
    with zipfile.ZipFile(path) as archive:
        main = min(
            (name for name in archive.namelist() if name.rpartition("/")[2] == _MAIN), key=len
        )
        text = archive.read(main).decode("utf-8")
        _check_feature(path, text)
        usual = _REVISION.sub(r"\1ISO5436 - 2000\2", text)
        folder = main.removesuffix(_MAIN)
        if not folder and usual == text:
            return None
        rewritten = io.BytesIO()
        with zipfile.ZipFile(rewritten, "w") as other:
            for name in archive.namelist():
                if name.startswith(folder) and not name.endswith("/"):
                    data = usual if name == main else archive.read(name)
                    other.writestr(name.removeprefix(folder), data)
    return rewritten.getvalue()


def _check_feature(path: Path, text: str) -> None:
    feature = _FEATURE.search(text)
    if feature and feature[1] == "PRF":
        points = _POINTS.search(text)
        raise LineScanError(path, int(points[1]) if points else 0)
    if feature and feature[1] == "PCL":
        raise SurfaceError(
            f"{path}: is a point cloud (FeatureType PCL), not a height map; export the heights on "
            "a regular grid"
        )
