"""Convergence study: one case on successively finer grids, with the discretisation error of COR.

docs/resolution.md has the formula of the error and the check of it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.case.schema import MOST_NODES
from restitution.curve.columns import array
from restitution.curve.curve import largest
from restitution.curve.point import Point
from restitution.errors import CaseError
from restitution.results.writer import ResultsFolder, curve_variables, status_attributes
from restitution.runs.companions import Companions
from restitution.runs.depths import later_touches
from restitution.runs.error_budget import (
    MISSING_BAND,
    OmittedWaves,
    error_of_law,
    interrupted_errors,
    spread_errors,
    total_error_summary,
    unseen_yield,
    widened_error,
)
from restitution.runs.log import RunLog, Say, ignore
from restitution.runs.loss_errors import with_sticking
from restitution.runs.refinement import with_chosen_adhesion, with_chosen_grids
from restitution.runs.run import run_case


@dataclass(frozen=True)
class _OnGrid:
    """A point on one grid, its number on this grid's curve, and |ΔCOR| since the grid before."""

    point: Point
    number: int
    last_change: float
    observed_order: float


@dataclass(frozen=True)
class _Spread:
    """Errors by surface and materials, `OmittedWaves.octaves`, and what no grid of the study shows.

    `unseen` is `unseen_yield`, or `error_of_law` with waves in patches.
    """

    errors: dict[str, Any]
    unseen: float
    octaves: float


@dataclass(frozen=True)
class _Grid:
    """The curve of one grid, which touches `later` (m) than the finest grid."""

    later: float
    out: ResultsFolder

    @property
    def points(self) -> tuple[Point, ...]:
        return self.out.curve.points


_Grids = dict[int, _Grid]  # by refinement factor


def run_convergence(
    case: Case,
    text: str,
    folder: Path,
    out: ResultsFolder,
    grids: int = 3,
    progress: Say = ignore,
    warn: Say = ignore,
) -> dict[str, Any]:
    """Run `case` on its grid and on grids with cells 2, 4, … times smaller; return the summary.

    With `grid.refine = "auto"`, the first grid is the grid that the shallowest depth needs. Each
    run is stored in a folder `refine-<n>` of `out`. The curve of `out` is that of the finest grid,
    with its `discretisation_error`; `convergence.csv` has a row for every depth and grid. If a run
    fails, the study ends and keeps the results so far.

    Depths are measured from first touch on the finest grid. A coarser grid touches later, because
    the highest summit lies between its nodes.
    """
    case.require_impact()
    log, runs = RunLog(progress, warn), _Grids()
    unsettled: list[str] = []
    spread: dict[int, _Spread] = {}

    with log.record(
        out, lambda: _write_results(case, out, runs, spread, log, unsettled) if runs else {}
    ):
        case = with_chosen_grids(case, folder, log.warn)
        case = case.refined(max(case.factors()))
        if case.interface.adhesive_energy and case.interface.adhesion is None:
            case = with_chosen_adhesion(case, case.contact(folder), log.warn)
        unsettled[:] = log.warnings
        for factor, later in _levels(case, folder, grids).items():
            part = out.part(f"refine-{factor}")
            refined = _pressed_less(case, later)
            if not refined.depths():
                warn(f"refine = {factor}: this grid has no contact at any depth and is left out")
                part.discard()
                continue
            try:
                run_case(
                    refined.refined(factor),
                    text,
                    folder,
                    part,
                    log.progress_of(f"refine = {factor}"),
                    ignore if runs else log.warnings_of(part),
                    errors=False,
                )
            finally:
                if part.curve.points:
                    runs[factor] = _Grid(later, part)
        if case.total_error and runs:
            spread |= _spread_of(case.refined(max(runs)), folder, runs[max(runs)].points, log)
    return log.summary


def _spread_of(
    case: Case, folder: Path, points: Sequence[Point], log: RunLog
) -> dict[int, _Spread]:
    """Errors of the impacts on the finest grid due to surface and materials, by their number."""
    reached = {k: point for k, point in enumerate(points) if point.loading_work > 0}
    if not reached:
        return {}
    impacts = list(reached.values())
    waves = OmittedWaves.of(case.surface(folder))
    companions = Companions.of(case, folder, impacts)
    if scales := companions.scales(log.progress):
        unseen = error_of_law(scales, companions, impacts)
    else:
        log.progress("error: yielding on a finer grid")
        unseen = unseen_yield(companions, waves, impacts)
    work = array(impacts, "loading_work")
    errors = spread_errors(companions, work, log.progress, parts=log.material_parts)
    errors = with_sticking({"discretisation_error": unseen} | errors, companions, impacts)
    unseen = errors.pop("discretisation_error")
    return {
        number: _Spread(
            {name: float(values[k]) for name, values in errors.items()},
            float(unseen[k]),
            waves.octaves,
        )
        for k, number in enumerate(reached)
    }


def _levels(case: Case, folder: Path, grids: int) -> dict[int, float]:
    """Choose the refinement factors; return each with the extra approach (m) of its grid."""
    if grids < 2:
        raise CaseError(f"grids: a study on {grids} grid cannot show convergence; give 2 or more")
    if case.realisations > 1:
        raise CaseError(
            "roughness.realisations: a convergence study uses one surface; remove this key"
        )
    coarsest = case.grid.factor
    factors = [coarsest * 2**k for k in range(grids)]
    own = case.grid.grid()
    nx, ny = own.nodes if own else case.refined(1).surface(folder).grid.nodes
    if nx * ny * factors[-1] ** 2 > MOST_NODES:
        raise CaseError(
            f"grids: the finest grid would have {nx * factors[-1]} x {ny * factors[-1]} nodes, "
            f"but at most {MOST_NODES} are allowed; give fewer grids, or a coarser first grid"
        )
    return later_touches(case, folder, factors)


def _pressed_less(case: Case, later: float) -> Case:
    """Reduce the indentations of `case` by `later` (m), for a run on a grid that touches later.

    Runs measure indentations from first touch on their own grid. Indentations at which the bodies
    do not touch yet are left out.
    """
    if case.indentation is None:
        return case  # loads and velocities do not depend on where a grid touches first
    depths = [depth - later for depth in case.depths() if depth > later]
    table = case.indentation.model_construct(values=depths)
    return case.model_copy(update={"indentation": table})


def _write_results(
    case: Case,
    out: ResultsFolder,
    runs: _Grids,
    spread: dict[int, _Spread],
    log: RunLog,
    unsettled: list[str],
) -> dict[str, Any]:
    depths = _by_depth(case, runs)
    reached = [grids for grids in depths if max(runs) in grids]  # depths that the finest reached
    lacking = 0
    for grids in reached if case.total_error else ():
        finest = grids[max(runs)]
        point, unseen = _with_errors(finest, spread.get(finest.number))
        grids[max(runs)], lacking = replace(finest, point=point), lacking + unseen
    points = [grids[max(runs)].point for grids in reached]
    order = observed_order(depths)
    out.put_curve(points)
    out.put_table(
        "convergence.csv",
        [
            {"refine": 0} | on.point.cells() | {"observed_order": on.observed_order}
            for grids in depths
            for on in grids.values()
        ],
    )
    one = runs[max(runs)].out.results
    out.put_oblique(one.oblique)
    convolutions = sum(int(p.convolutions) for grid in runs.values() for p in grid.points)
    summary = one.summary | {
        **log.head(case),
        "warnings": unsettled + one.summary["warnings"],
        "grids": sorted(runs),
        "observed_order": None if math.isnan(order) else order,
        "seconds": log.seconds,
        "convolutions": convolutions,
    }
    summary["diagnostics"] = {
        **one.summary["diagnostics"],
        "largest_discretisation_error": largest(points, "discretisation_error"),
        **total_error_summary(case, points, log.material_parts),
    }
    summary["warnings"] += _warnings(points, lacking)
    summary["warnings"] += interrupted_errors(case, points, log.status)
    dataset = one.dataset.assign(curve_variables(points))
    coarser = sorted(runs)[:-1]
    values = [
        [grids[factor].point.restitution if factor in grids else math.nan for grids in reached]
        for factor in coarser
    ]
    dataset["coarser_restitution"] = (
        ("refine", "indentation_max"),
        np.reshape(values, (len(coarser), len(points))),
        {"units": "1", "long_name": "coefficient of restitution on coarser grids"},
    )
    dataset["refine"] = coarser
    dataset.attrs |= status_attributes(summary)
    out.write(dataset, summary)
    return summary


def _warnings(points: Sequence[Point], lacking: int) -> Iterator[str]:
    if lacking:
        yield (
            f"{lacking} of {len(points)} depths are not resolved: even the finest grid leaves out "
            "waves of the scan that change COR; give more grids, or a smaller grid.spacing"
        )
    if unknown := sum(math.isnan(point.discretisation_error) for point in points):
        yield (
            f"{unknown} of {len(points)} depths have no discretisation_error: coarser grids have "
            "no contact there; begin deeper, or with a finer grid (grid.refine)"
        )


def _with_errors(on: _OnGrid, spread: _Spread | None) -> tuple[Point, bool]:
    """Add the other parts to the discretisation error of a point (`widened_error`), and its total.

    Returns the point, and whether the omitted waves change COR by more than `MISSING_BAND`.
    """
    if spread is None:
        return on.point, False
    point = replace(on.point, **spread.errors)
    if math.isnan(point.discretisation_error):
        return point, False
    error, band = widened_error(
        point.discretisation_error, on.last_change, spread.unseen, point, spread.octaves
    )
    point = replace(point, discretisation_error=error)
    if band > MISSING_BAND:
        point = replace(point, resolved=False)
    if all(map(math.isfinite, (error, *spread.errors.values()))):
        point = replace(point, total_error=point.combined_error)
    return point, band > MISSING_BAND


def _by_depth(case: Case, runs: _Grids) -> list[dict[int, _OnGrid]]:
    """The points at each depth by refinement factor, with their discretisation error."""
    prescribed = case.depths()
    depths: list[dict[int, _OnGrid]] = [{} for _ in prescribed]
    for factor, grid in sorted(runs.items()):
        # A coarse grid lacks the shallowest depths, and an interrupted run lacks the deepest.
        missed = sum(depth <= grid.later for depth in prescribed) if case.indentation else 0
        for number, point in enumerate(grid.points):
            depth = depths[missed + number]
            values = [other.point.restitution for other in depth.values()]
            error, order = discretisation([*values, point.restitution])
            change = abs(values[-1] - point.restitution) if values else math.nan
            point = replace(point, refine=factor, discretisation_error=error)
            if case.indentation:
                point = replace(point, indentation=prescribed[missed + number])
            depth[factor] = _OnGrid(point, number, change, order)
    return depths


def discretisation(values: Sequence[float]) -> tuple[float, float]:
    """Error of the last of `values`, and observed order (docs/resolution.md); NaN if unknown.

    `values` are COR on successive grids, each with half the cell size of the grid before.
    """
    if len(values) < 2:
        return math.nan, math.nan
    last = values[-1] - values[-2]
    if len(values) == 2:
        return 3 * abs(last), math.nan
    before = values[-2] - values[-3]
    order = math.log2(before / last) if last * before > 0 else math.nan
    return max(1.5 * abs(last), 0.5 * abs(before)), order


def observed_order(depths: Sequence[dict[int, _OnGrid]]) -> float:
    """Observed order of convergence of COR on the last three grids; NaN if there is none.

    The differences of COR between grids are averaged over the depths (rms), because the orders of
    single depths scatter. Only depths that the finest grid resolves count.
    """
    factors = sorted({factor for grids in depths for factor in grids})[-3:]
    steps = np.array(
        [
            np.diff([grids[factor].point.restitution for factor in factors])
            for grids in depths
            if all(factor in grids for factor in factors) and grids[factors[-1]].point.resolved
        ]
    )
    if len(factors) < 3 or not steps.size or not np.all(np.any(steps, axis=0)):
        return math.nan
    before, last = np.sqrt(np.mean(steps**2, axis=0))
    return float(np.log2(before / last))
