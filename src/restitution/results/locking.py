"""Lock a results folder against other processes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from filelock import FileLock, Timeout

from restitution.errors import OutputError
from restitution.results.interruption import hold_signals
from restitution.results.schema import LOCK
from restitution.results.writer import writing


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Make `folder`, and lock it against other processes during the `with` body.

    At the end, the lock file is removed, and the folder if it is new and still empty.
    """
    lock = FileLock(folder / LOCK)
    with writing(folder):
        new = not folder.exists()
        folder.mkdir(parents=True, exist_ok=True)
        try:
            lock.acquire(blocking=False)
        except Timeout:
            raise OutputError(
                f"{folder}: another process is writing to this folder; wait for it or stop it, or "
                "name another folder with -o"
            ) from None
    try:
        yield
    finally:
        with hold_signals():
            # Remove the lock file while this process holds the lock. No other process can lock the
            # removed file, because filelock checks that the file still exists.
            with suppress(OSError):
                (folder / LOCK).unlink()
            lock.release()
            if new:
                with suppress(OSError):  # the folder may hold results
                    folder.rmdir()
