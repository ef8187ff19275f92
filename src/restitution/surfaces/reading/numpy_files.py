"""Read height matrices from NumPy files: `array[i, j]` is the height at x_i, y_j."""

from __future__ import annotations

import math
import zipfile
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.surfaces.reading.scan import MOST_PIXELS, Scan

NUMPY_SUFFIXES = frozenset({".npy", ".npz"})
SAVE_AS_NUMPY = "save the heights in metres as a 2-D array with numpy.save"


def read_numpy(path: Path) -> Scan:
    """Read a height map (m): the only array of the file, or `height` in a `.npz` file.

    A `.npz` file may also contain `size`, the two edge lengths (m). Raises `SurfaceError` for other
    content, including pickled objects, which are not loaded.
    """
    array, size, details = _load_arrays(path)
    if array.ndim != 2 or min(array.shape) < 2:
        raise SurfaceError(
            f"{path}: holds an array of shape {array.shape}, not a height map; {SAVE_AS_NUMPY}"
        )
    if array.dtype.kind not in "iuf":
        raise SurfaceError(
            f"{path}: holds data of type {array.dtype}, not real numbers; {SAVE_AS_NUMPY}"
        )
    # A long double beyond the range of float64 becomes infinite and counts as an undefined height.
    with np.errstate(over="ignore"):
        height = np.array(array, dtype=np.float64)
    return Scan(height, size, details, stated=False)


def _load_arrays(
    path: Path,
) -> tuple[NDArray[np.generic], tuple[float | None, float | None], dict[str, str | float]]:
    # Unpickling could run code from the file, so it is forbidden for .npy and .npz.
    try:
        _check_headers(path)
        if path.suffix.lower() == ".npy":
            # A damaged header can state a huge shape, and `np.load` would allocate memory for this
            # shape. `open_memmap` instead compares the shape with the length of the file.
            return np.lib.format.open_memmap(path, mode="r"), (None, None), {"format": "npy"}
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as archive:
            key = _height_key(path, archive.files)
            size = _size_entry(path, archive["size"]) if "size" in archive.files else (None, None)
            return archive[key], size, {"format": "npz", "channel_name": key}
    except SurfaceError:
        raise
    except Exception as error:
        raise SurfaceError(
            f"{path}: is not a plain NumPy file (damaged, or with pickled objects, which are never "
            f"loaded); {SAVE_AS_NUMPY}"
        ) from error


def _height_key(path: Path, keys: list[str]) -> str:
    if "height" in keys:
        return "height"
    others = [key for key in keys if key != "size"]
    if len(others) != 1:
        raise SurfaceError(
            f"{path}: holds the arrays {', '.join(keys) or '(none)'}, but not 'height'; name the "
            "height map 'height'"
        )
    return others[0]


def _size_entry(path: Path, entry: NDArray[np.generic]) -> tuple[float, float]:
    if entry.shape != (2,) or entry.dtype.kind not in "iuf":
        raise SurfaceError(
            f"{path}: its array 'size' has shape {entry.shape} and type {entry.dtype}; store the "
            "two edge lengths in metres in 'size', or leave it out"
        )
    x, y = entry.astype(np.float64)
    return float(x), float(y)


def _check_headers(path: Path) -> None:
    if path.suffix.lower() == ".npy":
        with path.open("rb") as stream:
            _check_header(path, stream)
        return
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            with archive.open(name) as stream:
                _check_header(path, stream)


def _check_header(path: Path, stream: IO[bytes]) -> None:
    version = np.lib.format.read_magic(stream)
    read = (
        np.lib.format.read_array_header_1_0
        if version == (1, 0)
        else np.lib.format.read_array_header_2_0
    )
    shape, _, dtype = read(stream)
    if math.prod(shape) * max(dtype.itemsize, 1) > 16 * MOST_PIXELS or (
        math.prod(shape) > MOST_PIXELS
    ):
        raise SurfaceError(
            f"{path}: holds an array of {' x '.join(map(str, shape))[:60]} values, more than the "
            f"{MOST_PIXELS} pixels that a scan may have; crop it, or save fewer pixels"
        )
