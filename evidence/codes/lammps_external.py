"""The exported Python contact inside LAMMPS, as `fix external`, at five velocities.

    LD_LIBRARY_PATH=.venv/lib python -m evidence.codes.lammps_external

LD_LIBRARY_PATH is the folder of the libmpi.so.12 of `mpich`. Writes lammps_external.csv.
"""

from __future__ import annotations

import importlib.util
import tempfile
from pathlib import Path

import numpy as np

from evidence.codes.laws import ROUGH, STICKY, law_of_case
from evidence.shared import write_table
from restitution.dem.export import export, write_export
from restitution.laws.law import Law

STEPS = 50


def rebound(law: Law, contact_of_law, V: float) -> float:
    """e of two spheres in LAMMPS whose only force is that of the contact."""
    from lammps import lammps

    pair = contact_of_law.PAIRS[1, 1]
    R, density = law.first.radius, law.first.density
    dt = 2.87 * (pair.mass**2 / (pair.radius * pair.modulus**2 * V)) ** 0.2 / STEPS
    run = lammps(cmdargs=["-log", "none", "-screen", "none"])
    run.commands_string(f"""
units si
atom_style sphere
atom_modify map array
boundary f f f
region box block {-8 * R} {8 * R} {-8 * R} {8 * R} {-8 * R} {8 * R}
create_box 1 box
create_atoms 1 single 0 0 {R + 0.3 * V * dt}
create_atoms 1 single 0 0 {-R}
set group all diameter {2 * R} density {density}
group one id 1
velocity one set 0 0 {-V} units box
pair_style zero {3 * R} nocoeff
pair_coeff * *
neighbor {0.1 * R} bin
timestep {dt}
fix move all nve
fix law all external pf/callback 1 1
""")
    state = {"contact": contact_of_law.apart(1)}

    def force(caller, step, count, tags, x, f):
        first, second = int(np.flatnonzero(tags == 1)[0]), int(np.flatnonzero(tags == 2)[0])
        v = run.numpy.extract_atom("v")
        indentation = 2 * R - np.array([x[first, 2] - x[second, 2]])
        rate = np.array([v[second, 2] - v[first, 2]])
        if step == 0:
            return
        pushed, state["contact"] = contact_of_law.normal(
            pair, state["contact"], indentation, rate, dt
        )
        f[first, 2], f[second, 2] = pushed[0], -pushed[0]

    run.set_fix_external_callback("law", force, run)
    run.command(f"run {10 * STEPS}")
    v = run.gather_atoms("v", 1, 3)
    stuck = bool(state["contact"].branch[0])
    run.close()
    return 0.0 if stuck else (v[2] - v[5]) / V


if __name__ == "__main__":
    rows = []
    for name, text in (("rough", ROUGH), ("adhesive", STICKY)):
        law = law_of_case(text)
        with tempfile.TemporaryDirectory() as place:
            write_export(export([law], "python", None), Path(place))
            path = Path(place) / "restitution_contact.py"
            spec = importlib.util.spec_from_file_location("contact_of_law", path)
            module = importlib.util.module_from_spec(spec)
            spec.loader.exec_module(module)
            for V in np.geomspace(1.3 * law.lowest, 0.9 * law.highest, 5):
                rows.append({
                    "law": name,
                    "velocity_m_per_s": f"{V:.4g}",
                    "law_e": f"{law.at(float(V)).restitution:.5f}",
                    "lammps_e": f"{rebound(law, module, float(V)):.5f}",
                })  # fmt: skip
                print(rows[-1], flush=True)
    write_table("codes/lammps_external.csv", rows)
