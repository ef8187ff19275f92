"""Solved patches, in memory and in files, by the content of what they depend on."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from functools import lru_cache
from importlib.metadata import version

import numpy as np

from restitution.contact.bodies import Pair
from restitution.contact.state import Array
from restitution.numerics.disk_cache import StoredArrays
from restitution.surfaces import Surface

Columns = Mapping[str, Array]

_FORMAT = 5  # number of the form of the columns, and of the solver that they are from
_FILES = StoredArrays("patches", most=2**24)  # thousands of patches
_IN_MEMORY = 256
_known: dict[str, Columns] = {}


def kept(patch: Surface, models: object, solve: Callable[[], Columns]) -> Columns:
    """Columns of `patch` between bodies with `models`, whose `repr` names all values."""
    key = _key(patch, models)
    if key in _known:
        return _known[key]
    columns = _FILES.read(key)
    if columns is None:
        columns = solve()
        _FILES.write(key, columns)
    while len(_known) >= _IN_MEMORY:
        del _known[next(iter(_known))]
    _known[key] = columns
    return columns


def bodies_in_words(pair: Pair) -> tuple[float, ...]:
    """The numbers of `pair` on which a patch depends."""
    nu = tuple(body.poissons_ratio for body in (pair.first, pair.second))
    return pair.contact_modulus, *nu


def is_kept(patch: Surface, models: object) -> bool:
    """Whether `kept` need not solve."""
    key = _key(patch, models)
    return key in _known or _FILES.has(key)


def _key(patch: Surface, models: object) -> str:
    return f"{version('restitution')} {_FORMAT} {patch.grid.spacing} {models!r} {_heights(patch)}"


@lru_cache(maxsize=64)
def _heights(patch: Surface) -> str:
    return hashlib.sha256(np.ascontiguousarray(patch.height).tobytes()).hexdigest()
