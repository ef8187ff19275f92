"""Find out which kind of results a folder holds."""

from __future__ import annotations

from pathlib import Path

from restitution.errors import OutputError

PERIODIC_FILE = "periodic.csv"  # the curve of a periodic contact, instead of curve.csv


def is_periodic(folder: Path) -> bool:
    """Whether `folder` holds the results of a periodic contact."""
    return (folder / PERIODIC_FILE).is_file()


def require_restitution(folder: Path) -> None:
    """Raise `OutputError` if `folder` holds a periodic contact, which has no restitution."""
    if is_periodic(folder):
        raise OutputError(
            f"{folder}: holds the results of a periodic contact, which has no restitution; read "
            f"{PERIODIC_FILE} and results.nc"
        )
