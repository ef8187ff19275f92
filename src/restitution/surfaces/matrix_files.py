"""Height matrices in NumPy files and in plain text, read without any further package.

Which way the axes run (heights are `[i, j]` ↔ `[x, y]` everywhere in this package):

    .npy, .npz    array[i, j] is the height at x_i, y_j
    text          a line of the file is a scan line: the column is x, the line is y, as Gwyddion,
                  SurfaceTopography and the instruments write it
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.surfaces.scan import Y_DOWN, Scan, in_metres

NUMPY_SUFFIXES = frozenset({".npy", ".npz"})
TEXT_SUFFIXES = frozenset({".txt", ".csv", ".dat", ".asc"})

_SAVE_AS_NUMPY = "save the heights in metres as a 2-D array with numpy.save"
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_STATEMENT = re.compile(r"#\s*(?P<key>[^:=]*?)\s*[:=]\s*(?P<value>.*?)\s*$")
_QUANTITY = re.compile(rf"(?P<number>{_NUMBER})\s*(?P<unit>\S+)")
# Keys by which other programs' headers (SPIP, Nova, Gwyddion's XYZ) fix units and scales.
_FOREIGN_KEY = re.compile(r"unit|length|pixel|bit2|file format|factor", re.IGNORECASE)
_UNDEFINED = frozenset({"", "bad", "nan", "inf", "-inf", "infinite"})


class NotAMatrixError(SurfaceError):
    """A text file that is no plain matrix of heights, but may be an instrument's own format."""


def read_numpy(path: Path) -> Scan:
    """Read the 2-D array of a `.npy`, or the array `height` or the only one of a `.npz`, in m.

    A `.npz` may also hold `size`, the two edge lengths in m. Raises `SurfaceError` for anything
    else, and for pickled objects without loading them.
    """
    array, size, details = _load_arrays(path)
    if array.ndim != 2 or min(array.shape) < 2:
        raise SurfaceError(
            f"{path}: holds an array of shape {array.shape}, not a height map; {_SAVE_AS_NUMPY}"
        )
    if array.dtype.kind not in "iuf":
        raise SurfaceError(
            f"{path}: holds data of type {array.dtype}, not real numbers; {_SAVE_AS_NUMPY}"
        )
    # A longer float that does not fit becomes infinite, and is then reported as undefined.
    with np.errstate(over="ignore"):
        height = np.array(array, dtype=np.float64)
    return Scan(height, size, details)


def _load_arrays(
    path: Path,
) -> tuple[NDArray[np.generic], tuple[float | None, float | None], dict[str, str | float]]:
    # Unpickling runs code that the file brings, so it stays forbidden in both branches.
    try:
        if path.suffix.lower() == ".npy":
            # Mapping the file compares the shape its header promises with its length, where
            # loading it would allocate whatever a damaged header asks for.
            return np.lib.format.open_memmap(path, mode="r"), (None, None), {"format": "npy"}
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            key = _height_key(path, archive.files)
            size = _size_entry(path, archive["size"]) if "size" in archive.files else (None, None)
            return archive[key], size, {"format": "npz", "channel_name": key}
    except SurfaceError:
        raise
    except Exception as error:
        raise SurfaceError(
            f"{path}: is no plain NumPy file (damaged, or with pickled objects, which are never "
            f"loaded); {_SAVE_AS_NUMPY}"
        ) from error


def _height_key(path: Path, keys: list[str]) -> str:
    if "height" in keys:
        return "height"
    others = [key for key in keys if key != "size"]
    if len(others) != 1:
        raise SurfaceError(
            f"{path}: holds the arrays {', '.join(keys) or '(none)'}, and none is called 'height'; "
            "name the height map 'height'"
        )
    return others[0]


def _size_entry(path: Path, entry: NDArray[np.generic]) -> tuple[float, float]:
    if entry.shape != (2,) or entry.dtype.kind not in "iuf":
        raise SurfaceError(
            f"{path}: its array 'size' has shape {entry.shape} and type {entry.dtype}; store the "
            "two edge lengths in metres there, or leave it out"
        )
    x, y = entry.astype(np.float64)
    return float(x), float(y)


def read_text(path: Path) -> Scan:
    """Read a matrix of heights in m, separated by white space, commas or semicolons.

    Lines that start with # are comments; `# Width:` and `# Height:` give the size and
    `# Value units:` the unit of the heights. An empty field, `nan` or `bad` is undefined. With
    semicolons the comma is a decimal sign.

    Raises `NotAMatrixError` when the content is not such a matrix but may be understood by
    another reader, `SurfaceError` when it is one and is damaged or does not hold heights.
    """
    lines = [line.strip() for line in _decode(path).splitlines()]
    data = [(n, line) for n, line in enumerate(lines, 1) if line and not line.startswith("#")]
    if not data:
        raise SurfaceError(f"{path}: holds no numbers; {_SAVE_AS_NUMPY}")
    rows = [_parse_row(path, n, line) for n, line in data]
    width = len(rows[0])
    for (n, _), row in zip(data, rows, strict=True):
        if len(row) != width:
            raise SurfaceError(
                f"{path}: line {n} has {len(row)} values where the first has {width}, so the file "
                "is incomplete or not a matrix; export it again"
            )
    if width < 4 or len(rows) < 2:
        raise NotAMatrixError(
            f"{path}: {len(rows)} lines of {width} values are a profile or a list of coordinates, "
            "not a height map; give a matrix with a scan line of at least 4 heights on each line"
        )
    size, metres_per_value, details = _read_header(
        path, [line for line in lines if line.startswith("#")]
    )
    height = np.ascontiguousarray(np.array(rows, dtype=np.float64).T) * metres_per_value
    return Scan(height, size, {"format": "text matrix", **Y_DOWN, **details})


def _decode(path: Path) -> str:
    raw = path.read_bytes()
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _parse_row(path: Path, number: int, line: str) -> list[float]:
    if ";" in line:
        fields = line.replace(",", ".").removesuffix(";").split(";")
    elif "," in line:
        fields = line.removesuffix(",").split(",")
    else:
        fields = line.split()
    try:
        return [float(text) for text in fields]
    except ValueError:
        return [_parse_field(path, number, text.strip()) for text in fields]


def _parse_field(path: Path, number: int, text: str) -> float:
    if text.lower() in _UNDEFINED:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise NotAMatrixError(
            f"{path}: line {number} holds {text[:20]!a}, which is not a number; give a matrix of "
            "heights in metres, with comments after #"
        ) from None


def _read_header(
    path: Path, comments: list[str]
) -> tuple[tuple[float | None, float | None], float, dict[str, str | float]]:
    """Edge lengths (m), metres for each unit of height, and details, from the comment lines."""
    sides: dict[str, float] = {}
    metres_per_value = 1.0
    details: dict[str, str | float] = {}
    for match in filter(None, map(_STATEMENT.match, comments)):
        key, value = match["key"].lower(), match["value"]
        quantity = _QUANTITY.fullmatch(value)
        number, unit = (float(quantity["number"]), quantity["unit"]) if quantity else (1.0, value)
        length = in_metres(number, unit)
        if key in ("width", "height") and quantity and length is not None:
            sides[key] = length
        elif key == "value units":
            if quantity or length is None:
                raise SurfaceError(
                    f"{path}: its values are in {value!r}, which is not a length; export the "
                    "height channel instead"
                )
            metres_per_value = length
        elif key == "channel":
            details["channel_name"] = value
        elif length is not None or _FOREIGN_KEY.search(key):
            # Guessing at a scale could be wrong by a factor of a million without a sign of it.
            raise NotAMatrixError(
                f"{path}: its header line {match[0][:60]!a} may set a unit or a scale that is not "
                "understood; state '# Width:', '# Height:' and '# Value units:' only"
            )
    return (sides.get("width"), sides.get("height")), metres_per_value, details
