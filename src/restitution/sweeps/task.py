"""Compute one case of a study, in the main process or in a worker process."""

from __future__ import annotations

import itertools
import os
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from restitution.errors import OutputError, RestitutionError, one_line


class Channel(Protocol):
    """A channel for the messages of a worker about its progress."""

    def put(self, message: tuple[int, int], /) -> object:
        """Send a message: the number of the case, and the number of depths done."""


@dataclass(frozen=True)
class Outcome:
    """The outcome of a case: the files of its results folder, and the reason if it failed.

    `reason` is empty if the case is complete. A failed case has only the files that were written
    before the failure.
    """

    files: dict[str, bytes]
    reason: str


def compute(text: str, folder: str, number: int, threads: int, channel: Channel) -> Outcome:
    """Run the case file `text` in this process; paths in it are relative to `folder`.

    Results are returned, not written to the folder of the study. So workers need no shared disk,
    and only the main process writes to the folder of the study.
    """
    # DUCC0 reads this variable only once per process, before its first transform.
    os.environ.setdefault("DUCC0_NUM_THREADS", str(threads))
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.ensemble import run_realisations

    depths, reason = itertools.count(1), ""

    def progress(_: str) -> None:
        channel.put((number, next(depths)))

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
