"""Cache of surfaces that took long to make, in the user's cache folder.

A key lists everything on which the surface depends, the version of this package included.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from importlib.metadata import version
from typing import Any

import numpy as np

from restitution.numerics.disk_cache import StoredArrays
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface

_LONG = 1.0  # surfaces that take less time (s) to make are not cached
_LARGEST = 2**28  # a surface whose heights take more memory (bytes) is not cached
_FILES = StoredArrays("surfaces", most=2**30)


def kept(parameters: Mapping[str, Any], make: Callable[[], Surface]) -> Surface:
    """Surface of `parameters` (JSON types) from the cache; else `make` it, and cache it if slow."""
    key = json.dumps({"version": version("restitution"), **parameters}, sort_keys=True)
    if (cached := _read(key)) is not None:
        return cached
    began = time.perf_counter()
    surface = make()
    if time.perf_counter() - began > _LONG and surface.height.nbytes <= _LARGEST:
        _write(key, surface)
    return surface


def _read(key: str) -> Surface | None:
    arrays = _FILES.read(key)
    if arrays is None:
        return None
    told = json.loads(str(arrays["told"]))
    return Surface(arrays["height"], Grid(told["nodes"], told["spacing"]), told["provenance"])


def _write(key: str, surface: Surface) -> None:
    told = {
        "nodes": surface.grid.nodes,
        "spacing": surface.grid.spacing,
        "provenance": dict(surface.provenance),
    }
    _FILES.write(key, {"height": surface.height, "told": np.array(json.dumps(told))})
