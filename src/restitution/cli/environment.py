"""Check the environment in advance, because wrong settings would make a command fail halfway."""

from __future__ import annotations

import os
from collections.abc import Sequence

from restitution.errors import CaseError, shown

# Environment variables for the number of threads. The first variable that is set is used.
_THREADS = ("DUCC0_NUM_THREADS", "OMP_NUM_THREADS")


def prepare(arguments: Sequence[str]) -> None:
    """Check the current folder, the arguments of the command line and environment variables.

    Raises `CaseError` if the number of threads is invalid, if the current folder was removed, or if
    a path is not UTF-8. The netCDF library requires UTF-8.
    """
    # Select a matplotlib backend that writes files, because the environment may select an
    # interactive one.
    os.environ["MPLBACKEND"] = "agg"
    _check_threads()
    try:
        current = os.getcwd()
    except OSError:
        raise CaseError("the current folder was removed; change to another folder") from None
    for path in (*arguments, current):
        try:
            path.encode()
        except UnicodeEncodeError:
            raise CaseError(
                f"{shown(path, 200)}: the name is not UTF-8, but netCDF requires UTF-8; rename it"
            ) from None


def _check_threads() -> None:
    name = next((name for name in _THREADS if name in os.environ), _THREADS[0])
    text = os.environ.get(name, "")
    if not text.strip():
        os.environ.pop(name, None)
        return
    # OMP_NUM_THREADS may be a list of numbers, one for each level of nested parallelism. The first
    # number is for the outermost level.
    first = text.split(",")[0].strip() if name == "OMP_NUM_THREADS" else text.strip()
    if not (first.isascii() and first.isdigit() and len(first) < 10):
        raise CaseError(
            f"{name}: {shown(text)} is not a number of threads; set the variable to a whole number "
            "of at least 1, or unset it"
        )
    os.environ["DUCC0_NUM_THREADS"] = first
