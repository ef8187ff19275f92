"""Figure 10 of Ghanbarzadeh et al. (2019), new and run in: COR of rough spheres, side by side."""

import sys
import warnings
from pathlib import Path

import numpy as np

from restitution import run
from restitution.plots.cor import cor_axis
from restitution.plots.figure import GREY, PALETTE, Axis, Band, Chart, Figure, Line, Points

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import write_image, write_table

COVERAGE = 3
SPEEDS = [0.04, 0.08, 0.16, 0.3]
ROUGH = [0.1, 0.2, 0.5]  # Rq, µm


def case(rms: float) -> dict:
    return {
        "total_error": False,
        "first": {
            "radius": "500 um",
            "youngs_modulus": "210 GPa",
            "poissons_ratio": 0.25,
            "density": "7850 kg/m^3",
        },
        "interface": {"yield_pressure": "750 MPa", "work_of_adhesion": "0 J/m^2"},
        "roughness": {
            "kind": "gaussian",
            "rms": f"{rms} um",
            "correlation_length": "2 um",
            "seed": 1,
        },
        "grid": {"nodes": 256, "spacing": "0.25 um"},
        "impact": {"velocity": [f"{V} m/s" for V in SPEEDS]},
        "impacts": {"coverage": COVERAGE, "places": 12, "rough": "first"},
    }


def main() -> None:
    warnings.simplefilter("ignore")
    rows, smooth = [], None
    for rms in ROUGH:
        results = run(case(rms))
        if smooth is None:
            data = results.dataset
            smooth = np.array([data["smooth_impact_velocity"], data["smooth_restitution"]])
            rows += [
                {"rms_um": 0, "velocity_m_per_s": V, "coverage": 0, "restitution": round(e, 4)}
                | {"restitution_5": round(e, 4), "restitution_95": round(e, 4)}
                for V in SPEEDS
                for e in [float(np.interp(V, *smooth))]
            ]
        for point in results.run_in:
            rows.append(
                {
                    "rms_um": rms,
                    "velocity_m_per_s": point.velocity,
                    "coverage": round(point.coverage),
                    "restitution": round(point.restitution, 4),
                    "restitution_5": round(point.restitution_5, 4),
                    "restitution_95": round(point.restitution_95, 4),
                }
            )
            print(rows[-1], flush=True)
        write_table("run_in/figure_10.csv", rows)
    draw(rows)


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
    names = ("velocity_m_per_s", "restitution", "restitution_5", "restitution_95")
    return [np.array([float(row[name]) for row in of]) for name in names]


if __name__ == "__main__":
    main()
