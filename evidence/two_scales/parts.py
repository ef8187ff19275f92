r"""Parts of the error of impacts without adhesion whose short waves are in patches.

    python -m evidence.two_scales.parts --topographies ../shared/topographies

appends to parts.csv a row for each COR of 76 random cases as in dry.py. The constants of the error
in runs/companions.py were chosen on them. Cases that are in the table are not solved again.
"""

from __future__ import annotations

import tempfile
from itertools import pairwise
from pathlib import Path

import numpy as np

from evidence.two_scales.dry import draw, run
from evidence.two_scales.table import Table, options
from restitution.case.case_file import parse_case
from restitution.runs.error_budget import ErrorBudget

FIRST, CASES = 1000, 76
BINS = (0.0, 0.25, 0.4, 0.6, 1.2, 10.0)
PARTS = ("change", "scatter", "separation", "growth")
COLUMNS = (
    "case",
    "kind",
    "bound",
    "wavelength_over_radius",
    "velocity",
    "direct",
    "patch",
    *PARTS,
    "grid_error",
    "surface_scatter",
)
TABLE = Table(__file__, COLUMNS)


def rows_of(number: int, scans: Path) -> list[dict[str, object]]:
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        kind, text, _ = draw(FIRST + number, scans, folder)
        text = "total_error = false\n" + text
        omit = text.replace("BELOW", 'below_grid = "omit"\n').replace("REFINE", "refine = 8\n")
        patch = text.replace("BELOW", 'below_grid = "patch"\n').replace("REFINE", "refine = 1\n")
        direct, known = (run(of, folder, errors=True) for of in (omit, patch))
        case = parse_case(patch)
        budget = ErrorBudget(case, folder, list(known.values()))
        budget.add(case.surface(folder))
        return [
            row | {"case": number, "kind": kind, "direct": f"{direct[key].restitution:.4f}"}
            for key, row in zip(known, parts_of(budget), strict=True)
            if key in direct
        ]


def parts_of(budget: ErrorBudget) -> list[dict[str, object]]:
    points, companions = budget.points, budget.finest
    scales = companions.scales()
    work, area = (
        np.array([getattr(point, name) for point in points])
        for name in ("loading_work", "contact_area")
    )
    nominal = np.array([point.contact_nodes for point in points]) * companions.cell_area
    by_law = scales.error(lambda curve: curve.at(work), nominal)
    own, growth = companions.own.at(work), np.zeros(work.size)
    if scales.weaker is not None:
        growth = np.abs(scales.weaker.at(work) - own)
    columns = {
        "wavelength_over_radius": scales.split_ratio(area),
        "velocity": [point.impact_velocity for point in points],
        "patch": [point.restitution for point in points],
        "change": np.array([point.restitution for point in points]) - own,
        "scatter": np.sqrt(np.maximum(by_law**2 - growth**2, 0)),
        "separation": scales.separation_error(work, area),
        "growth": growth,
        "grid_error": [point.discretisation_error for point in points],
        "surface_scatter": [point.surface_scatter for point in points],
    }
    bound = "constant" if scales.weaker is None else "growing"
    return [
        {"bound": bound} | {name: f"{values[k]:.4g}" for name, values in columns.items()}
        for k in range(len(points))
    ]


def summary() -> None:
    rows = TABLE.rows()
    number = lambda name: np.array([float(row[name]) for row in rows])  # noqa: E731
    off = np.abs(number("patch") - number("direct"))
    error, ratio = number("grid_error"), number("wavelength_over_radius")
    bound = np.array([row["bound"] for row in rows])
    print(f"within the error of the grid: {np.mean(off <= error):.1%} of {len(rows)}")
    for kind in ("constant", "growing"):
        for low, high in pairwise(BINS):
            at = (bound == kind) & (ratio >= low) & (ratio < high)
            medians = " ".join(f"{np.median(np.abs(number(part)[at])):.4f}" for part in PARTS)
            print(
                f"{kind}, ratio {low} to {high}: {at.sum()} impacts; off by "
                f"{np.median(off[at]):.4f} in the median, {np.quantile(off[at], 0.9):.4f} in 90 %; "
                f"{', '.join(PARTS)}: {medians}; error {np.median(error[at]):.4f}, holds in "
                f"{np.mean(off[at] <= error[at]):.0%}; scatter of surfaces "
                f"{np.median(number('surface_scatter')[at]):.4f}"
            )


def main() -> None:
    given = options(__doc__)
    done = TABLE.cases()
    for number in range(0 if given.summary else CASES):
        if number in done:
            continue
        rows = rows_of(number, given.topographies)
        TABLE.append(rows)
        print(number, len(rows), flush=True)
    summary()


if __name__ == "__main__":
    main()
