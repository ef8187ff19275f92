"""Figure 10 of Ghanbarzadeh et al. (2019) with a size effect, new and after coverage 3."""

import csv
import itertools
import sys
import warnings
from pathlib import Path

from restitution import run
from restitution.plots.cor import cor_axis
from restitution.plots.figure import GREY, PALETTE, Axis, Chart, Figure, Line, Points

sys.path.insert(0, str(Path(__file__).parents[1]))
sys.path.insert(0, str(Path(__file__).parents[1] / "run_in"))
from figure_10 import COVERAGE, RESULTS, case, columns
from shared import HERE as EVIDENCE
from shared import write_image, write_table

SPEEDS = [0.04, 0.16, 0.3]
ROUGH = [0.1, 0.5]  # Rq, µm
LENGTHS = [0.0, 0.2, 1.0]  # h*, µm
TABLE = "size_effect/figure_10.csv"
KEYS = "rms_um", "h_um", "velocity_m_per_s"


def rows_of(rms: float, length: float, speed: float) -> list[dict]:
    tables = case(rms, 0, speed)
    tables["interface"]["size_effect"] = f"{length} um"
    common = {"rms_um": rms, "h_um": length, "velocity_m_per_s": speed}
    return [
        {**common, "coverage": round(point.coverage)}
        | {name: round(getattr(point, name), 4) for name in RESULTS}
        for point in run(tables).run_in
    ]


def main() -> None:
    warnings.simplefilter("ignore")
    path = EVIDENCE / TABLE
    rows = list(csv.DictReader(path.open(newline=""))) if path.exists() else []
    known = {tuple(float(row[name]) for name in KEYS) for row in rows}
    for speed, length, rms in itertools.product(SPEEDS[::-1], LENGTHS[::-1], ROUGH):
        if (rms, length, speed) not in known:
            rows += rows_of(rms, length, speed)
            print(rows[-2:], flush=True)
            write_table(TABLE, rows)
    draw(rows)


def draw(rows: list[dict]) -> None:
    with (EVIDENCE / "run_in" / "figure_10.csv").open(newline="") as file:
        smooth = [row for row in csv.DictReader(file) if float(row["work_of_adhesion"]) == 0]
    panels = []
    for coverage, title in ((0, "first impact"), (COVERAGE, f"after coverage {COVERAGE}")):
        V, e, *_ = columns(smooth, 0, 0)
        series = [Line(V, e, "smooth, h* = 0", color=GREY)]
        for (rms, symbol), (length, color) in itertools.product(
            zip(ROUGH, ("circle", "square"), strict=True), zip(LENGTHS, PALETTE, strict=False)
        ):
            of = [row for row in rows if float(row["h_um"]) == length]
            V, e, *_ = (values[::-1] for values in columns(of, rms, coverage))
            name = f"Rq {rms} µm, h* = {length:g} µm"
            series.append(Points(V, e, name, color=color, joined=True, symbol=symbol))
        axis = Axis("impact velocity", "m/s", "log", 0.9 * SPEEDS[0], 1.1 * SPEEDS[-1])
        panels.append((axis, series, title))
    both = cor_axis([part for _, series, _ in panels for part in series])
    write_image("size-effect", Figure("", [Chart(x, both, series, t) for x, series, t in panels]))


if __name__ == "__main__":
    main()
