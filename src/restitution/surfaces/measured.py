"""Read measured topographies: one function for all file formats, and one type of error."""

from __future__ import annotations

import hashlib
import math
import os
import stat
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError, shown
from restitution.numerics.grid import Grid
from restitution.surfaces.fill import fill_harmonically
from restitution.surfaces.instrument_files import (
    INSTALL_READERS,
    NoReadersError,
    UnrecognisedError,
    read_instrument,
)
from restitution.surfaces.numpy_files import NUMPY_SUFFIXES, read_numpy
from restitution.surfaces.refused import RefusedSurfaceError
from restitution.surfaces.scan import MOST_PIXELS, Scan
from restitution.surfaces.surface import Array, Surface
from restitution.surfaces.text_files import TEXT_SUFFIXES, NotAMatrixError, read_text

UndefinedPixels = Literal["error", "interpolate"]

# Undefined pixels are filled only if they are at most this fraction of all pixels. Filling more
# pixels smoothly would distort the statistics of the surface.
_LARGEST_FILL = 0.2
# The size in the file and the argument `size` count as equal up to this relative difference.
_SIZE_ROUNDING = 1e-6
# Largest allowed ratio of the height range to the longer edge of the scan. Heights that are not in
# metres exceed this ratio by far.
_TALLEST = 10.0
_LARGEST = 2**30  # largest size of a file (bytes)


@typed
def read_surface(
    path: str | os.PathLike[str],
    *,
    channel: int | None = None,
    size: tuple[float, float] | None = None,
    undefined: UndefinedPixels = "error",
) -> Surface:
    """Read a measured height map, without levelling it.

    - `.npy`, `.npz`: a 2-D array in metres, `array[i, j]` at x_i, y_j.
    - `.txt`, `.csv`, `.dat`, `.asc`: a matrix in metres; each line of the file is a scan line
      (constant y).
    - All other files, and text that is not a plain matrix: any format that SurfaceTopography can
      read. Install the extra `measured` for these formats.

    The provenance contains the file with its SHA-256, format and channel, the size of the scan, and
    the number of undefined pixels.

    Args:
        path: File to read.
        channel: Number of the channel, counted from 0; None selects the reader's default height
            channel.
        size: Edge lengths of the scan along x and y (m): number of pixels times pixel size.
            Required if the file does not contain the lengths. Otherwise `size` must agree with the
            file.
        undefined: `interpolate` fills undefined pixels harmonically from their neighbours, if at
            most 20 % of all pixels are undefined. `error` rejects a scan with undefined pixels.

    Returns:
        Surface with heights (m), shape (nx, ny).

    Raises:
        SurfaceError: The file cannot be read or its content cannot be used, or an argument is
            invalid.
    """
    if undefined not in get_args(UndefinedPixels):
        raise SurfaceError(f"undefined={undefined!r} is unknown; choose 'error' or 'interpolate'")
    if size is not None and not all(math.isfinite(side) and side > 0 for side in size):
        raise SurfaceError(
            f"size: {size[0]:g} x {size[1]:g} m are not two positive lengths; give the edge "
            "lengths of the scan in m"
        )
    file = Path(path)
    _check_readable(file)
    scan = _read_scan(file, channel)
    edges = _agreed_size(file, scan, size)
    nx, ny = scan.height.shape
    grid = Grid((nx, ny), (edges[0] / nx, edges[1] / ny))

    if nx * ny > MOST_PIXELS:
        raise SurfaceError(
            f"{file}: holds {nx} x {ny} pixels, more than the {MOST_PIXELS} that a scan may have; "
            "crop it, or save fewer pixels"
        )
    defined = np.isfinite(scan.height)
    missing = int(np.count_nonzero(~defined))
    _check_undefined(file, missing, defined.size, undefined)
    _check_metres(file, scan.height[defined], edges)
    height = fill_harmonically(scan.height, grid.spacing)
    return Surface(
        height,
        grid,
        {
            "source": "measured",
            "file": str(file),
            "file_sha256": _digest(file),
            **scan.details,
            "size_x_m": edges[0],
            "size_y_m": edges[1],
            "pixel_x_m": grid.spacing[0],
            "pixel_y_m": grid.spacing[1],
            "undefined_pixels": missing,
            "undefined_fraction": missing / defined.size,
            "undefined_treatment": "interpolated harmonically" if missing else "none to treat",
        },
    )


def _check_readable(file: Path) -> None:
    """Raise `SurfaceError` if a file is missing, unreadable, not regular, empty or too large."""
    try:
        kind = file.stat()
        if stat.S_ISDIR(kind.st_mode):
            raise SurfaceError(f"{file}: is a directory; give the topography file inside it")
        if not stat.S_ISREG(kind.st_mode):
            raise SurfaceError(
                f"{file}: is not a regular file (a device, pipe or socket); give a topography file"
            )
        if kind.st_size > _LARGEST:
            raise SurfaceError(
                f"{file}: has {kind.st_size} bytes, more than the {_LARGEST} that a scan may have; "
                "crop it, or save fewer pixels"
            )
        file.open("rb").close()
    except SurfaceError:
        raise
    except FileNotFoundError as error:
        raise SurfaceError(f"{file}: there is no such file; check the path") from error
    except (OSError, ValueError) as error:
        why = error.strerror if isinstance(error, OSError) else error
        raise SurfaceError(
            f"{shown(str(file), 200)}: cannot be opened ({why}); check the path"
        ) from error
    if kind.st_size == 0:
        raise SurfaceError(f"{file}: is empty; export the topography again")


def _digest(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _read_scan(file: Path, channel: int | None) -> Scan:
    suffix = file.suffix.lower()
    if suffix in NUMPY_SUFFIXES:
        scan = read_numpy(file)
    elif suffix in TEXT_SUFFIXES:
        try:
            scan = read_text(file)
        except NotAMatrixError as not_a_matrix:
            # Instruments also write files with these suffixes. If no reader of instrument files
            # can open the file, the error of the matrix reader is reported.
            try:
                return read_instrument(file, channel)
            except UnrecognisedError:
                raise not_a_matrix from None
            except NoReadersError as no_readers:
                raise SurfaceError(
                    f"{not_a_matrix}; if the file has an instrument's own format, {INSTALL_READERS}"
                ) from no_readers
    else:
        return read_instrument(file, channel)
    if channel not in (None, 0):
        raise SurfaceError(
            f"{file}: there is no channel {channel}; this format holds one channel, so leave "
            "channel out"
        )
    return scan


def _agreed_size(file: Path, scan: Scan, given: tuple[float, float] | None) -> tuple[float, float]:
    """Edge lengths (m) from the file or from `given`; raise `SurfaceError` if they disagree."""
    if not all(side is None or (math.isfinite(side) and side > 0) for side in scan.size):
        raise SurfaceError(
            f"{file}: states a scan size of {_text(scan.size)} um, which is not two positive "
            "lengths; correct the file"
        )
    x, y = scan.size
    if given is None:
        if x is None or y is None:
            raise RefusedSurfaceError(
                "size-unknown",
                f"{file}: does not contain the size of the scan",
                "give its edge lengths in m, such as size=(10e-6, 10e-6)",
            )
        return x, y
    for stated, wanted in zip(scan.size, given, strict=True):
        if stated is not None and not math.isclose(stated, wanted, rel_tol=_SIZE_ROUNDING):
            raise SurfaceError(
                f"{file}: the scan is {_text(scan.size)} um according to the file, but "
                f"{_text(given)} um according to the argument 'size'; leave 'size' out, or correct "
                "it"
            )
    # The size in the file is preferred, because the argument may be rounded.
    return given[0] if x is None else x, given[1] if y is None else y


def _check_undefined(file: Path, missing: int, total: int, undefined: UndefinedPixels) -> None:
    if missing > _LARGEST_FILL * total:
        raise SurfaceError(
            f"{file}: {missing} of {total} pixels ({missing / total:.1%}) are undefined, more than "
            f"the {_LARGEST_FILL:.0%} that can be filled; measure again, or crop the file"
        )
    if missing and undefined == "error":
        raise RefusedSurfaceError(
            "undefined-pixels",
            f"{file}: {missing} of {total} pixels ({missing / total:.2%}) are undefined",
            'give undefined="interpolate" to fill them from their neighbours, or crop the file',
        )


def _check_metres(file: Path, heights: Array, edges: tuple[float, float]) -> None:
    span = float(heights.max()) - float(heights.min())
    if span > _TALLEST * max(edges):
        raise SurfaceError(
            f"{file}: heights that span {span:g} m on a scan of {_text(edges)} um cannot be in "
            "metres; convert them to metres, or correct the size"
        )


def _text(lengths: tuple[float | None, float | None]) -> str:
    return " x ".join("?" if side is None else f"{side * 1e6:.7g}" for side in lengths)
