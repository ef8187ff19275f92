"""Solved patches, in memory and in the user's cache folder, by the content of what they depend on.

A file that cannot be written or read causes no error; the patch is then solved again.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Callable, Mapping
from contextlib import suppress
from functools import lru_cache
from importlib.metadata import version
from pathlib import Path
from tempfile import NamedTemporaryFile

import numpy as np

from restitution.contact.bodies import Pair
from restitution.contact.state import Array
from restitution.surfaces import Surface

Columns = Mapping[str, Array]

_FORMAT = 3  # number of the form of the columns
_MOST = 400  # files
_IN_MEMORY = 256
_known: dict[str, Columns] = {}


def kept(patch: Surface, models: object, solve: Callable[[], Columns]) -> Columns:
    """Columns of `patch` between bodies with `models`, whose `repr` names all values."""
    key = _key(patch, repr(models))
    if key in _known:
        return _known[key]
    file = _folder() / f"{key}.npz"
    columns = _read(file)
    if columns is None:
        columns = solve()
        _write(file, columns)
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
    key = _key(patch, repr(models))
    return key in _known or (_folder() / f"{key}.npz").exists()


def _key(patch: Surface, models: str) -> str:
    told = f"{version('restitution')} {_FORMAT} {patch.grid.spacing} {models} {_heights(patch)}"
    return hashlib.sha256(told.encode()).hexdigest()


@lru_cache(maxsize=64)
def _heights(patch: Surface) -> str:
    return hashlib.sha256(np.ascontiguousarray(patch.height).tobytes()).hexdigest()


def _folder() -> Path:
    from platformdirs import user_cache_path

    return user_cache_path("restitution", appauthor=False) / "patches"


def _read(file: Path) -> Columns | None:
    # NumPy can raise any exception for a damaged file.
    with suppress(Exception):
        with file.open("rb") as stream, np.load(stream, allow_pickle=False) as content:
            columns = {name: np.asarray(content[name], np.float64) for name in content.files}
        os.utime(file)  # the modification time records the last use
        return columns
    return None


def _write(file: Path, columns: Columns) -> None:
    with suppress(OSError, TypeError, ValueError):
        file.parent.mkdir(parents=True, exist_ok=True)
        _free_space(file.parent)
        with NamedTemporaryFile(dir=file.parent, suffix=".part", delete=False) as stream:
            try:
                np.savez(stream, **dict(columns))  # type: ignore[arg-type]
                stream.close()
                os.replace(stream.name, file)
            except BaseException:
                Path(stream.name).unlink(missing_ok=True)
                raise


def _free_space(folder: Path) -> None:
    files = sorted((entry.stat().st_mtime, entry) for entry in folder.iterdir() if entry.is_file())
    oldest = {entry for _, entry in files[: max(len(files) - _MOST, 0)]}
    for used, entry in files:
        abandoned = entry.suffix == ".part" and used < time.time() - 3600
        if abandoned or entry in oldest:
            entry.unlink(missing_ok=True)
