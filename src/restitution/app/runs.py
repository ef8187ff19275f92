"""Runs and convergence studies of the page, as of `run` and `converge`, but without figures."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Callable
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

from restitution.app.figures import as_json, curve_figures, drawing
from restitution.app.headline import headline
from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.case.omissions import default_yield
from restitution.errors import RestitutionError
from restitution.plots.run_in import run_in_figure
from restitution.results.reader import RunResults, read_run
from restitution.results.writer import ResultsFolder
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.runs.error_budget import steps

_KEPT = 4  # largest number of results folders that are kept
_COMPANION, _PATHS = 0.2, 3  # time of a depth of a companion curve, and its most adhesive depths
Check = Callable[[str], None]  # called with the progress; raises if the run is no longer wanted


class Progress:
    """How much of a run is done, from the words that it reports.

    A depth counts 1, and a companion curve of the total error the share of its time.
    """

    def __init__(self, case: Case, grids: int) -> None:
        depths = len(case.depths())
        self._companion = _COMPANION * (
            min(depths, _PATHS) if case.interface.adhesive_energy else depths
        )
        self._all = depths * case.realisations + self._companion * steps(case)
        self._done, self._known = 0.0, grids == 1 and case.impacts is None

    def after(self, words: str) -> float | None:
        """The share that is done when `words` are reported; None if the steps are not known.

        A depth is reported at its end, and a companion curve at its beginning.
        """
        if not self._known:
            return None
        begins = words.startswith("error")
        share = (self._done if begins else self._done + 1.0) / self._all
        self._done += self._companion if begins else 1.0
        return min(share, 1.0)


class Runs:
    """The newest `_KEPT` runs of the page; their results lie in the folder `room`."""

    def __init__(self, room: Path) -> None:
        self._room = room
        self._folders: dict[str, Path] = {}

    def folder(self, text: str, folder: Path, check: Check, grids: int = 1) -> Path:
        """The results of the case `text` or, if `grids` > 1, of its convergence study.

        The scans of the case are in `folder`.
        """
        key = hashlib.blake2b(f"{grids}\n{text}".encode()).hexdigest()
        if key not in self._folders:
            self._folders[key] = self._compute(text, folder, check, grids)
            if len(self._folders) > _KEPT:
                shutil.rmtree(self._folders.pop(next(iter(self._folders))), ignore_errors=True)
        return self._folders[key]

    def _compute(self, text: str, folder: Path, check: Check, grids: int) -> Path:
        out = Path(mkdtemp(dir=self._room, prefix="results-"))
        case = parse_case(text)
        try:
            if grids == 1:
                run_realisations(case, text, folder, ResultsFolder(out), check)
            else:
                run_convergence(case, text, folder, ResultsFolder(out), grids, check)
        except BaseException as error:
            # After an error that the user can fix, keep the results of the depths computed so far.
            if not (isinstance(error, RestitutionError) and (out / "results.nc").is_file()):
                shutil.rmtree(out, ignore_errors=True)
                raise
        return out


def results_line(out: Path) -> str:
    """Return the figures, rows and warnings of the results in `out` as a line of JSON."""
    run = read_run(out)
    summary = run.summary
    return as_json(
        {
            "results": run.curve.rows,
            "figures": curve_figures(run.dataset),
            **headline(run.curve.points, summary.get("sticking")),
            "information": default_yield(summary["model"]["yield_pressure"]),
            "warnings": summary["warnings"],
            "failure": "" if summary["status"] == "complete" else summary["reason"],
            "seconds": summary["seconds"],
            "grids": summary.get("grids", []),
            "includes": summary["diagnostics"].get("total_error_includes", ""),
            **_worn(run),
        }
    )


def _worn(run: RunResults) -> dict[str, Any]:
    """The figure and the rows of a run with many impacts."""
    if not run.run_in:
        return {}
    return {
        "worn": [point.cells() for point in run.run_in],
        "worn_figure": drawing(run_in_figure(run.run_in)),
    }
