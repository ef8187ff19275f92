"""Check the environment in advance, because wrong settings would make a command fail halfway."""

from __future__ import annotations

import os
from collections.abc import Sequence

from restitution.errors import CaseError, shown

_THREADS = ("DUCC0_NUM_THREADS", "OMP_NUM_THREADS")  # the first variable that is set is used


def prepare(arguments: Sequence[str]) -> None:
    """Check the arguments of the command line and the variables that libraries read.

    Raises `CaseError` for an invalid number of threads, and for a path that is not UTF-8, which the
    netCDF library requires.
    """
    # Select the matplotlib backend that writes files, because the user may have set an interactive
    # backend.
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
                f"{shown(path, 200)}: the name is not UTF-8, which netCDF requires; rename it"
            ) from None


def _check_threads() -> None:
    name = next((name for name in _THREADS if name in os.environ), _THREADS[0])
    text = os.environ.get(name, "")
    if not text.strip():
        os.environ.pop(name, None)
        return
    # OpenMP accepts a list of numbers of threads; the first is for the outermost parallel level.
    first = text.split(",")[0].strip() if name == "OMP_NUM_THREADS" else text.strip()
    if not (first.isascii() and first.isdigit() and len(first) < 10):
        raise CaseError(
            f"{name}: {shown(text)} is not a number of threads; set it to a whole number from 1, "
            "or unset it"
        )
    os.environ["DUCC0_NUM_THREADS"] = first
