"""Read which scans a container of contact.engineering (`.zip` or folder with `meta.yml`) holds.

The format is that of topobank, which SurfaceTopography reads and writes.
"""

from __future__ import annotations

import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

from restitution.errors import SurfaceError, shown
from restitution.surfaces.reading.instrument_files import check_archive
from restitution.surfaces.reading.scan import in_metres

META = "meta.yml"
_KEYS = ("original", "squeezed-netcdf")  # of the data file, in order of preference


@dataclass(frozen=True)
class ContainedScan:
    """A scan in a container.

    Attributes:
        name: Name of the scan.
        member: Path in the container.
        channel: Number of the channel; None for the default.
        size: Edge lengths (m), of one edge for a line scan; empty if unknown.
        unit: Unit of lengths, if the file of the scan does not state one.
        height_scale: Factor of the heights, if the file of the scan has none.
        tip_radius: Radius of the tip (m); 0 if unknown.
        resolution: Shortest wave (m) that the instrument resolves; 0 if unknown.
    """

    name: str
    member: str
    channel: int | None
    size: tuple[float, ...]
    unit: str | None
    height_scale: float
    tip_radius: float
    resolution: float


def is_container(path: Path) -> bool:
    """Whether `path` is a container: an archive or a folder with `meta.yml`."""
    if path.is_dir():
        return (path / META).is_file()
    if not path.is_file() or not zipfile.is_zipfile(path):
        return False
    try:
        with zipfile.ZipFile(path) as archive:
            return META in archive.namelist()
    except zipfile.BadZipFile:
        return False


def contents(path: Path, surface: int | None = None) -> list[ContainedScan]:
    """The scans of surface number `surface` (from 0), which a container of one surface needs not.

    Raises `SurfaceError` if the container is damaged or has several surfaces.
    """
    surfaces = _surfaces(path)
    if surface is None and len(surfaces) > 1:
        names = ", ".join(
            f"{number} ({shown(str(one.get('name', 'without a name')), 40)})"
            for number, one in enumerate(surfaces)
        )
        raise SurfaceError(
            f"{path}: holds {len(surfaces)} surfaces; choose one: {names}", argument="surface"
        )
    if not 0 <= (surface or 0) < len(surfaces):
        raise SurfaceError(
            f"{path}: has no surface {surface}; it holds {len(surfaces)}, counted from 0",
            argument="surface",
        )
    listed = list(_scans(path, surfaces[surface or 0]))
    if not listed:
        raise SurfaceError(f"{path}: its surface has no scans; export the container again")
    return listed


def extract(path: Path, member: str, folder: Path) -> Path:
    """Copy a member of a container into `folder`; raise `SurfaceError` if it is damaged."""
    if path.is_dir():
        return path / member
    copy = folder / PurePosixPath(member).name
    try:
        with zipfile.ZipFile(path) as archive:
            copy.write_bytes(archive.read(member))
    except KeyError:
        raise SurfaceError(
            f"{path}: lacks its member {shown(member, 80)}; export the container again"
        ) from None
    except (zipfile.BadZipFile, OSError, EOFError, NotImplementedError, RuntimeError) as error:
        raise SurfaceError(
            f"{path}: its member {shown(member, 80)} is damaged ({error}); export the container "
            "again"
        ) from error
    return copy


def _surfaces(path: Path) -> list[Mapping[str, Any]]:
    try:
        import yaml
    except ImportError:
        raise SurfaceError(
            f"{path}: reading a container needs PyYAML; install it with `pip install "
            '"SurfaceTopography>=1.27"` (the extra "measured")'
        ) from None

    class Loader(yaml.SafeLoader):  # type: ignore[misc]
        """Also reads the tuples that topobank writes."""

    def as_tuple(loader: Any, node: Any) -> tuple[Any, ...]:
        return tuple(loader.construct_sequence(node))

    Loader.add_constructor("tag:yaml.org,2002:python/tuple", as_tuple)
    Loader.add_multi_constructor("tag:yaml.org,2002:python/object", lambda *_: None)
    try:
        if path.is_dir():
            text = (path / META).read_bytes()
        else:
            check_archive(path)
            with zipfile.ZipFile(path) as archive:
                text = archive.read(META)
        content = yaml.load(text, Loader=Loader)
        surfaces = list(content["surfaces"])
        if not all(isinstance(one["topographies"], list) for one in surfaces) or not surfaces:
            raise TypeError("no list of topographies")
    except (zipfile.BadZipFile, OSError, yaml.YAMLError, KeyError, TypeError, ValueError) as error:
        reason = str(error).splitlines()[0]
        raise SurfaceError(
            f"{path}: its {META} is damaged ({reason}); export the container again"
        ) from error
    return surfaces


def _scans(path: Path, surface: Mapping[str, Any]) -> Iterator[ContainedScan]:
    for told in surface["topographies"]:
        files = told.get("datafile", {}) if isinstance(told, dict) else {}
        if isinstance(files, str):
            files = {"original": files}
        member = next((files[key] for key in _KEYS if key in files), None)
        if member is None:
            raise SurfaceError(
                f"{path}: a scan in its {META} has no data file; export the container again"
            )
        name = str(told.get("name", member))
        unit = told.get("unit")
        scale = None if unit is None else in_metres(1.0, unit)
        if unit is not None and scale is None:
            raise SurfaceError(
                f"{path}: {shown(name, 80)} is in {shown(str(unit), 20)}, which is not a unit of "
                "length; correct its unit and export the container again"
            )
        size = told.get("size") or ()
        instrument = told.get("instrument")
        known = instrument.get("parameters") if isinstance(instrument, dict) else None
        parameters = known if isinstance(known, dict) else {}
        yield ContainedScan(
            name,
            str(member),
            told.get("data_source"),
            tuple(float(edge) * (scale or 1.0) for edge in size) if scale else (),
            unit,
            float(told.get("height_scale", 1.0)),
            _length(parameters.get("tip_radius")),
            _length(parameters.get("resolution")),
        )


def _length(told: Any) -> float:
    if not isinstance(told, dict) or "value" not in told:
        return 0.0
    return in_metres(float(told["value"]), told.get("unit")) or 0.0
