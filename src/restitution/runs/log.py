"""The log of a run: progress, warnings, and how the run ended."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from restitution.errors import RestitutionError, one_line
from restitution.results.interruption import hold_signals
from restitution.results.writer import ResultsFolder

if TYPE_CHECKING:
    from restitution.runs.material_advice import MaterialPart

Say = Callable[[str], None]


def ignore(_: str) -> None:
    """Ignore a message."""


@dataclass
class RunLog:
    """The log of one run, or of several runs of one case.

    `progress` is called with a few words after every step, and `tell` with every warning.
    `warnings` holds the warnings so far, which are stored with the results. `material_parts` holds
    the contributions of library values to the material error. `status` and `reason` say how the run
    ended.
    """

    progress: Say = ignore
    tell: Say = ignore
    warnings: list[str] = field(default_factory=list)
    material_parts: list[MaterialPart] = field(default_factory=list)
    status: str = "failed"
    reason: str = "stopped by an unexpected error"
    began: float = field(default_factory=time.perf_counter)
    summary: dict[str, Any] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Time since the start (s)."""
        return round(time.perf_counter() - self.began, 3)

    def warn(self, warning: str) -> None:
        """Issue a warning, and store it with the results."""
        self.warnings.append(warning)
        self.tell(warning)

    def progress_of(self, name: str) -> Say:
        """Return a `progress` function for one of several runs.

        The function puts the `name` of the run before each message.
        """
        return lambda words: self.progress(f"{name}, {words}")

    def warnings_of(self, part: ResultsFolder) -> Say:
        """Return a `warn` function for one of several runs.

        The function passes on the warnings about the input, that is, those issued before the run
        has its first result. It drops later warnings, because the summary of all runs replaces
        them.
        """

        def say(warning: str) -> None:
            if not part.rows:
                self.warn(warning)

        return say

    @contextmanager
    def record(self, out: ResultsFolder, keep: Callable[[], dict[str, Any]]) -> Iterator[None]:
        """Record how the `with` body ends, and let `keep` write the results.

        `keep` returns the summary. It is stored in the attribute `summary`, and the warnings in it
        are issued. If nothing was computed, the summary is empty and the folder is removed. Errors
        of the body are raised again.
        """
        try:
            yield
            self.status, self.reason = "complete", ""
        except KeyboardInterrupt:
            self.status, self.reason = "interrupted", "stopped by the user"
            raise
        except Exception as error:
            bug = f"{self.reason}: {type(error).__name__} {error}".strip()
            self.reason = str(error) if isinstance(error, RestitutionError) else one_line(bug)
            raise
        finally:
            with hold_signals():  # do not lose results if Ctrl-C arrives while writing
                self.summary = keep()
                if not self.summary:
                    out.discard()
            for warning in self.summary.get("warnings", ()):
                if warning not in self.warnings:
                    self.tell(warning)
