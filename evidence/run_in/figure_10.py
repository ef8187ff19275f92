"""Figure 10 of Ghanbarzadeh et al. (2019), new and run in: COR of rough spheres, side by side."""

import csv
import itertools
import sys
import warnings
from pathlib import Path

import numpy as np

from restitution import ConstantBound, Contact, Grid, JKRLimit, RunIn, Surface, run
from restitution.plots.cor import cor_axis
from restitution.plots.figure import GREY, PALETTE, Axis, Band, Chart, Figure, Line, Points

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import HERE as EVIDENCE
from shared import PAIR, write_image, write_table

COVERAGE = 3
SPEEDS = [0.04, 0.08, 0.16, 0.3]
ROUGH = [0.1, 0.2, 0.5]  # Rq, µm
ENERGIES = [0, 0.09]  # work of adhesion, J/m²; the paper's is the last
KEYS = "rms_um", "work_of_adhesion", "velocity_m_per_s"
RESULTS = "restitution", "restitution_5", "restitution_95"
TABLE = "run_in/figure_10.csv"


def case(rms: float, energy: float, speed: float) -> dict:
    return {
        "total_error": False,
        "first": {
            "radius": "500 um",
            "youngs_modulus": "210 GPa",
            "poissons_ratio": 0.25,
            "density": "7850 kg/m^3",
        },
        "interface": {
            "yield_pressure": "750 MPa",
            "work_of_adhesion": f"{energy} J/m^2",
            **({"adhesion": "jkr"} if energy else {}),
        },
        "roughness": {
            "kind": "gaussian",
            "rms": f"{rms} um",
            "correlation_length": "2 um",
            "seed": 1,
        },
        "grid": {"nodes": 256, "spacing": "0.25 um"},
        "impact": {"velocity": f"{speed} m/s"},
        "impacts": {"coverage": COVERAGE, "places": 12, "rough": "first"},
    }


def rows_of(rms: float, energy: float, speed: float) -> list[dict]:
    common = {"rms_um": rms, "work_of_adhesion": energy, "velocity_m_per_s": speed}
    if rms == 0:
        e = round(of_smooth(energy, speed), 4)
        return [{**common, "coverage": 0, **dict.fromkeys(RESULTS, e)}]
    return [
        {**common, "coverage": round(point.coverage)}
        | {name: round(getattr(point, name), 4) for name in RESULTS}
        for point in run(case(rms, energy, speed)).run_in
    ]


def of_smooth(energy: float, speed: float) -> float:
    grid = Grid((256, 256), (0.25e-6, 0.25e-6))
    adhesion = JKRLimit(energy) if energy else None
    contact = Contact(
        PAIR, Surface(np.zeros(grid.nodes), grid), ConstantBound(750e6), adhesion, yields="first"
    )
    return RunIn(contact).hit(speed, (0, 0), (0, 0)).restitution


def main() -> None:
    warnings.simplefilter("ignore")
    path = EVIDENCE / TABLE
    rows = list(csv.DictReader(path.open(newline=""))) if path.exists() else []
    known = {tuple(float(row[name]) for name in KEYS) for row in rows}
    for rms, energy, speed in itertools.product([0, *ROUGH], ENERGIES, SPEEDS):
        if (rms, energy, speed) not in known:
            rows += rows_of(rms, energy, speed)
            print(rows[-2:], flush=True)
            write_table(TABLE, rows)
    draw([row for row in rows if float(row["work_of_adhesion"]) == ENERGIES[-1]])


def draw(rows: list[dict]) -> None:
    panels = []
    for coverage, title in ((0, "first impact"), (COVERAGE, f"after coverage {COVERAGE}")):
        V, e, *_ = columns(rows, 0, 0)
        series = [Line(V, e, "smooth", color=GREY)]
        for rms, color in zip(ROUGH, PALETTE, strict=False):
            V, e, low, high = columns(rows, rms, coverage)
            series += [
                Band(V, low, high, color=color),
                Points(V, e, f"Rq {rms} µm", color=color, joined=True),
            ]
        axis = Axis("impact velocity", "m/s", "log", 0.9 * SPEEDS[0], 1.1 * SPEEDS[-1])
        panels.append((axis, series, title))
    both = cor_axis([part for _, series, _ in panels for part in series])
    write_image("run-in", Figure("", [Chart(x, both, series, t) for x, series, t in panels]))


def columns(rows: list[dict], rms: float, coverage: float) -> list[np.ndarray]:
    of = [r for r in rows if float(r["rms_um"]) == rms and float(r["coverage"]) == coverage]
    names = ("velocity_m_per_s", *RESULTS)
    return [np.array([float(row[name]) for row in of]) for name in names]


if __name__ == "__main__":
    main()
