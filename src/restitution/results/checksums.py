"""SHA-256 checksums of the files of a folder, in `SHA256SUMS`; without it, nothing is checked."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from pathlib import Path

from restitution.errors import OutputError

CHECKSUMS = "SHA256SUMS"


def checksums(folder: Path, names: Sequence[str]) -> str:
    return "".join(f"{_checksum(folder / name)}  {name}\n" for name in names)


def check_file(path: Path) -> None:
    """Raise `OutputError` if the file `path` does not match its checksum."""
    known = _known(path.parent)
    try:
        damaged = path.name in known and known[path.name] != _checksum(path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be read ({error.strerror})") from None
    if damaged:
        raise OutputError(
            f"{path}: is damaged, or was edited (its checksum differs from {CHECKSUMS}); run "
            "the computation again"
        )


def _known(folder: Path) -> dict[str, str]:
    path = folder / CHECKSUMS
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        return {name: checksum for checksum, name in (line.split("  ", 1) for line in lines)}
    except (FileNotFoundError, NotADirectoryError):
        return {}
    except (OSError, ValueError):
        raise OutputError(
            f"{path}: is damaged; compute the results again, or remove this file to read the "
            "results unchecked"
        ) from None


def _checksum(path: Path) -> str:
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
