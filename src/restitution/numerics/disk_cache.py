"""Arrays that took long to compute, in files of the user's cache folder.

A file that cannot be written or read causes no error; its arrays are computed again.
"""

from __future__ import annotations

import hashlib
import os
import time
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

import numpy as np
from numpy.typing import NDArray

Arrays = Mapping[str, NDArray[Any]]

_ABANDONED = 3600  # age (s) of a file that another process no longer writes


@dataclass(frozen=True)
class StoredArrays:
    """Named arrays by keys that list everything on which they depend.

    Attributes:
        name: Folder in the user's cache folder.
        most: Largest total size of its files (bytes); those that were not used for longest go.
    """

    name: str
    most: int

    @property
    def folder(self) -> Path:
        from platformdirs import user_cache_path

        return user_cache_path("restitution", appauthor=False) / self.name

    def has(self, key: str) -> bool:
        return self._file(key).exists()

    def read(self, key: str) -> Arrays | None:
        """The arrays of `key`; None if there are none, or their file is damaged."""
        file = self._file(key)
        # NumPy can raise any exception for a damaged file.
        with suppress(Exception):
            with file.open("rb") as stream, np.load(stream, allow_pickle=False) as content:
                arrays = {name: content[name] for name in content.files}
            os.utime(file)  # the modification time records the last use
            return arrays
        return None

    def write(self, key: str, arrays: Arrays) -> None:
        with suppress(OSError, TypeError, ValueError):
            self.folder.mkdir(parents=True, exist_ok=True)
            with NamedTemporaryFile(dir=self.folder, suffix=".part", delete=False) as stream:
                new = Path(stream.name)
                try:
                    np.savez(stream, **dict(arrays))  # type: ignore[arg-type]
                    stream.close()
                    self._free_space(new)
                    os.replace(new, self._file(key))
                except BaseException:
                    new.unlink(missing_ok=True)
                    raise

    def _file(self, key: str) -> Path:
        return self.folder / f"{hashlib.sha256(key.encode()).hexdigest()}.npz"

    def _free_space(self, new: Path) -> None:
        files = [(entry.stat(), entry) for entry in self.folder.iterdir() if entry.is_file()]
        total = sum(stat.st_size for stat, _ in files)
        for stat, entry in sorted(files, key=lambda item: item[0].st_mtime):
            abandoned = entry.suffix == ".part" and stat.st_mtime < time.time() - _ABANDONED
            if entry != new and (total > self.most or abandoned):
                entry.unlink(missing_ok=True)
                total -= stat.st_size
