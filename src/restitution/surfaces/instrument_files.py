"""Read the file formats of instruments with the SurfaceTopography package.

SurfaceTopography and this package both index heights `[i, j]` along x and y. SurfaceTopography's y
axis points down the picture, so `imshow(heights.T)` shows the scan as the instrument does. The
physical size of a scan is the number of pixels times the pixel size. SurfaceTopography is optional
and imported on first use.
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

from restitution.errors import SurfaceError
from restitution.surfaces.scan import Y_DOWN, Scan, in_metres

# Oldest version of SurfaceTopography that is accepted. Earlier versions misread some files without
# an error. For example, version 1.25.0 reads all lengths in .tmd files a thousand times too small,
# and it reads undefined pixels of .sur files as heights.
_OLDEST_VERSION = (1, 27)
_LARGEST_UNPACKED = 2**31  # largest total size of the unpacked files of an archive (bytes)
INSTALL_READERS = (
    'install the readers with `pip install "SurfaceTopography>=1.27"` (the extra "measured")'
)


class UnrecognisedError(SurfaceError):
    """A file that no reader can open: its format is unknown, or it is damaged."""


class NoReadersError(SurfaceError):
    """SurfaceTopography, which provides the readers, is not installed or is too old."""


def read_instrument(path: Path, channel: int | None) -> Scan:
    """Read the height channel with the number `channel`; None selects the default height channel.

    Raises `NoReadersError` if the readers are missing or too old, `UnrecognisedError` if no reader
    can open the file, and `SurfaceError` if the channel does not exist or is not a height map in a
    unit of length.
    """
    _check_archive(path)
    with _quiet():
        open_topography = _import_readers(path)
        try:
            reader = open_topography(str(path))
        except Exception as error:
            raise UnrecognisedError(
                f"{path}: {_why_unreadable(error, path.suffix)}; export it again, or export it "
                "as a text matrix of heights"
            ) from error
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


def _check_archive(path: Path) -> None:
    """Raise `SurfaceError` if an archive (such as X3P) would be too large after unpacking."""
    if not zipfile.is_zipfile(path):
        return
    try:
        with zipfile.ZipFile(path) as archive:
            size = sum(each.file_size for each in archive.infolist())
    except (zipfile.BadZipFile, ValueError, NotImplementedError):
        return  # a damaged archive; the reader of its format raises the error
    if size > _LARGEST_UNPACKED:
        raise SurfaceError(
            f"{path}: unpacks to {size} bytes, more than the {_LARGEST_UNPACKED} bytes that a scan "
            "may have; save fewer pixels"
        )


def _import_readers(path: Path) -> Callable[[str], Any]:
    """Import SurfaceTopography and return the function that opens a file."""
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
    open_topography: Callable[[str], Any] = SurfaceTopography.open_topography
    return open_topography


def _read_channel(path: Path, reader: Any, channel: int | None) -> Scan:
    channels = list(reader.channels)
    index = _default_index(reader, channels) if channel is None else channel
    if not 0 <= index < len(channels):
        raise SurfaceError(
            f"{path}: there is no channel {index}; choose from {_list(channels, channels)}"
        )
    chosen = channels[index]
    if not _is_height(chosen):
        heights = [candidate for candidate in channels if _is_height(candidate)]
        remedy = (
            f"choose a height channel: {_list(heights, channels)}"
            if heights
            else "export a height map with its unit, or save heights in metres with numpy.save"
        )
        raise SurfaceError(
            f"{path}: channel {index} ('{chosen.name}', values in "
            f"{_value_unit(chosen) or 'no stated unit'}) is not a height map that can be converted "
            f"to metres; {remedy}"
        )
    # SurfaceTopography requires a physical size even if the file contains none. The number of
    # pixels is then passed as a placeholder, and the scan is returned without a size.
    sized = chosen.physical_sizes is not None
    topography = chosen.topography(physical_sizes=None if sized else chosen.nb_grid_pts)
    x, y = (in_metres(float(side), topography.unit) for side in topography.physical_sizes)
    heights = topography.to_unit("m").heights()
    others = [each for each in channels if each is not chosen and _is_height(each)]
    return Scan(
        # Fill masked (undefined) pixels with NaN. NumPy's default value would look like a height.
        np.ma.filled(np.ma.asarray(heights, dtype=np.float64), np.nan),
        (x, y) if sized else (None, None),
        {
            "format": f"SurfaceTopography {type(reader).__name__}",
            **Y_DOWN,
            "channel": index,
            "channel_name": str(chosen.name),
            **({"other_height_channels": _list(others, channels)} if others else {}),
            "file_unit": str(chosen.unit),
        },
    )


def _default_index(reader: Any, channels: list[Any]) -> int:
    """Index of the default channel if it is a height map, otherwise of the first height map."""
    default = int(reader.default_channel.index)
    if _is_height(channels[default]):
        return default
    return next((i for i, candidate in enumerate(channels) if _is_height(candidate)), default)


def _is_height(channel: Any) -> bool:
    # The unit alone does not prove that the values are heights, because "A" can mean ampere or
    # ångström.
    is_length = in_metres(1.0, _value_unit(channel)) is not None
    return bool(channel.is_height_channel and is_length and channel.dim == 2)


def _value_unit(channel: Any) -> str | None:
    """Unit of the values of a channel; None if unknown.

    `channel.unit` is the lateral unit, or a pair (lateral unit, value unit) if the reader could not
    convert the values to the lateral unit.
    """
    unit: str | None = channel.unit[1] if isinstance(channel.unit, tuple) else channel.data_unit
    return unit


def _list(some: list[Any], channels: list[Any]) -> str:
    return ", ".join(
        f"{index} ('{channel.name}')"
        for index, channel in enumerate(channels)
        if any(channel is one for one in some)
    )


def _why_unreadable(error: Exception, suffix: str) -> str:
    """Describe in words why SurfaceTopography cannot open a file.

    If one of its readers is named after the `suffix` of the file, the message of this reader is
    included.
    """
    named_after_suffix = rf"tried {re.escape(suffix.removeprefix('.'))}reader:\s*(.+)"
    reason = re.search(named_after_suffix, str(error), re.IGNORECASE)
    if reason is None:
        return "is damaged, or not a topography in a format known to SurfaceTopography"
    return f"is damaged or incomplete ({reason[1].strip().rstrip('.')})"


def _first_line(error: Exception) -> str:
    lines = str(error).strip().splitlines()
    return lines[0].rstrip(".") if lines else type(error).__name__


@contextlib.contextmanager
def _quiet() -> Iterator[None]:
    """Suppress output and warnings of third-party readers."""
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(io.StringIO()),
        contextlib.redirect_stderr(io.StringIO()),
    ):
        warnings.simplefilter("ignore")
        yield
