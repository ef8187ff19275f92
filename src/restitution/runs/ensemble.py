"""One case on several surfaces with the same statistics: mean curve and confidence interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.contact.checks.resolution import unresolved_patches
from restitution.errors import RestitutionError
from restitution.results.reader import RunResults
from restitution.results.schema import COLUMNS
from restitution.results.total_error import largest, total
from restitution.results.writer import (
    ResultsFolder,
    curve_variables,
    oblique_variables,
    status_attributes,
    write_table,
)
from restitution.runs.attraction import Sticking, mean_of, stored, summary_of, with_errors
from restitution.runs.companions import CONFIDENCE, Companions, half_interval
from restitution.runs.error_budget import (
    MISSING_BAND,
    Row,
    add_errors,
    interrupted_errors,
    total_error_summary,
)
from restitution.runs.log import RunLog, Say, ignore
from restitution.runs.messages import message
from restitution.runs.oblique import mean_oblique
from restitution.runs.periodic import run_periodic
from restitution.runs.refinement import settled
from restitution.runs.result_warnings import too_coarse_for_adhesion
from restitution.runs.run import run_case

# Columns that combine only surfaces on which an impact has this maximum indentation.
_OF_IMPACTS = (
    "restitution",
    "impact_velocity_m_per_s",
    "restitution_error",
    "model_error",
    "sticks",
)
# Columns of an ensemble's curve that are not means, and the functions that combine the values of
# the surfaces. Flags are not listed: they are true if they are true for all surfaces.
_WORST: dict[str, Callable[[list[float]], float]] = {
    "adhesive_spacing_m": min,
    "residual": max,
    "model_error": max,
    "median_patch_nodes": min,
    "convolutions": sum,
    "refine": max,
}


def run_realisations(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    progress: Say = ignore,
    warn: Say = ignore,
) -> dict[str, Any]:
    """Run `case` on each of its surfaces, and return the summary.

    A periodic case is run by `run_periodic`. A single surface is run by `run_case` alone. If there
    are several surfaces, the run on surface n (n = 1, 2, …) is stored in a folder
    `realisation-<n>`, and the curve of `out` contains the means (`mean_rows`). The seed of
    surface n is the seed of the case plus n − 1. For a scan without a seed, `place` (the part of
    the scan that is used) increases in the same way. If the run on a surface fails, its error is
    recorded and the other runs continue. If all runs fail, the first error is raised. If the first
    surface cannot be made, for example because the scan is missing, no run starts. With
    `grid.refine = "auto"`, the first surface decides the grid of each depth for all surfaces
    (`refinement`).
    """
    if case.periodic:
        return run_periodic(case, text, folder, out, progress, warn)
    if case.realisations == 1:
        return run_case(case, text, folder, out, progress, warn)
    ensemble = _Ensemble(case, text, folder, out, RunLog(progress, warn))
    with ensemble.log.record(out, ensemble.keep):
        ensemble.compute()
    if not ensemble.log.summary:
        raise ensemble.failures[0]
    return ensemble.log.summary


class _Ensemble:
    """The results of an ensemble so far."""

    def __init__(
        self, case: Case, text: str, folder: Path, out: ResultsFolder, log: RunLog
    ) -> None:
        self.case, self.text, self.folder, self.out, self.log = case, text, folder, out, log
        self.curves: dict[int, list[Row]] = {}
        self.oblique: list[list[Row]] = []
        self.failures: list[RestitutionError] = []
        self.ended: list[dict[str, Any]] = []
        self.errors: list[Row] = []
        self.band_errors: list[float] = []
        self.sticking: dict[int, Sticking] = {}
        self.one_sticking: Sticking | None = None  # with the errors of grid and materials

    def compute(self) -> None:
        """Run the case on every surface, and estimate the errors due to grid and materials."""
        self.case.realisation(0).surface(self.folder)  # end here if the scan cannot be read
        self.case = settled(self.case, self.folder, self.log.warn)
        for number in range(self.case.realisations):
            self._run(number)
        self._add_errors()

    def _run(self, number: int) -> None:
        name = f"realisation {number + 1} of {self.case.realisations}"
        case = self.case.realisation(number)
        title = f"{case.title}, {name}" if case.title else name
        part = ResultsFolder(self.out.path / f"realisation-{number + 1}")
        reason = ""
        try:
            # Most input warnings are the same for all surfaces, so only those of the first
            # surface are passed on.
            summary = run_case(
                case.model_copy(update={"title": title}),
                self.text,
                self.folder,
                part,
                progress=self.log.progress_of(name),
                warn=ignore if number else self.log.warnings_of(part),
                errors=False,
            )
            if (pair := stored(summary["sticking"])) is not None:
                self.sticking[number] = pair
        except RestitutionError as error:
            self.failures.append(error)
            reason = str(error)
            self.log.tell(f"{name}: {reason}")
        except KeyboardInterrupt:
            reason = "stopped by the user"
            raise
        finally:
            if part.rows:
                self.curves[number] = part.rows
                self.oblique.append(part.oblique)
            self.ended.append(
                {"realisation": number + 1, "depths": len(part.rows), "reason": reason}
            )

    def _add_errors(self) -> None:
        """Estimate the errors due to grid and materials, on one surface.

        This is the surface whose curve has the largest number of depths. The scatter between
        surfaces follows from the ensemble itself.
        """
        if not self.curves or not self.case.total_error:
            return
        number = max(self.curves, key=lambda k: len(self.curves[k]))
        case, rows = self.case.realisation(number), self.curves[number]
        alone = [dict(row) for row in rows]
        made: dict[int, Companions] = {}
        try:
            self.band_errors = add_errors(
                case,
                self.folder,
                case.surface(self.folder),
                alone,
                self.log.progress,
                scattered=False,
                parts=self.log.material_parts,
                made=made,
            )
            if number in self.sticking:
                pair = self.sticking[number]
                self.one_sticking = with_errors(pair, made[max(made)], scattered=False)
        except RestitutionError as error:
            self.log.warn(f"total_error is unknown: {error}")
        self.errors = alone

    def keep(self) -> dict[str, Any]:
        """Write the curve of the ensemble, its summary and the table of all surfaces."""
        if not self.curves:
            return {}
        rows = mean_rows(list(self.curves.values()), self.errors)
        self.out.put_curve(rows)
        write_table(
            self.out.path / "realisations.csv",
            [{"realisation": k + 1, **row} for k, of in self.curves.items() for row in of],
        )
        one = RunResults(self.out.path / f"realisation-{min(self.curves) + 1}")
        summary = self._summary(one.summary)
        self.out.put_oblique(mean_oblique(self.oblique))
        dataset = one.smooth().assign(curve_variables(rows) | oblique_variables(self.out.oblique))
        dataset.attrs |= status_attributes(summary)
        self.out.write(dataset, summary)
        return summary

    def _summary(self, one: dict[str, Any]) -> dict[str, Any]:
        whole = [row for of in self.curves.values() for row in of]
        return {
            "title": self.case.title,
            "status": self.log.status,
            "reason": self.log.reason,
            "realisations_asked": self.case.realisations,
            "realisations": self.ended,
            "confidence": CONFIDENCE,
            "depths_asked": len(self.case.depths()),
            "depths_computed": len(self.out.rows),
            "warnings": [*self.log.warnings, *self._result_warnings(whole)],
            "sticking": summary_of(mean_of(list(self.sticking.values()), self.one_sticking)),
            **{
                key: one[key]
                for key in (
                    "model",
                    "materials",
                    "conventions",
                    "derived",
                    "device",
                    "kernels",
                    "versions",
                )
            },
            "diagnostics": {
                f"largest_{name}": largest(whole, name)
                for name in ("residual", "restitution_error")
            }
            | total_error_summary(self.case, self.out.rows, self.log.material_parts),
            "convolutions": sum(int(row["convolutions"]) for row in whole),
            "seconds": self.log.seconds,
        }

    def _result_warnings(self, whole: list[Row]) -> Iterator[str]:
        """Yield the warnings about the rows of all surfaces (`whole`) and about their means."""
        depths = [row["max_indentation_m"] for row in whole]
        patches = [row["median_patch_nodes"] for row in whole]
        yield from map(message, unresolved_patches(depths, patches))
        grid = self.case.realisation(0).contact(self.folder).grid
        yield from too_coarse_for_adhesion(self.case, grid, whole, self.log.seconds)
        yield from interrupted_errors(self.case, self.out.rows, self.log.status)
        fewest = min((row["realisations"] for row in self.out.rows), default=math.inf)
        if fewest < self.case.realisations:
            yield (
                f"some depths are means of only {fewest:.0f} of {self.case.realisations} surfaces "
                "(column realisations of curve.csv): the other runs ended earlier"
            )
        if lacking := sum(error > MISSING_BAND for error in self.band_errors):
            yield (
                f"{lacking} of {len(self.band_errors)} depths are not resolved: the grid leaves "
                "out waves of the scan that change COR; use a smaller grid.spacing or a larger "
                "grid.refine"
            )


def mean_rows(curves: Sequence[Sequence[Row]], errors: Sequence[Row] = ()) -> list[Row]:
    """Make the curve of an ensemble: for each depth, a row of means over the surfaces.

    A row is computed from the surfaces that reached its depth. Most columns are means over these
    surfaces. `residual`, `model_error` and `refine` are the largest values, `median_patch_nodes` is
    the smallest value and `convolutions` the sum. Flags are true if they are true for all of these
    surfaces. Additional columns are the number n of surfaces, the sample standard deviation s of
    COR, and the ends of the 95 % confidence interval of the mean COR. The interval is
    mean ± t s/√n with Student's t, clipped to [0, 1]. With one surface, s and the ends are NaN.

    `errors` are the rows of one surface. Their errors due to grid and materials are copied to the
    rows of the means. `surface_scatter` is half of the width of the confidence interval. If only
    one surface reached a depth, the total error of this depth stays unknown.
    """
    rows = []
    for depth in range(max(map(len, curves), default=0)):
        of = [curve[depth] for curve in curves if len(curve) > depth]
        # Surfaces on which an impact has this maximum indentation; all if there is none.
        met = [surface for surface in of if not math.isnan(surface["restitution"])] or of
        row: Row = {}
        for name, column in COLUMNS.items():
            values = [surface[name] for surface in (met if name in _OF_IMPACTS else of)]
            row[name] = all(values) if column.flag else float(_WORST.get(name, np.mean)(values))
        restitution = [surface["restitution"] for surface in met]
        n = len(met)
        std = _deviation(restitution)
        interval = half_interval(n) if n > 1 else math.nan
        half = interval * std
        half_pull_off = interval * _deviation([surface["pull_off_force_N"] for surface in met])
        row["realisations"] = len(of)
        row["restitution_std"] = std
        row["restitution_low"] = max(row["restitution"] - half, 0.0)
        row["restitution_high"] = min(row["restitution"] + half, 1.0)
        if depth < len(errors) and not math.isnan(errors[depth]["total_error"]):
            for name in ("discretisation_error", "material_error"):
                row[name] = errors[depth][name]
            row["resolved"] = bool(row["resolved"]) and bool(errors[depth]["resolved"])
            row["surface_scatter"] = half
            row["pull_off_error_N"] = math.hypot(errors[depth]["pull_off_error_N"], half_pull_off)
            if n > 1:
                row["total_error"] = total(row)
        rows.append(row)
    return rows


def _deviation(values: Sequence[float]) -> float:
    """Sample standard deviation; NaN for one value."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else math.nan
