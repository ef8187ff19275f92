"""Read several scans of one surface: files, folders and containers."""

from __future__ import annotations

import glob
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass, replace
from fnmatch import fnmatchcase
from pathlib import Path

from restitution.errors import SurfaceError
from restitution.surfaces.clean import remove_outliers
from restitution.surfaces.joined.scan_spectrum import ScanSpectrum
from restitution.surfaces.joined.tip import tip_cut_off
from restitution.surfaces.level import Levelling, level
from restitution.surfaces.measured import UndefinedPixels, read_surface, states
from restitution.surfaces.reading.containers import (
    ContainedScan,
    contents,
    extract,
    is_container,
)
from restitution.surfaces.reading.line_scans import read_line
from restitution.surfaces.reading.scan import LineScanError
from restitution.surfaces.reading.text_files import NotAMatrixError
from restitution.surfaces.surface import Surface

_UNEVEN = 1.2  # largest step of a line scan in mean steps, up to which its points are even
_DEGREE = {"none": -1, "center": 0, "tilt": 1, "curvature": 2}
# Files beside scans in a folder.
_OTHER = frozenset({".md", ".toml", ".yml", ".yaml", ".json", ".pdf", ".png", ".jpg", ".html"})


@dataclass(frozen=True)
class HowToRead:
    """How the files of a pattern are read; see `read_surface`, `level` and `remove_outliers`.

    `tip_radius` and `resolution` (m) state the instrument; `surface` is a number in a container,
    `only` a pattern of names in it.
    """

    channel: int | None = None
    size: tuple[float, float] | None = None
    height_unit: str | None = None
    undefined: UndefinedPixels = "error"
    outliers: float | None = None
    detrend: Levelling = "curvature"
    tip_radius: float | None = None
    resolution: float | None = None
    surface: int | None = None
    only: str | None = None


def matching(folder: Path, pattern: str) -> list[Path]:
    """The files, folders with `meta.yml` and containers that `pattern` names in `folder`.

    Raises `SurfaceError` if there are none.
    """
    path = folder / pattern
    if path.is_dir() and not is_container(path):
        listed = [
            one
            for one in sorted(path.iterdir())
            if one.is_file() and not one.name.startswith(".") and one.suffix.lower() not in _OTHER
        ]
    elif glob.has_magic(pattern) and not path.exists():
        listed = sorted(Path(name) for name in glob.glob(str(path)))
    else:
        listed = [path]
    if not listed:
        raise SurfaceError(f"{path}: there is no such file; check the path or the pattern")
    return listed


def read_spectra(path: Path, how: HowToRead) -> Iterator[ScanSpectrum]:
    """Yield the spectra of the scans in a file or container.

    Raises `SurfaceError` that names the file.
    """
    if not is_container(path):
        yield _spectrum(_read(path, how), path.name, how)
        return
    taken: set[str] = set()
    with tempfile.TemporaryDirectory() as copies:
        listed = contents(path, how.surface)
        chosen = [told for told in listed if fnmatchcase(told.name, how.only or "*")]
        if not chosen:
            names = ", ".join(told.name for told in listed)
            raise SurfaceError(f"{how.only!r} matches no scan of {path}: {names}", argument="only")
        for told in chosen:
            name = told.name if told.name not in taken else f"{told.name} ({told.member})"
            taken.add(name)
            file = extract(path, told.member, Path(copies))
            own = replace(
                how,
                tip_radius=how.tip_radius or told.tip_radius or None,
                resolution=how.resolution or told.resolution or None,
            )
            try:
                yield _spectrum(_contained(file, told, how), name, own)
            except SurfaceError as error:
                reason = str(error).replace(str(file), told.member)
                raise SurfaceError(f"{path}: {reason}") from error
            finally:
                if not path.is_dir():
                    file.unlink(missing_ok=True)


def _read(path: Path, how: HowToRead) -> Surface:
    try:
        return read_surface(
            path,
            channel=how.channel,
            size=how.size,
            height_unit=how.height_unit,
            undefined=how.undefined,
        )
    except (LineScanError, NotAMatrixError):
        length = None if how.size is None else how.size[0]
        return read_line(path, unit=how.height_unit, size=length, channel=how.channel)


def _contained(file: Path, told: ContainedScan, how: HowToRead) -> Surface:
    """The scan in `file`; what its own header states counts before what `meta.yml` says."""
    channel = told.channel if how.channel is None else how.channel
    own = replace(how, channel=channel, height_unit=how.height_unit or told.unit)
    scale = told.height_scale
    if len(told.size) != 1:
        try:
            sized, in_unit = states(file, channel)
        except (LineScanError, NotAMatrixError):
            pass
        else:
            if not sized and how.size is None and len(told.size) == 2:
                own = replace(own, size=(told.size[0], told.size[1]))
            if in_unit and how.height_unit is None:
                own = replace(own, height_unit=None)
            # A file that states the unit of its heights has their scale, too, which topobank
            # repeats in meta.yml.
            scale = 1.0 if in_unit else scale
    surface = _read(file, own)
    return replace(surface, height=surface.height * scale) if scale != 1.0 else surface


def _spectrum(surface: Surface, name: str, how: HowToRead) -> ScanSpectrum:
    line = surface.grid.nodes[1] == 1
    if how.outliers is not None and not line:
        surface = remove_outliers(surface, how.outliers)
    flat = level(surface, how.detrend)
    cuts = [(0.0, "")]
    if how.resolution is not None:
        cuts.append((how.resolution, "stated resolution"))
    if how.tip_radius is not None:
        cuts.append((tip_cut_off(flat, how.tip_radius), "tip radius"))
    step = float(surface.provenance.get("largest_step_m", 0.0))
    if step > _UNEVEN * surface.grid.spacing[0]:
        cuts.append((2 * step, "uneven points"))
    return ScanSpectrum.of(flat, _DEGREE[how.detrend], name, max(cuts))
