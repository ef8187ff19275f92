"""Adhesive exports in LAMMPS, LIGGGHTS and YADE: a powder that sticks, and a rough one.

    python -m evidence.codes.adhesive

Needs LIGGGHTS, YADE and `lmp`, and for it `mpich` of the Python environment. Writes adhesive.csv.
"""

from __future__ import annotations

import math
import re
import tempfile
from pathlib import Path

import numpy as np

from evidence.codes.laws import law_of_case
from evidence.dem.dem import rebound
from evidence.shared import write_table
from restitution.dem.export import ADHESIVE, export, write_export
from restitution.laws.law import Law

LACTOSE = """
title = "Lactose of 2 um, Rq 2 nm"
total_error = false
[first]
material = "lactose"
radius = "2 um"
[interface]
work_of_adhesion = "0.1 J/m^2"
adhesion = "cohesive"
[roughness]
kind = "gaussian"
rms = "2 nm"
correlation_length = "0.1 um"
seed = 1
[grid]
nodes = 140
spacing = "6.8 nm"
refine = 2
[impact]
from = "0.02 m/s"
to = "1 m/s"
steps = 7
[unloading]
curves = 2
"""
SILICA = """
title = "Silica of 5 um, Rq 10 nm"
total_error = false
[first]
material = "silica"
radius = "5 um"
[interface]
work_of_adhesion = "0.05 J/m^2"
adhesion = "cohesive"
[roughness]
kind = "gaussian"
rms = "10 nm"
correlation_length = "0.3 um"
seed = 1
[grid]
nodes = 96
spacing = "20 nm"
refine = 4
[impact]
from = "0.01 m/s"
to = "1 m/s"
steps = 6
[unloading]
curves = 2
"""


def compare(
    name: str, law: Law, V: float, codes: tuple[str, ...] = ADHESIVE
) -> list[dict[str, str]]:
    """e of the exports at `V` (m/s) beside the law at several velocities."""
    rows = []
    start = 1.2 * (law.sticks_below or law.lowest / 1.2)
    for code in codes:
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            write_export(export([law], code, V), folder)
            text = " ".join(
                next(folder.glob("restitution*.[lp]*")).read_text().replace("#", "").split()
            )
            sticks = re.search(r"; sticks below (\S+)", text)
            worst = re.search(r"e is off by up to ([\d.e-]+\d)", text)[1]
            for speed in [0.9 * start / 1.2, *np.geomspace(start, 0.95 * law.highest, 5)]:
                if speed < law.lowest:
                    continue
                program = code.removesuffix("-adhesive")
                variable = [] if program == "yade" else ["-var", "V"]
                e = rebound(program, folder, *variable, f"{speed:.6g}")
                rows.append({
                    "law": name,
                    "code": code,
                    "velocity_m_per_s": f"{speed:.4g}",
                    "law_e": f"{law.at(float(speed)).restitution:.4f}",
                    "code_e": "" if math.isnan(e) else f"{e:.4f}",
                    "law_sticks_below": f"{law.sticks_below or 0:.4g}",
                    "code_sticks_below": sticks[1] if sticks else "0",
                    "stated_largest_difference": worst,
                })  # fmt: skip
                print(rows[-1], flush=True)
    return rows


if __name__ == "__main__":
    lactose, silica = law_of_case(LACTOSE), law_of_case(SILICA)
    for law in (lactose, silica):
        print(
            law,
            [(round(p.velocity, 4), round(p.restitution, 3), p.pull_off_force) for p in law.points],
        )
    rows = compare("lactose", lactose, 0.1) + compare("silica", silica, 0.1)
    write_table("codes/adhesive.csv", rows)
