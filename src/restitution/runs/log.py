"""How a run goes and ends: its progress, its warnings, its status and the reason of it."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from restitution.errors import RestitutionError, one_line
from restitution.results.interruption import hold_signals
from restitution.results.writer import ResultsFolder

Say = Callable[[str], None]


def ignore(_: str) -> None:
    """Say nothing."""


@dataclass
class RunLog:
    """The log of one run, or of several of one case.

    `progress` is called with a few words after every step, `tell` with every warning. `warnings`
    are those that belong to the results and need not be told at the end.
    """

    progress: Say = ignore
    tell: Say = ignore
    warnings: list[str] = field(default_factory=list)
    status: str = "failed"
    reason: str = "stopped by an unforeseen error"
    began: float = field(default_factory=time.perf_counter)
    summary: dict[str, Any] | None = None

    @property
    def seconds(self) -> float:
        """Since it began."""
        return round(time.perf_counter() - self.began, 3)

    def warn(self, warning: str) -> None:
        """Tell a warning, which belongs to the results."""
        self.warnings.append(warning)
        self.tell(warning)

    def progress_of(self, name: str) -> Say:
        """The progress of one of several runs."""
        return lambda words: self.progress(f"{name}, {words}")

    def warnings_of(self, part: ResultsFolder) -> Say:
        """The warnings of one of several runs: what is foreseen of it.

        What its results show is for the whole of the runs to say.
        """

        def say(warning: str) -> None:
            if not part.rows:
                self.warn(warning)

        return say

    @contextmanager
    def record(
        self, out: ResultsFolder, keep: Callable[[], dict[str, Any] | None]
    ) -> Iterator[None]:
        """Note how the body of a `with` ends, let `keep` write what there is, tell its warnings.

        `keep` returns the summary, which is `summary` from then on, or None where nothing was
        computed: then the folder is taken back. Whatever stops the body is raised again.
        """
        try:
            yield
            self.status, self.reason = "complete", ""
        except KeyboardInterrupt:
            self.status, self.reason = "interrupted", "stopped by the user"
            raise
        except RestitutionError as error:
            self.reason = str(error)
            raise
        except Exception as error:
            self.reason = one_line(f"{self.reason}: {type(error).__name__} {error}".strip())
            raise
        finally:
            with hold_signals():  # what was computed is not lost to an interruption just now
                self.summary = keep()
                if self.summary is None:
                    out.discard()
            for warning in self.summary["warnings"] if self.summary else ():
                if warning not in self.warnings:
                    self.tell(warning)
