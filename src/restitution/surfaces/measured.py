"""Read measured topographies: one function for all file formats, and one type of error."""

from __future__ import annotations

import hashlib
import math
import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal, get_args

import numpy as np

from restitution.arguments import typed
from restitution.display import quantity
from restitution.errors import SurfaceError, shown
from restitution.numerics.grid import Grid
from restitution.surfaces.clean import Range, crop, fill_harmonically
from restitution.surfaces.reading.instrument_files import (
    INSTALL_READERS,
    NoReadersError,
    UnrecognisedError,
    read_instrument,
)
from restitution.surfaces.reading.nms import NMS_SUFFIX, read_nms
from restitution.surfaces.reading.numpy_files import NUMPY_SUFFIXES, read_numpy
from restitution.surfaces.reading.scan import MOST_PIXELS, LineScanError, Scan, converted, in_metres
from restitution.surfaces.reading.sdf import SDF_MAGIC, read_sdf
from restitution.surfaces.reading.sur import COMPRESSED, PLAIN, read_sur
from restitution.surfaces.reading.text_files import TEXT_SUFFIXES, NotAMatrixError, read_text
from restitution.surfaces.reading.tmd import TMD_MAGIC, read_tmd
from restitution.surfaces.reading.wyko import WYKO_MAGIC, read_wyko
from restitution.surfaces.reading.x3p import is_x3p, read_x3p
from restitution.surfaces.refused import RefusedSurfaceError
from restitution.surfaces.surface import Array, Surface, noted

UndefinedPixels = Literal["error", "interpolate"]

# Undefined pixels are filled only if they are at most this fraction of all pixels. Filling more
# pixels smoothly would distort the statistics of the surface.
_LARGEST_FILL = 0.2
# The size in the file and the argument `size` count as equal up to this relative difference.
_SIZE_ROUNDING = 1e-6
# Ratio of the height range to the longer edge of the scan. Above 1, the scan is on average steeper
# than 45°, and a warning says so; no scan reaches 10.
_STEEP, _TALLEST = 1.0, 10.0
_LOWEST = 1e-12  # smallest height range (m) that any instrument measures
_LONGEST_EDGE, _LARGEST_PIXEL = 1.0, 1e-3  # of a scan with a microscope or a profiler (m)
_LARGEST = 2**30  # largest size of a file (bytes)
_OTHER_UNIT = 'set height_unit = "um" (or "mm", "nm"), or correct size'


@typed
def read_surface(
    path: str | os.PathLike[str],
    *,
    channel: int | None = None,
    size: tuple[float, float] | None = None,
    height_unit: str | None = None,
    undefined: UndefinedPixels = "error",
    within: tuple[Range | None, Range | None] = (None, None),
) -> Surface:
    """Read a measured height map, without levelling it.

    `.npy` and `.npz` hold a 2-D array in metres, `array[i, j]` at x_i, y_j; `.txt`, `.csv`, `.dat`
    and `.asc` a matrix in metres, with a scan line (constant y) on each line. All other files are
    NanoFocus, SDF, Wyko text, or a format of SurfaceTopography (extra `measured`).

    Args:
        path: File to read.
        channel: Number of the channel, from 0; None selects the reader's default height channel.
        size: Edge lengths along x and y (m), number of pixels times pixel size; they replace those
            in the file.
        height_unit: Unit of the heights, such as "um"; it replaces that in the file, or metres.
        undefined: `interpolate` fills undefined pixels harmonically from their neighbours, if at
            most 20 % of all pixels are undefined. `error` rejects a scan with undefined pixels.
        within: Ranges of x and y (m) to read, as in `crop`; None reads the whole range.

    Returns:
        Surface with heights (m), shape (nx, ny). The `notice` in its provenance names what is
        doubtful.

    Raises:
        SurfaceError: The file or an argument cannot be used.
    """
    _check_arguments(undefined, size, height_unit)
    file = Path(path)
    _check_readable(file)
    scan = _read_scan(file, channel)
    _check_shape(file, scan.height)
    heights, other = _in_unit(file, scan, height_unit)
    edges, notices = _agreed_size(file, scan, size)
    nx, ny = heights.shape
    grid = Grid((nx, ny), (edges[0] / nx, edges[1] / ny))
    notices += [*scan.notices, *other, *_doubtful_size(file, grid, given=size is not None)]
    heights, grid, cropped = _part(heights, grid, within)
    defined = np.isfinite(heights)
    missing = int(np.count_nonzero(~defined))
    _check_undefined(file, missing, defined.size, undefined, masked=scan.masked)
    notices += _doubtful_heights(file, heights[defined], edges, given=height_unit is not None)
    provenance: dict[str, str | float] = {
        "source": "measured",
        "file": str(file),
        "file_sha256": _digest(file),
        **scan.details,
        **({"height_unit": height_unit} if height_unit else {}),
        **cropped,
        "size_x_m": grid.size[0] if cropped else edges[0],
        "size_y_m": grid.size[1] if cropped else edges[1],
        "pixel_x_m": grid.spacing[0],
        "pixel_y_m": grid.spacing[1],
        "undefined_pixels": missing,
        "undefined_fraction": missing / defined.size,
        "undefined_treatment": "interpolated harmonically" if missing else "none to treat",
    }
    for notice in notices:
        provenance = noted(provenance, notice)
    return Surface(fill_harmonically(heights, grid.spacing), grid, provenance)


def states(path: Path, channel: int | None = None) -> tuple[bool, bool]:
    """Whether a topography file itself states the size of its scan, and the unit of its heights."""
    _check_readable(path)
    scan = _read_scan(path, channel)
    return None not in scan.size, scan.unit is not None and scan.stated


def _check_arguments(
    undefined: str, size: tuple[float, float] | None, height_unit: str | None
) -> None:
    if undefined not in get_args(UndefinedPixels):
        raise SurfaceError(f"undefined={undefined!r} is unknown; choose 'error' or 'interpolate'")
    if size is not None and not all(math.isfinite(side) and side > 0 for side in size):
        raise SurfaceError(
            f"size: {size[0]:g} x {size[1]:g} m are not two positive lengths; give the edge "
            "lengths of the scan in m"
        )
    if height_unit is not None:
        converted(np.zeros(0), "m", height_unit)


def _check_shape(file: Path, heights: Array) -> None:
    nx, ny = heights.shape
    if min(nx, ny) < 2:
        raise LineScanError(file, max(nx, ny))
    if nx * ny > MOST_PIXELS:
        raise SurfaceError(
            f"{file}: holds {nx} x {ny} pixels, more than the {MOST_PIXELS} that a scan may have; "
            "crop it, or save fewer pixels"
        )


def _check_readable(file: Path) -> None:
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
    with file.open("rb") as stream:
        head = stream.read(64)
    if head.startswith((PLAIN, COMPRESSED)):
        return read_sur(file, channel)
    if head.startswith(TMD_MAGIC):
        return read_tmd(file, channel)
    if suffix not in NUMPY_SUFFIXES and is_x3p(file):
        return read_x3p(file, channel)
    single = _single_channel(suffix, head)
    if single is None:
        return read_instrument(file, channel)
    try:
        scan = single(file)
    except NotAMatrixError as not_a_matrix:
        # Instruments also write files with these suffixes. If no reader of instrument files can
        # open the file, the error of the matrix reader is reported.
        try:
            return read_instrument(file, channel)
        except UnrecognisedError:
            raise not_a_matrix from None
        except NoReadersError as no_readers:
            raise SurfaceError(
                f"{not_a_matrix}; if the file has an instrument's own format, {INSTALL_READERS}"
            ) from no_readers
    if channel not in (None, 0):
        raise SurfaceError(
            f"{file}: there is no channel {channel}; this format holds one channel, so leave "
            "channel out"
        )
    return scan


def _single_channel(suffix: str, head: bytes) -> Callable[[Path], Scan] | None:
    if SDF_MAGIC.match(head):
        return read_sdf
    if head.startswith(WYKO_MAGIC):
        return read_wyko
    if suffix == NMS_SUFFIX:
        return read_nms
    if suffix in NUMPY_SUFFIXES:
        return read_numpy
    return read_text if suffix in TEXT_SUFFIXES else None


def _agreed_size(
    file: Path, scan: Scan, given: tuple[float, float] | None
) -> tuple[tuple[float, float], list[str]]:
    if given is None and not all(
        side is None or (math.isfinite(side) and side > 0) for side in scan.size
    ):
        raise SurfaceError(
            f"{file}: states a scan size of {_text(scan.size)} um, which is not two positive "
            "lengths; correct the file"
        )
    x, y = scan.size
    if given is None:
        if x is None or y is None:
            axes = scan.details.get("axes")
            raise RefusedSurfaceError(
                "size-unknown",
                f"{file}: does not contain the size of the scan"
                + (f" (its axes have {axes})" if axes else ""),
                "give its edge lengths in m, such as size=(10e-6, 10e-6)",
            )
        return (x, y), []
    same = all(
        stated is None or math.isclose(stated, wanted, rel_tol=_SIZE_ROUNDING)
        for stated, wanted in zip(scan.size, given, strict=True)
    )
    if same:
        # The size in the file is preferred, because the argument may be rounded.
        return (given[0] if x is None else x, given[1] if y is None else y), []
    return given, [
        f"{file}: the scan is {_text(scan.size)} um according to the file; it is read as "
        f"{_text(given)} um, because 'size' says so"
    ]


def _in_unit(file: Path, scan: Scan, given: str | None) -> tuple[Array, list[str]]:
    if given is None:
        if scan.unit is None:
            raise RefusedSurfaceError(
                "height-unit-unknown",
                f"{file}: channel {scan.details.get('channel', 0)} "
                f"('{scan.details.get('channel_name', '')}', values in no stated unit) may hold "
                "heights in any unit",
                'give height_unit="um" (or the unit that it has), or save heights in metres with '
                "numpy.save",
            )
        return scan.height, []
    heights = converted(scan.height, scan.unit, given)
    if not scan.stated or in_metres(1.0, scan.unit) == in_metres(1.0, given):
        return heights, []
    return heights, [
        f"{file}: the heights are in {scan.unit} according to the file; they are read in {given}, "
        "because 'height_unit' says so"
    ]


def _doubtful_size(file: Path, grid: Grid, *, given: bool) -> Iterator[str]:
    """Yield a notice if a scan is too large; raise an error unless the user gave its size."""
    if max(grid.size) < _LONGEST_EDGE and max(grid.spacing) <= _LARGEST_PIXEL:
        return
    edges = " x ".join(quantity(edge, "m") for edge in grid.size)
    pixel = quantity(max(grid.spacing), "m")
    fact = f"{file}: a scan of {edges} with pixels of {pixel} is larger than instruments take"
    if not given:
        raise RefusedSurfaceError(
            "size-impossible", fact, "give its edge lengths in m, such as size=(10e-6, 10e-6)"
        )
    yield f"{fact}; correct size, unless it is right"


def _part(
    heights: Array, grid: Grid, within: tuple[Range | None, Range | None]
) -> tuple[Array, Grid, dict[str, str | float]]:
    if within == (None, None):
        return heights, grid, {}
    # `crop` accepts only defined heights, so the marks of undefined pixels are cropped apart.
    defined = np.isfinite(heights)
    x, y = within
    part, kept = (
        crop(Surface(values, grid), x=x, y=y)
        for values in (np.where(defined, heights, 0.0), defined.astype(np.float64))
    )
    return np.where(kept.height > 0, part.height, np.nan), part.grid, dict(part.provenance)


def _check_undefined(
    file: Path, missing: int, total: int, undefined: UndefinedPixels, *, masked: bool
) -> None:
    how = "masked in the file" if masked else "undefined"
    if missing > _LARGEST_FILL * total:
        raise RefusedSurfaceError(
            "too-many-undefined",
            f"{file}: {missing} of {total} pixels ({missing / total:.1%}) are {how}, more than "
            f"the {_LARGEST_FILL:.0%} that can be filled",
            "give within=(...) to read a part with fewer, "
            + ("or remove the mask" if masked else "measure again, or crop the file"),
        )
    if missing and undefined == "error":
        raise RefusedSurfaceError(
            "masked-pixels" if masked else "undefined-pixels",
            f"{file}: {missing} of {total} pixels ({missing / total:.2%}) are {how}",
            'give undefined="interpolate" to fill them from their neighbours, '
            + ("remove the mask in Gwyddion, " if masked else "")
            + "or crop the file",
        )


def _doubtful_heights(
    file: Path, heights: Array, edges: tuple[float, float], *, given: bool
) -> Iterator[str]:
    """Yield a notice for heights in a unit that is probably wrong; raise an error if it must be."""
    span = float(heights.max()) - float(heights.min()) if heights.size else 0.0
    scan = f"{file}: heights that span {quantity(span, 'm')} on a scan of {_text(edges)} um"
    if span > _TALLEST * max(edges):
        raise RefusedSurfaceError(
            "heights-impossible",
            f"{scan} cannot be in {'that unit' if given else 'metres'}",
            _OTHER_UNIT,
        )
    if span > _STEEP * max(edges):
        yield f"{scan} are taller than the scan is wide; {_OTHER_UNIT}"
    if 0 < span < _LOWEST:
        if not given:
            raise RefusedSurfaceError(
                "heights-impossible", f"{scan} are lower than any instrument measures", _OTHER_UNIT
            )
        yield f"{scan} are lower than any instrument measures; correct height_unit"


def _text(lengths: tuple[float | None, float | None]) -> str:
    return " x ".join("?" if side is None else f"{side * 1e6:.7g}" for side in lengths)
