"""Cache of surfaces that took long to make, in the user's cache folder.

A key lists everything on which the surface depends, the version of this package included. A file
that cannot be written or read causes no error; the surface is made again when it is needed.
"""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from importlib.metadata import version
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np

from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface

_LONG = 1.0  # surfaces that take less time (s) to make are not cached
_MOST = 2**30  # largest total size of all files (bytes)
_LARGEST = 2**28  # a surface whose heights take more memory (bytes) is not cached
_REST = 2**12  # estimated largest size of a file without its heights (bytes)


def kept(parameters: Mapping[str, Any], make: Callable[[], Surface]) -> Surface:
    """Surface of `parameters` (JSON types) from the cache; else `make` it, and cache it if slow."""
    key = json.dumps({"version": version("restitution"), **parameters}, sort_keys=True)
    file = _folder() / f"{hashlib.sha256(key.encode()).hexdigest()}.npz"
    if (cached := _read(file, key)) is not None:
        return cached
    began = time.perf_counter()
    surface = make()
    if time.perf_counter() - began > _LONG and surface.height.nbytes <= _LARGEST:
        _write(file, key, surface)
    return surface


def _folder() -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("restitution", appauthor=False) / "surfaces"


def _read(file: Path, key: str) -> Surface | None:
    # NumPy can raise any exception for a damaged file. The surface is then made again.
    with suppress(Exception):
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as content:
            told = json.loads(str(content["told"]))
            if told["key"] != key:
                return None
            grid = Grid(told["nodes"], told["spacing"])
            surface = Surface(np.asarray(content["height"], np.float64), grid, told["provenance"])
        os.utime(file)  # the modification time records the last use
        return surface
    return None


def _write(file: Path, key: str, surface: Surface) -> None:
    told = {
        "key": key,
        "nodes": surface.grid.nodes,
        "spacing": surface.grid.spacing,
        "provenance": dict(surface.provenance),
    }
    with suppress(OSError, TypeError, ValueError):
        file.parent.mkdir(parents=True, exist_ok=True)
        _free_space(file.parent, surface.height.nbytes + _REST)
        with NamedTemporaryFile(dir=file.parent, suffix=".part", delete=False) as stream:
            try:
                np.savez(stream, height=surface.height, told=np.array(json.dumps(told)))
                stream.close()
                os.replace(stream.name, file)
            except BaseException:
                Path(stream.name).unlink(missing_ok=True)
                raise


def _free_space(folder: Path, size: int) -> None:
    files = [(entry.stat(), entry) for entry in folder.iterdir() if entry.is_file()]
    total = size + sum(stat.st_size for stat, _ in files)
    for stat, entry in sorted(files, key=lambda item: item[0].st_mtime):
        abandoned = entry.suffix == ".part" and stat.st_mtime < time.time() - 3600
        if total > _MOST or abandoned:
            entry.unlink(missing_ok=True)
            total -= stat.st_size
