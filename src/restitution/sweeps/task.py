"""One case of a study, computed by whatever process is given it."""

from __future__ import annotations

import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from restitution.errors import OutputError, RestitutionError, one_line


class Channel(Protocol):
    """Where a worker puts what it has to say of its progress."""

    def put(self, message: tuple[int, int], /) -> object:
        """Take (number of the case, depths done)."""


@dataclass(frozen=True)
class Outcome:
    """What has come of a case: the files of its results folder, or why there are none.

    `reason` is empty when it is complete. Files of a case that failed half way are there, too.
    """

    files: dict[str, bytes]
    reason: str


def compute(text: str, folder: str, number: int, threads: int, channel: Channel | None) -> Outcome:
    """Run the case of `text`, with files relative to `folder`, in this process.

    Nothing of the study's folder is touched: results travel back, so that workers need not share a
    disk with it, and so that one process alone writes.
    """
    # Read once, before the first transform of a process.
    os.environ.setdefault("DUCC0_NUM_THREADS", str(threads))
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.ensemble import run_realisations

    done, reason = 0, ""

    def progress(_: str) -> None:
        nonlocal done
        done += 1
        if channel is not None:
            channel.put((number, done))

    with tempfile.TemporaryDirectory(prefix="restitution-") as temporary:
        out = Path(temporary) / "case"
        try:
            run_realisations(parse_case(text), text, Path(folder), ResultsFolder(out), progress)
        except OutputError:
            raise
        except RestitutionError as error:
            reason = one_line(str(error))
        except MemoryError:
            reason = "the memory is too small for this case; use fewer grid.nodes"
        files = {
            path.relative_to(out).as_posix(): path.read_bytes()
            for path in sorted(out.rglob("*"))
            if path.is_file()
        }
    return Outcome(files, reason)
