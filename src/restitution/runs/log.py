"""The log of a run: progress, warnings, and how the run ended."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from restitution.errors import RestitutionError, one_line
from restitution.numerics.convolution.device import current
from restitution.numerics.kernels import instruction_set
from restitution.results.interruption import hold_signals
from restitution.results.writer import ResultsFolder

if TYPE_CHECKING:
    from restitution.case.case import Case
    from restitution.curve.periodic import PeriodicPoint
    from restitution.curve.point import Point
    from restitution.runs.material_advice import MaterialPart

Say = Callable[[str], None]


def ignore(_: str) -> None: ...


def solved_with(points: Sequence[Point | PeriodicPoint]) -> dict[str, Any]:
    """The entries of `summary.json` about the solver."""
    return {
        "device": current().name,
        "kernels": instruction_set,
        "convolutions": sum(int(point.convolutions) for point in points),
    }


@dataclass
class RunLog:
    """The log of one run, or of several runs of one case.

    `progress` is called with a few words after every step, and `tell` with every warning.
    `warnings` and `material_parts` (contributions of library values to the material error) are
    stored with the results; `status` and `reason` say how the run ended.
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

    def head(self, case: Case) -> dict[str, str]:
        """The entries of `summary.json` that say how the run ended."""
        return {"title": case.title, "status": self.status, "reason": self.reason}

    def warn(self, warning: str) -> None:
        self.warnings.append(warning)
        self.tell(warning)

    def progress_of(self, name: str) -> Say:
        """Return a `progress` that puts `name`, one of several runs, before each message."""
        return lambda words: self.progress(f"{name}, {words}")

    def warnings_of(self, part: ResultsFolder) -> Say:
        """Return a `warn` that passes on the warnings before the first result of `part`.

        Later warnings are dropped, because the summary of all runs replaces them.
        """

        def say(warning: str) -> None:
            if not part.rows:
                self.warn(warning)

        return say

    @contextmanager
    def record(self, out: ResultsFolder, keep: Callable[[], dict[str, Any]]) -> Iterator[None]:
        """Record how the `with` body ends, and let `keep` write the results and return the summary.

        The warnings in the summary are issued. If it is empty, the folder is removed.
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
