"""Read the file formats of instruments with the SurfaceTopography package, imported on first use.

Its y axis points down the picture. The size of a scan is the number of pixels times the pixel size.
"""

from __future__ import annotations

import contextlib
import io
import re
import warnings
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.surfaces.reading.scan import Y_DOWN, LineScanError, Scan, in_metres
from restitution.surfaces.reading.signatures import identified

# Oldest version of SurfaceTopography that is accepted. Earlier versions misread some files without
# an error. For example, version 1.25.0 reads all lengths in .tmd files a thousand times too small,
# and it reads undefined pixels of .sur files as heights.
_OLDEST_VERSION = (1, 27)
_LARGEST_UNPACKED = 2**31  # largest total size of the unpacked files of an archive (bytes)
_BY_PRODUCT = re.compile(r"error|deflection|amplitude|phase", re.IGNORECASE)
_TEXT = frozenset({"txt", "csv", "dat", "asc", "xyz"})  # suffixes that formats share
_EXPORT = "export a height map with its unit, or save heights in metres with numpy.save"
INSTALL_READERS = (
    'install the readers with `pip install "SurfaceTopography>=1.27"` (the extra "measured")'
)


class UnrecognisedError(SurfaceError):
    """A file that no reader can open: its format is unknown, or it is damaged."""


class NoReadersError(SurfaceError):
    """SurfaceTopography, which provides the readers, is not installed or is too old."""


def read_instrument(
    path: Path, channel: int | None, content: bytes | None = None, form: str | None = None
) -> Scan:
    """Read the height channel with the number `channel`; None selects the default height channel.

    `content`, in the format `form`, replaces the bytes of the file. Raises `NoReadersError` if the
    readers are missing or too old, `UnrecognisedError` if no reader can open the file, and
    `SurfaceError` if the channel does not exist or is not a height map.
    """
    check_archive(path)
    with _quiet():
        package = _import_readers(path)
        try:
            reader = _open(package, path, content, form)
        except Exception as error:
            raise UnrecognisedError(f"{path}: {_why_unreadable(error, path, form)}") from error
        try:
            with contextlib.closing(reader):
                return _read_channel(path, reader, channel)
        except SurfaceError:
            raise
        except Exception as error:
            raise SurfaceError(
                f"{path}: its heights cannot be read ({_first_line(error)}); export it again, or "
                "export it as a text matrix of heights"
            ) from error


def read_instrument_line(
    path: Path, channel: int | None
) -> tuple[NDArray[np.float64], NDArray[np.float64], bool] | None:
    """Positions and heights of a line scan, and whether they are in metres; None for a map.

    Raises the errors of `read_instrument`.
    """
    with _quiet():
        package = _import_readers(path)
        try:
            reader = _open(package, path, None, None)
            with contextlib.closing(reader):
                channels = [one for one in reader.channels if one.dim == 1]
                if not channels:
                    return None
                chosen = channels[0] if channel is None else reader.channels[channel]
                sized = chosen.physical_sizes is not None
                line = chosen.topography(physical_sizes=None if sized else chosen.nb_grid_pts)
                x, z = line.positions_and_heights()
        except Exception as error:
            raise UnrecognisedError(f"{path}: {_why_unreadable(error, path, None)}") from error
    factor = in_metres(1.0, line.unit)
    scale = 1.0 if factor is None else factor
    heights = np.ma.filled(np.ma.asarray(z, dtype=np.float64), np.nan)
    return np.asarray(x, dtype=np.float64) * scale, heights * scale, factor is not None


def _open(package: Any, path: Path, content: bytes | None, form: str | None) -> Any:
    """Some readers accept other formats and find nothing: MATLAB's half of all NanoFocus files."""
    if content is not None:
        return package.open_topography(io.BytesIO(content), format=form)
    empty = None
    for name in _formats(package, path.suffix.lower().removeprefix(".")):
        try:
            reader = package.open_topography(str(path), **({"format": name} if name else {}))
        except Exception:
            if name is None and empty is None:
                raise
            continue
        if len(reader.channels):
            return reader
        empty = empty or reader
    return empty


def _formats(package: Any, suffix: str) -> Iterator[str | None]:
    """Yield the formats of the suffix, None for "detect it", and then all formats."""
    readers = getattr(getattr(package, "IO", None), "readers", [])
    if suffix not in _TEXT:
        yield from (reader.format() for reader in readers if suffix in reader.file_extensions())
    yield None
    yield from (reader.format() for reader in readers)


def check_archive(path: Path) -> None:
    """Raise `SurfaceError` if an archive (such as X3P) would be too large after unpacking."""
    if not zipfile.is_zipfile(path):
        return
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(member.file_size for member in archive.infolist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return  # a damaged archive; the reader of its format raises the error
    if size > _LARGEST_UNPACKED:
        raise SurfaceError(
            f"{path}: unpacks to {size} bytes, more than the {_LARGEST_UNPACKED} bytes that a scan "
            "may have; save fewer pixels"
        )


def _import_readers(path: Path) -> Any:
    try:
        import SurfaceTopography
    except ImportError as error:
        raise NoReadersError(
            f"{path}: reading this format needs the SurfaceTopography package; {INSTALL_READERS}"
        ) from error
    version = SurfaceTopography.__version__
    if tuple(int(part) for part in re.findall(r"\d+", version)[:2]) < _OLDEST_VERSION:
        oldest = ".".join(map(str, _OLDEST_VERSION))
        raise NoReadersError(
            f"{path}: reading this format needs SurfaceTopography {oldest} or later, but {version} "
            f"is installed; {INSTALL_READERS}"
        )
    return SurfaceTopography


def _read_channel(path: Path, reader: Any, channel: int | None) -> Scan:
    channels = list(reader.channels)
    heights = [c for c in channels if _is_height(c)]
    index = _default_index(reader, channels) if channel is None else channel
    if not 0 <= index < len(channels):
        if not channels:
            raise _no_height_map(path, channels)
        raise SurfaceError(
            f"{path}: there is no channel {index}; choose from {_list(channels, channels)}"
        )
    chosen = channels[index]
    if not (_is_height(chosen) or _lacks_unit(chosen)):
        if channels and all(c.dim == 1 for c in channels):
            raise LineScanError(path, int(chosen.nb_grid_pts[0]))
        if channel is None:
            raise _no_height_map(path, channels)
        raise SurfaceError(
            f"{path}: channel {index} {_described(chosen)} is not a height map that can be "
            "converted to metres; "
            + (f"choose a height channel: {_list(heights, channels)}" if heights else _EXPORT)
        )
    offered = [c for c in heights if c is not chosen and _is_surface(c)]
    others = {"other_height_channels": _list(offered, channels)} if offered else {}
    return _scan(chosen, type(reader).__name__, {"channel": index, **others})


def _scan(chosen: Any, reader: str, channel: dict[str, str | float]) -> Scan:
    # SurfaceTopography requires a physical size even if the file contains none. The number of
    # pixels is then passed as a placeholder, and the scan is returned without a size.
    sized = chosen.physical_sizes is not None
    topography = chosen.topography(physical_sizes=None if sized else chosen.nb_grid_pts)
    # A file without the unit of its heights has none for the size either.
    known = not _lacks_unit(chosen)
    x, y = (in_metres(float(side), topography.unit) for side in topography.physical_sizes)
    heights = (topography.to_unit("m") if known else topography).heights()
    return Scan(
        # Fill masked (undefined) pixels with NaN. NumPy's default value would look like a height.
        np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan),
        (x, y) if sized and known else (None, None),
        {
            "format": f"SurfaceTopography {reader}",
            **Y_DOWN,
            "channel": channel["channel"],
            "channel_name": str(chosen.name),
            **channel,
            "file_unit": str(chosen.unit),
        },
        unit=_value_unit(chosen) if known else None,
        stated=known,
        # Only Gwyddion's masks are drawn by a user; those of other formats are missing points.
        masked=reader == "GWYReader" and bool(np.ma.is_masked(heights)),
    )


def _no_height_map(path: Path, channels: list[Any]) -> SurfaceError:
    if not channels and (known := identified(path)) is not None:
        return SurfaceError(f"{path}: {known}")
    said = ", ".join(f"{n} {_described(c)}" for n, c in enumerate(channels))
    none = "none; perhaps the file is empty, or holds force curves"
    return SurfaceError(f"{path}: contains no height map (channels: {said or none}); {_EXPORT}")


def _described(channel: Any) -> str:
    return f"('{channel.name}', values in {_value_unit(channel) or 'no stated unit'})"


def _default_index(reader: Any, channels: list[Any]) -> int:
    if not channels:
        return 0
    default = int(reader.default_channel.index)
    suitable: Callable[[Any], bool]
    for suitable in (_is_surface, _is_height, _lacks_unit):
        if suitable(channels[default]):
            return default
        if (first := next((i for i, c in enumerate(channels) if suitable(c)), None)) is not None:
            return first
    return default


def _is_height(channel: Any) -> bool:
    # The unit alone does not prove that the values are heights, because "A" can mean ampere or
    # ångström.
    is_length = in_metres(1.0, _value_unit(channel)) is not None
    return bool(channel.is_height_channel and is_length and channel.dim == 2)


def _is_surface(channel: Any) -> bool:
    return _is_height(channel) and not _is_by_product(channel)


def _is_by_product(channel: Any) -> bool:
    """Whether a map in a unit of length is one of the feedback, not of the surface."""
    return _BY_PRODUCT.search(str(channel.name)) is not None


def _lacks_unit(channel: Any) -> bool:
    """Whether a map may be one of heights, but the file does not state their unit."""
    return bool(channel.dim == 2 and not channel.unit and not _value_unit(channel)) and not (
        _is_by_product(channel)
    )


def _value_unit(channel: Any) -> str | None:
    """`channel.unit` is a pair (lateral, value) if the reader could not convert the values."""
    unit: str | None = channel.unit[1] if isinstance(channel.unit, tuple) else channel.data_unit
    return unit


def _list(some: list[Any], channels: list[Any]) -> str:
    return ", ".join(
        f"{index} ('{channel.name}')"
        for index, channel in enumerate(channels)
        if any(channel is one for one in some)
    )


def _why_unreadable(error: Exception, path: Path, form: str | None) -> str:
    if form is None and (known := identified(path)) is not None:
        return known
    named_after_suffix = rf"tried {re.escape(path.suffix.removeprefix('.'))}reader:\s*(.+)"
    told = re.search(named_after_suffix, str(error), re.IGNORECASE)
    reason = _first_line(error) if form else told and told[1].strip().rstrip(".")
    why = (
        f"is damaged or incomplete ({reason})"
        if reason
        else "is damaged, or not a topography in a format known to SurfaceTopography"
    )
    return f"{why}; export it again, or export it as a text matrix of heights"


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
    ):
        warnings.simplefilter("ignore")
        yield
