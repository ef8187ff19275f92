"""One case on several surfaces with the same statistics: mean curve and confidence interval."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.curve.curve import largest
from restitution.curve.point import MeanPoint, Point
from restitution.errors import RestitutionError
from restitution.numerics.intervals import CONFIDENCE, half_interval
from restitution.results.writer import (
    ResultsFolder,
    curve_variables,
    oblique_variables,
    status_attributes,
)
from restitution.runs.attraction import Sticking, mean_of, stored, summary_of, with_errors
from restitution.runs.error_budget import (
    MISSING_BAND,
    ErrorBudget,
    interrupted_errors,
    total_error_summary,
)
from restitution.runs.log import RunLog, Say, ignore
from restitution.runs.oblique import mean_oblique
from restitution.runs.periodic import run_periodic
from restitution.runs.refinement import with_chosen_grids
from restitution.runs.result_warnings import too_coarse_for_adhesion, unresolved
from restitution.runs.run import run_case

# Fields that combine only surfaces on which an impact has this maximum indentation.
_OF_IMPACTS = (
    "restitution",
    "impact_velocity",
    "restitution_error",
    "model_error",
    "sticks",
    "restitution_with_losses",
    "loss_error",
)
# Keys of `summary.json` that the run on one surface gives.
_OF_ONE = ("model", "materials", "conventions", "derived", "device", "kernels", "versions")


def _known(*values: float) -> list[float]:
    return [value for value in values if not math.isnan(value)]


def _of_known(values: list[float]) -> float:
    """Mean of the known values; surfaces that stick have no factor."""
    known = _known(*values)
    return float(np.mean(known)) if known else math.nan


# Fields of an ensemble's curve that are not means, and the functions that combine the values of
# the surfaces. Flags are not listed: they are true if they are true for all surfaces.
_WORST: dict[str, Callable[[list[float]], float]] = {
    "adhesive_spacing": min,
    "residual": max,
    "model_error": max,
    "median_patch_nodes": min,
    "convolutions": sum,
    "refine": max,
    **dict.fromkeys(("plate_factor", "waves_factor", "viscosity_factor"), _of_known),
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

    With several surfaces, the run on surface n (n = 1, 2, …) is stored in a folder
    `realisation-<n>`, and the curve of `out` contains the means (`mean_points`). Its seed is that
    of the case plus n − 1 (of a scan without a seed, its `place`). A surface that fails is
    recorded, and the others continue; if all fail, the first error is raised. With `grid.refine =
    "auto"`, the first surface decides the grids of all.
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
    def __init__(
        self, case: Case, text: str, folder: Path, out: ResultsFolder, log: RunLog
    ) -> None:
        self.case, self.text, self.folder, self.out, self.log = case, text, folder, out, log
        self.parts: dict[int, ResultsFolder] = {}
        self.failures: list[RestitutionError] = []
        self.ended: list[dict[str, Any]] = []
        self.errors: Sequence[Point] = ()
        self.band_errors: list[float] = []
        self.sticking: dict[int, Sticking] = {}
        self.one_sticking: Sticking | None = None  # with the errors of grid and materials

    def compute(self) -> None:
        self.case.realisation(0).surface(self.folder)  # end here if the scan cannot be read
        self.case = with_chosen_grids(self.case, self.folder, self.log.warn)
        for number in range(self.case.realisations):
            self._run(number)
        self._add_errors()

    def _run(self, number: int) -> None:
        name = f"realisation {number + 1} of {self.case.realisations}"
        case = self.case.realisation(number)
        title = f"{case.title}, {name}" if case.title else name
        part = self.out.part(f"realisation-{number + 1}")
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
            depths = len(part.curve.points)
            if depths:
                self.parts[number] = part
            self.ended.append({"realisation": number + 1, "depths": depths, "reason": reason})

    def _add_errors(self) -> None:
        """Estimate the errors due to grid and materials, on the surface with the most depths."""
        if not self.parts or not self.case.total_error:
            return
        number = max(self.parts, key=lambda k: len(self.parts[k].curve.points))
        case, points = self.case.realisation(number), self.parts[number].curve.points
        log = self.log
        budget = ErrorBudget(
            case, self.folder, points, log.progress, log.material_parts, scattered=False
        )
        try:
            budget.add(case.surface(self.folder))
            if number in self.sticking:
                pair = self.sticking[number]
                self.one_sticking = with_errors(pair, budget.finest, scattered=False)
        except RestitutionError as error:
            log.warn(f"total_error is unknown: {error}")
        self.errors, self.band_errors = budget.points, budget.band

    def keep(self) -> dict[str, Any]:
        """Write the curve of the ensemble, its summary and the table of all surfaces."""
        if not self.parts:
            return {}
        points = mean_points([part.curve.points for part in self.parts.values()], self.errors)
        self.out.put_curve(points)
        self.out.put_table(
            "realisations.csv",
            [{"realisation": k + 1} | row for k, part in self.parts.items() for row in part.rows],
        )
        one = self.parts[min(self.parts)].results
        summary = self._summary(one.summary)
        self.out.put_oblique(mean_oblique([part.oblique for part in self.parts.values()]))
        more = curve_variables(points) | oblique_variables(self.out.oblique)
        dataset = one.smooth().assign(more)
        dataset.attrs |= status_attributes(summary)
        self.out.write(dataset, summary)
        return summary

    def _summary(self, one: dict[str, Any]) -> dict[str, Any]:
        points = self.out.curve.points
        whole = [point for part in self.parts.values() for point in part.curve.points]
        return {
            **self.log.head(self.case),
            "realisations_asked": self.case.realisations,
            "realisations": self.ended,
            "confidence": CONFIDENCE,
            "depths_asked": len(self.case.depths()),
            "depths_computed": len(points),
            "warnings": [*self.log.warnings, *self._result_warnings(whole)],
            "sticking": summary_of(mean_of(list(self.sticking.values()), self.one_sticking)),
            **{key: one[key] for key in _OF_ONE},
            "diagnostics": {
                f"largest_{name}": largest(whole, name)
                for name in ("residual", "restitution_error")
            }
            | total_error_summary(self.case, points, self.log.material_parts),
            "convolutions": sum(int(point.convolutions) for point in whole),
            "seconds": self.log.seconds,
        }

    def _result_warnings(self, whole: list[Point]) -> Iterator[str]:
        means = self.out.curve.points
        yield from unresolved(whole)
        grid = self.case.realisation(0).contact(self.folder).grid
        yield from too_coarse_for_adhesion(self.case, grid, whole, self.log.seconds)
        yield from interrupted_errors(self.case, means, self.log.status)
        fewest = min(
            (mean.realisations for mean in means if isinstance(mean, MeanPoint)), default=math.inf
        )
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


def mean_points(curves: Sequence[Sequence[Point]], errors: Sequence[Point] = ()) -> list[MeanPoint]:
    """Make the curve of an ensemble: at each depth, means over the surfaces that reached it.

    Exceptions are in `_WORST`; flags are true if they are true for all of these surfaces. The 95 %
    confidence interval of the mean COR is mean ± t s/√n, clipped to [0, 1]; NaN for one surface.

    `errors` are the points of one surface, whose errors due to grid and materials are taken over.
    `surface_scatter` is half of the width of the confidence interval, and the uncertainty of a
    joined spectrum of scans. The total error of a depth that only one surface reached stays
    unknown.
    """
    count = max(map(len, curves), default=0)
    alone: list[Point | None] = [
        None if math.isnan(point.total_error) else point for point in errors[:count]
    ]
    alone += [None] * (count - len(alone))
    return [_mean([of[k] for of in curves if len(of) > k], alone[k]) for k in range(count)]


def _mean(surfaces: Sequence[Point], errors: Point | None) -> MeanPoint:
    # Surfaces on which an impact has this maximum indentation; all if there is none.
    met = [point for point in surfaces if not math.isnan(point.restitution)] or surfaces
    means: dict[str, Any] = {}
    for part, column in zip(fields(Point), Point.columns().values(), strict=True):
        of = [
            getattr(point, part.name) for point in (met if part.name in _OF_IMPACTS else surfaces)
        ]
        means[part.name] = all(of) if column.flag else float(_WORST.get(part.name, np.mean)(of))
    n = len(met)
    interval = half_interval(n) if n > 1 else math.nan
    std = deviation([point.restitution for point in met])
    half = interval * std
    mean = MeanPoint(
        **means,
        realisations=len(surfaces),
        restitution_std=std,
        restitution_low=max(means["restitution"] - half, 0.0),
        restitution_high=min(means["restitution"] + half, 1.0),
    )
    if errors is None:
        return mean
    half_pull_off = interval * deviation([point.pull_off_force for point in met])
    mean = replace(
        mean,
        discretisation_error=errors.discretisation_error,
        material_error=errors.material_error,
        resolved=mean.resolved and errors.resolved,
        surface_scatter=math.hypot(half, *_known(errors.surface_scatter)),
        pull_off_error=math.hypot(errors.pull_off_error, half_pull_off),
    )
    return replace(mean, total_error=mean.combined_error) if n > 1 else mean


def deviation(values: Sequence[float]) -> float:
    """Sample standard deviation; NaN for one value."""
    return float(np.std(values, ddof=1)) if len(values) > 1 else math.nan
