"""Convergence study: one case on successively finer grids, with the discretisation error of COR.

With COR f₁, f₂, f₃ on cells of size h, h/2, h/4 of the same surface,

    error of f₃ = max(1.5 |f₃ − f₂|, 0.5 |f₂ − f₁|),   observed order = log₂((f₂ − f₁)/(f₃ − f₂)).

Richardson extrapolation (Roache 1994, J. Fluids Eng. 116, 405–413) is not used, because the COR of
rough contacts oscillates with h more often than it follows a power of h. Instead, convergence of
first order is assumed. The last two grids then give |f₃ − f₂| as the error of f₃, and the first two
grids give 0.5 |f₂ − f₁|. The estimate |f₃ − f₂| is multiplied by a safety factor of 1.5. The larger
of the two estimates is used; it exceeded the true error in 95 % of the cases of docs/resolution.md.
If there are only two grids, the error of f₂ is 3 |f₂ − f₁|.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from restitution.case.case import Case
from restitution.case.schema import MOST_NODES
from restitution.errors import CaseError
from restitution.results.reader import RunResults
from restitution.results.schema import COLUMNS
from restitution.results.total_error import total
from restitution.results.writer import (
    ResultsFolder,
    curve_variables,
    status_attributes,
    write_table,
)
from restitution.runs.companions import Companions
from restitution.runs.depths import later_touches
from restitution.runs.error_budget import (
    MISSING_BAND,
    Band,
    Row,
    interrupted_errors,
    spread_errors,
    total_error_summary,
    unseen_yield,
    widened_error,
)
from restitution.runs.log import RunLog, Say, ignore
from restitution.runs.refinement import settled, with_chosen_adhesion
from restitution.runs.run import run_case

# The key is the refinement factor of a grid. The value contains the approach (m) to first touch
# minus the approach on the finest grid, and the rows of the curve.
_Runs = dict[int, tuple[float, list[Row]]]


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

    With `grid.refine = "auto"`, the first grid is the grid that the shallowest depth needs. The run
    on each grid is stored in a folder `refine-<n>` of `out`. The curve of `out` is the curve of the
    finest grid with its `discretisation_error`, and `convergence.csv` has a row for every depth and
    grid. If a run fails, the study ends and keeps the results so far.

    Depths are measured from first touch on the finest grid. A coarser grid touches later, because
    the highest summit lies between its nodes. Its indentation, measured from its own first touch,
    is therefore smaller than the depth.
    """
    case.require_impact()
    log, runs = RunLog(progress, warn), _Runs()
    unsettled: list[str] = []

    with log.record(out, lambda: _write_results(case, out, runs, log, unsettled) if runs else {}):
        case = settled(case, folder, log.warn)
        case = case.refined(max(case.factors()))
        if case.interface.adhesive_energy and case.interface.adhesion is None:
            case = with_chosen_adhesion(case, case.contact(folder), log.warn)
        unsettled[:] = log.warnings
        for factor, later in _levels(case, folder, grids).items():
            part = ResultsFolder(out.path / f"refine-{factor}")
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
                if part.rows:
                    runs[factor] = later, part.rows
        if case.total_error and runs:
            _add_errors(case, folder, runs, log)
    return log.summary


def _add_errors(
    case: Case,
    folder: Path,
    runs: _Runs,
    log: RunLog,
) -> None:
    """Add the errors due to surface and materials to the rows of the finest grid.

    Each row also gets the values `errors_known`, `unseen_yield` and `octaves`. `errors_known` says
    whether all of these errors could be computed. `_with_grid_errors` uses the other two values
    (see `error_budget`) for the discretisation error. Rows whose loading work is not positive stay
    unchanged.
    """
    reached = [row for row in runs[max(runs)][1] if row["loading_work_J"] > 0]
    if not reached:
        return
    fine = case.refined(max(runs))
    waves = Band.of(fine.surface(folder))
    companions = Companions(fine, folder, sorted(row["max_indentation_m"] for row in reached))
    log.progress("error: yielding on a finer grid")
    unseen = unseen_yield(companions, waves, reached)
    work = np.array([row["loading_work_J"] for row in reached])
    errors = spread_errors(companions, work, log.progress, parts=log.material_parts)
    for k, row in enumerate(reached):
        found = {name: float(values[k]) for name, values in errors.items()}
        known = all(math.isfinite(error) for error in found.values())
        row.update(found, errors_known=known, unseen_yield=float(unseen[k]), octaves=waves.octaves)


def _levels(case: Case, folder: Path, grids: int) -> dict[int, float]:
    """Choose the refinement factors; return each with the extra approach (m) of its grid.

    The bodies touch first on the finest grid. On another grid they touch only when they have
    approached each other further by the extra approach.
    """
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
    """Reduce the indentations of `case` by `later` (m), for a run on a coarser grid.

    `later` is the approach at first touch on this grid minus that on the finest grid. A run
    measures indentations from first touch on its own grid. With the reduced indentations, the
    bodies approach each other equally far on all grids. Indentations that do not exceed `later` are
    left out, because at this approach the bodies do not yet touch on the coarser grid.
    """
    if case.indentation is None:
        return case  # loads and velocities do not depend on where a grid touches first
    depths = [depth - later for depth in case.depths() if depth > later]
    table = case.indentation.model_construct(values=depths)
    return case.model_copy(update={"indentation": table})


def _write_results(
    case: Case,
    out: ResultsFolder,
    runs: _Runs,
    log: RunLog,
    unsettled: list[str],
) -> dict[str, Any]:
    """Write the finest curve, the table of all grids and the summary; return the summary."""
    depths = _by_depth(case, runs)
    reached = [rows for rows in depths if max(runs) in rows]  # depths that the finest grid reached
    finest = [rows[max(runs)] for rows in reached]
    lacking = _with_grid_errors(finest) if case.total_error else 0
    order = observed_order(depths)
    out.put_curve([{key: row[key] for key in COLUMNS} for row in finest])
    write_table(
        out.path / "convergence.csv",
        [
            {key: row[key] for key in ("refine", *COLUMNS, "observed_order")}
            for rows in depths
            for row in rows.values()
        ],
    )
    one = RunResults(out.path / f"refine-{max(runs)}")
    out.put_oblique(one.oblique)
    summary = one.summary | {
        "status": log.status,
        "reason": log.reason,
        "warnings": unsettled + one.summary["warnings"],
        "title": case.title,
        "grids": sorted(runs),
        "observed_order": None if math.isnan(order) else order,
        "seconds": log.seconds,
        "convolutions": sum(int(row["convolutions"]) for _, rows in runs.values() for row in rows),
    }
    known = [e for row in finest if not math.isnan(e := row["discretisation_error"])]
    summary["diagnostics"] = {
        **one.summary["diagnostics"],
        "largest_discretisation_error": max(known, default=None),
        **total_error_summary(case, finest, log.material_parts),
    }
    if lacking:
        summary["warnings"].append(
            f"{lacking} of {len(finest)} depths are not resolved: even the finest grid leaves out "
            "waves of the scan that change COR; give more grids, or a smaller grid.spacing"
        )
    if len(known) < len(finest):
        summary["warnings"].append(
            f"{len(finest) - len(known)} of {len(finest)} depths have no discretisation_error: "
            "coarser grids have no contact there; begin deeper, or with a finer grid (grid.refine)"
        )
    summary["warnings"] += interrupted_errors(case, finest, log.status)
    dataset = one.dataset.assign(curve_variables(out.rows))
    coarser = sorted(runs)[:-1]
    values = [
        [rows[factor]["restitution"] if factor in rows else math.nan for rows in reached]
        for factor in coarser
    ]
    dataset["coarser_restitution"] = (
        ("refine", "indentation_max"),
        np.reshape(values, (len(coarser), len(finest))),
        {"units": "1", "long_name": "coefficient of restitution on coarser grids"},
    )
    dataset["refine"] = coarser
    dataset.attrs |= status_attributes(summary)
    out.write(dataset, summary)
    return summary


def _with_grid_errors(rows: list[Row]) -> int:
    """Add three parts to the discretisation error of `rows`, the rows of the finest grid.

    The first part is a minimum error, because differences of COR between grids may vanish by
    chance. The second part is the effect of the waves that the finest grid leaves out of a scan.
    The third part is the effect of nodes that would yield only on a finer grid.

    A row stays unchanged if it lacks a discretisation error or the values that `_add_errors` adds.
    The total error of a row is set only if all of its parts are known. If the omitted waves change
    COR by more than `MISSING_BAND`, the row is marked as not resolved. Returns the number of rows
    that were marked.
    """
    lacking = 0
    for row in rows:
        if math.isnan(row["discretisation_error"]) or "unseen_yield" not in row:
            continue
        row["discretisation_error"], band = widened_error(
            row["discretisation_error"],
            row["last_change"],
            row["unseen_yield"],
            row,
            row["octaves"],
        )
        if band > MISSING_BAND:
            row["resolved"], lacking = False, lacking + 1
        if row["errors_known"] and math.isfinite(row["discretisation_error"]):
            row["total_error"] = total(row)
    return lacking


def _by_depth(case: Case, runs: _Runs) -> list[dict[int, Row]]:
    """Return a dictionary for each depth: refinement factor of each grid, and row of this grid.

    Each row contains the discretisation error and the observed order. Grids that did not reach a
    depth are missing from its dictionary.
    """
    asked = case.depths()
    found: list[dict[int, Row]] = [{} for _ in asked]
    for factor, (later, rows) in sorted(runs.items()):
        # A coarse grid lacks the shallowest depths, and an interrupted run lacks the deepest.
        missed = sum(depth <= later for depth in asked) if case.indentation else 0
        for number, row in enumerate(rows, missed):
            values = [other["restitution"] for other in found[number].values()]
            error, order = discretisation([*values, row["restitution"]])
            indentation = asked[number] if case.indentation else row["max_indentation_m"]
            found[number][factor] = {
                **row,
                "max_indentation_m": indentation,
                "refine": factor,
                "last_change": abs(values[-1] - row["restitution"]) if values else math.nan,
                "discretisation_error": error,
                "observed_order": order,
            }
    return found


def discretisation(values: Sequence[float]) -> tuple[float, float]:
    """Error of the last of `values`, and observed order (see the module docstring).

    `values` are COR on successive grids, each with half the cell size of the grid before.
    Error and order are NaN for too few values. The observed order is also NaN if the last three
    values are not monotone.
    """
    if len(values) < 2:
        return math.nan, math.nan
    last = values[-1] - values[-2]
    if len(values) == 2:
        return 3 * abs(last), math.nan
    before = values[-2] - values[-3]
    order = math.log2(before / last) if last * before > 0 else math.nan
    return max(1.5 * abs(last), 0.5 * abs(before)), order


def observed_order(depths: Sequence[dict[int, Row]]) -> float:
    """Observed order of convergence of COR on the last three grids.

    The differences of COR between grids are averaged over the depths (rms), because the orders of
    single depths scatter. A depth is used only if the finest grid resolves it and all three grids
    reach it. The result is NaN for fewer than three grids, without such depths, or if COR does not
    change between two grids.
    """
    factors = sorted({factor for rows in depths for factor in rows})[-3:]
    steps = np.array(
        [
            np.diff([rows[factor]["restitution"] for factor in factors])
            for rows in depths
            if all(factor in rows for factor in factors) and rows[factors[-1]]["resolved"]
        ]
    )
    if len(factors) < 3 or not steps.size or not np.all(np.any(steps, axis=0)):
        return math.nan
    before, last = np.sqrt(np.mean(steps**2, axis=0))
    return float(np.log2(before / last))
