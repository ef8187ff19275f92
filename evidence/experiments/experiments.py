"""Measured restitution beside what the program computes from the stated inputs.

    python -m evidence.experiments.experiments

`measured.csv` has the measurements: `read` is "yes" if the number was read in the named source,
and `counted` why a row does not count. `strength` is H (a hardness, from which Y = H/2.8), Y (a
yield strength), p (a constant limit of the pressure) or "elastic". Writes `computed.csv`, other
conversions of the Vickers hardness (`conversions.csv`), and the figure of docs/experiments.md.
Takes some minutes.
"""

from __future__ import annotations

import csv
import math
import tempfile
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

from evidence.shared import write_image, write_table
from restitution.case.case_file import parse_case
from restitution.case.derived import deepest_indentation
from restitution.contact.checks.resolution import predicted_radius
from restitution.plots.figure import BLUE, GREY, ORANGE, Axis, Chart, Figure, Line, Points
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case

HERE = Path(__file__).parent
NODES = 128
KEYS = {"H": "hardness", "Y": "yield_strength", "p": "yield_pressure"}
FITTED = "fitted at 1 m/s"
CONVERSIONS = {"H/3": ("Y", 3.0), "H/2.5": ("Y", 2.5), "H/2.2": ("Y", 2.2), "p_y = H": ("p", 1.0)}


def case_text(row: dict[str, str], time: float, width: float = 1e-3) -> str:
    """The case of a row; `time` (s) is the relaxation time of both bodies."""
    radius = float(row["radius_mm"])
    density = float(row["rho1"] or 0) or float(row["mass_g"]) / (4 / 3 * math.pi * radius**3 * 1e-6)
    kind, _, strength = row["strength"].partition(" ")
    second = (row["E2_GPa"], row["nu2"], row["rho2"], '"flat"')
    if not row["E2_GPa"]:
        second = (row["E1_GPa"], row["nu1"], row["rho1"], f'"{radius} mm"')
    bodies = [(row["E1_GPa"], row["nu1"], f"{density!r}", f'"{radius} mm"'), second]
    lines = []
    for name, (E, nu, rho, size) in zip(("first", "second"), bodies, strict=True):
        lines += [f"[{name}]", f"radius = {size}", f'youngs_modulus = "{E} GPa"']
        lines += [f"poissons_ratio = {nu}"]
        lines += [f'density = "{rho} kg/m^3"'] if rho else []
        lines += [f'relaxation_time = "{time!r} s"'] if time else []
        if name == "first" and row["H1_GPa"]:
            lines += [f'hardness = "{row["H1_GPa"]} GPa"']
        if name == "second" and kind == "H":
            lines += [f'hardness = "{strength}"', 'yield_strength = "H/2.8"']
        if name == "second" and kind == "Y":
            lines += [f'yield_strength = "{strength}"']
    lines += ["[interface]"]
    if kind in ("p", "elastic"):
        lines += [f'yield_pressure = "{strength or "elastic"}"']
    lines += ["[grid]", f"nodes = {NODES}", f'spacing = "{width / NODES!r} m"']
    lines += ["[impact]", f'velocity = "{float(row["velocity_m_s"])!r} m/s"']
    return "\n".join(lines) + "\n"


def computed(row: dict[str, str], time: float = 0.0, errors: bool = True):
    """The point of the curve, on a grid as wide as the contact needs."""
    first = parse_case(case_text(row, time))
    radius = predicted_radius(first.pair(), deepest_indentation(first), first.yielding().hardness)
    text = f"total_error = {str(errors).lower()}\n" + case_text(row, time, 2.8 * radius)
    with tempfile.TemporaryDirectory() as folder:
        out = ResultsFolder(Path(folder) / "out")
        run_case(parse_case(text), text, HERE, out)
        return out.curve.points[0]


def relaxation_time(row: dict[str, str]) -> float:
    """The relaxation time (s) of both bodies that returns the measured value of `row`."""
    measured = float(row["e"])
    return float(
        brentq(lambda t: computed(row, t, errors=False).final - measured, 1e-6, 1e-4, xtol=1e-9)
    )


def conversions(measured: list[dict[str, str]]) -> None:
    """Restitution with other yield strengths or pressures from the Vickers hardness of steel."""
    rows = []
    for row in measured:
        if not row["id"].startswith("rebound-hv"):
            continue
        _, hardness, unit = row["strength"].split()
        e = {}
        for name, (kind, ratio) in CONVERSIONS.items():
            strength = f"{kind} {float(hardness) / ratio!r} {unit}"
            e[name] = round(computed(row | {"strength": strength}, errors=False).final, 4)
        rows.append({"id": row["id"], "measured": float(row["e"]), **e})
    write_table("experiments/conversions.csv", rows)
    for name in CONVERSIONS:
        off = np.array([row[name] - row["measured"] for row in rows])
        print(f"{name}: mean {off.mean():+.3f}, largest {np.abs(off).max():.3f}")


def main() -> None:
    with open(HERE / "measured.csv", newline="") as file:
        measured = list(csv.DictReader(file))
    time = next(relaxation_time(row) for row in measured if row["counted"] == FITTED)
    rows = []
    for row in measured:
        viscous = row["set"] == "croquet ball on wood"
        point = computed(row, time if viscous else 0.0)
        e, here = float(row["e"]), point.final
        error = math.hypot(point.combined_error, point.model_error, point.loss_error)
        rows.append(
            {
                "id": row["id"],
                "set": row["set"],
                "counted": row["counted"],
                "velocity_m_s": row["velocity_m_s"],
                "measured": e,
                "computed": round(here, 4),
                "quasi_static": round(point.restitution, 4),
                "waves_factor": round(point.waves_factor, 4),
                "viscosity_factor": round(point.viscosity_factor, 4),
                "total_error": round(point.combined_error, 4),
                "model_error": round(point.model_error, 4),
                "difference": round(here - e, 4),
                "inside": abs(here - e) <= error + float(row["uncertainty"] or 0),
            }
        )
        print(*rows[-1].values(), flush=True)
    write_table("experiments/computed.csv", rows)
    print(f"relaxation time {time:.4g} s")
    for name in dict.fromkeys(row["set"] for row in rows):
        own = [row for row in rows if row["set"] == name]
        off = np.array([row["difference"] for row in own])
        inside = sum(row["inside"] for row in own)
        print(
            f"| {name} | {len(own)} | {off.mean():+.3f} | {np.abs(off).max():.3f} "
            f"| {inside} of {len(own)} | {own[0]['counted']} |"
        )
    conversions(measured)
    write_image("experiments", figure(rows))


def figure(rows: list[dict]) -> Figure:
    counted = [row for row in rows if not row["counted"].startswith("no")]
    others = [row for row in rows if row["counted"].startswith("no")]

    def points(own: list[dict], label: str, color: str) -> Points:
        x, y = (np.array([row[name] for row in own]) for name in ("measured", "computed"))
        error = np.array([row["total_error"] for row in own])
        return Points(x, y, label, color=color, error=np.array([error, error]))

    line = Line(np.array([0.0, 1.0]), np.array([0.0, 1.0]), "equal", color=GREY)
    rebound = [row for row in counted if row["set"].startswith("rebound")]
    rest = [row for row in counted if not row["set"].startswith("rebound")]
    return Figure(
        "",
        [
            Chart(
                Axis("measured restitution", "", low=0.0, high=1.02),
                Axis("computed restitution", "", low=0.0, high=1.02),
                [
                    line,
                    points(rebound, "rebound hardness", BLUE),
                    points(rest, "other sets", ORANGE),
                    points(others, "not counted", GREY),
                ],
            )
        ],
    )


if __name__ == "__main__":
    main()
