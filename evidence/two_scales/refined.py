r"""Impacts on few cells: the grid that a run names or chooses, and the error that it has there.

    python -m evidence.two_scales.refined --topographies ../shared/topographies

appends to refined.csv a row for the slowest impact of each case of dry.py that was drawn after the
constants of the error were chosen. Cases that are in it are not solved again.
"""

from __future__ import annotations

import re
import tempfile
import time
from pathlib import Path

import numpy as np

from evidence.two_scales.dry import CASES, FIRST, draw
from evidence.two_scales.dry import TABLE as DRY
from evidence.two_scales.table import Table, options
from restitution.case.case_file import parse_case
from restitution.errors import RestitutionError
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

COLUMNS = (
    "case",
    "kind",
    "bound",
    "velocity",
    "direct",
    "patch",
    "grid_error",
    "seconds",
    "named",
    "foretold",
    "named_patch",
    "named_grid_error",
    "chosen",
    "chosen_patch",
    "chosen_grid_error",
    "chosen_total_error",
    "chosen_seconds",
)
TABLE = Table(__file__, COLUMNS)
_NAMED = re.compile(r"with grid\.refine = (\d+) .* it would be about ([\d.]+)")


def run(text: str, refine: str, folder: Path) -> tuple[object, list[str], float]:
    """The point of a case, the warnings, and the processor time (s)."""
    text = text.replace("REFINE", refine)
    with tempfile.TemporaryDirectory() as temporary:
        out, began = ResultsFolder(Path(temporary) / "out"), time.process_time()
        summary = run_case(parse_case(text), text, folder, out)
        (point,) = out.curve.points
        return point, summary["warnings"], time.process_time() - began


def row_of(number: int, scans: Path) -> dict[str, object] | None:
    known = [row for row in DRY.rows() if int(row["case"]) == number]
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        kind, text, _ = draw(FIRST + number, scans, folder)
        text = re.sub(r"velocity = \[(\"[^\"]*\").*\]", r"velocity = [\1]", text)
        text = text.replace("BELOW", 'below_grid = "patch"\n')
        try:
            point, warnings, seconds = run(text, "refine = 1\n", folder)
            chosen, _, chosen_seconds = run(text, "", folder)
        except RestitutionError as error:
            print("   ", error)
            return None
        row = {
            "case": number,
            "kind": kind,
            "bound": "growing" if "yield_strength" in text else "constant",
            "velocity": known[0]["velocity"],
            "direct": known[0]["direct"],
            "patch": f"{point.restitution:.4f}",
            "grid_error": f"{point.discretisation_error:.4f}",
            "seconds": f"{seconds:.1f}",
            "chosen": int(chosen.refine),
            "chosen_patch": f"{chosen.restitution:.4f}",
            "chosen_grid_error": f"{chosen.discretisation_error:.4f}",
            "chosen_total_error": f"{chosen.total_error:.4f}",
            "chosen_seconds": f"{chosen_seconds:.1f}",
        }
        for match in filter(None, map(_NAMED.search, warnings)):
            named, _, _ = run(text, f"refine = {match[1]}\n", folder)
            row |= {
                "named": match[1],
                "foretold": match[2],
                "named_patch": f"{named.restitution:.4f}",
                "named_grid_error": f"{named.discretisation_error:.4f}",
            }
    return row


def summary() -> None:
    rows = TABLE.rows()
    named = [row for row in rows if row["named"]]
    ratio = [float(row["named_grid_error"]) / float(row["foretold"]) for row in named]
    off = [abs(float(row["named_patch"]) - float(row["direct"])) for row in named]
    print(
        f"{len(named)} of {len(rows)} name a grid: its error is {np.median(ratio):.2f} times that "
        f"foretold in the median (from {min(ratio):.2f} to {max(ratio):.2f}); COR is off by "
        f"{np.median(off):.4f} there, in the median"
    )
    for way in ("patch", "chosen_patch"):
        off = [abs(float(row[way]) - float(row["direct"])) for row in rows]
        error = [float(row[way.replace("patch", "grid_error")]) for row in rows]
        held = sum(a <= b for a, b in zip(off, error, strict=True))
        print(
            f"{way}: off by {np.median(off):.4f} in the median, {max(off):.4f} at most; error of "
            f"the grid {np.median(error):.4f}, holds in {held} of {len(rows)}"
        )
    seconds = [float(row["chosen_seconds"]) / float(row["seconds"]) for row in rows]
    print(f"processor time of the chosen grids: {np.median(seconds):.1f} times, in the median")


def main() -> None:
    given = options(__doc__)
    done = TABLE.cases()
    solved = DRY.cases()
    for number in CASES if not given.summary else ():
        if number < 500 or number in done or number not in solved:
            continue
        if (row := row_of(number, given.topographies)) is None:
            continue
        TABLE.append([row])
        print(*row.values(), flush=True)
    summary()


if __name__ == "__main__":
    main()
