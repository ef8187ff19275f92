"""Read one stored file, and compare it with its checksum."""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from restitution.errors import OutputError
from restitution.results.checksums import check_file
from restitution.results.coordinates import with_coordinates
from restitution.results.interruption import hold_signals
from restitution.results.tables import damaged, reading


def stored_file(folder: Path | None, name: str) -> Path:
    """The file `name` in `folder`. Raises `OutputError` for results in memory (None)."""
    if folder is None:
        raise OutputError(f"{name}: is not stored; give `run` a folder (out=…) to keep it")
    return folder / name


def read_text(path: Path) -> str:
    with reading(path):
        text = path.read_text(encoding="utf-8")
    check_file(path)
    return text


def read_json(path: Path) -> dict[str, Any]:
    with reading(path):
        content = json.loads(read_text(path))
    if not isinstance(content, dict):
        raise damaged(path, "it is not a JSON object")
    return content


def read_netcdf(path: Path) -> xr.Dataset:
    with opened(path) as stored:
        return stored.load()


def read_maps(folder: Path) -> xr.Dataset:
    path = folder / "maps.nc"
    if (folder / "results.nc").is_file() and not path.is_file():
        raise OutputError(
            f'{folder}: holds maps of the deepest depth only; write maps = "all" at the top of the '
            "case file, and run it again"
        )
    return with_coordinates(read_netcdf(path))


@contextmanager
def opened(path: Path) -> Iterator[xr.Dataset]:
    """Open a netCDF file, and delay signals, which could leave the netCDF library locked."""
    with reading(path):
        # Raise errors of the operating system here, because the netCDF library would hide them.
        open(path, "rb").close()
    check_file(path)
    try:
        with hold_signals(), xr.open_dataset(path, engine="netcdf4") as stored:
            yield stored
    except MemoryError:
        raise
    except Exception as error:  # a damaged file may cause any exception
        raise damaged(path, f"{type(error).__name__}: {error}") from None
