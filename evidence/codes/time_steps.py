"""e that DEM codes return for e = 0.2, 0.5, 0.8 and 1, by the number of time steps in a contact.

    python -m evidence.codes.time_steps

Runs the exported collision of two glass spheres in LAMMPS, LIGGGHTS, YADE, MuJoCo and Kratos, from
four places between two steps, and keeps the value that is farthest off. Kratos is that of the
Python KRATOS_PYTHON (`make .venv-kratos/installed`). Writes time_steps.csv.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

from evidence.codes.laws import ROUGH, law_of_case
from evidence.dem.dem import CLEAN
from evidence.shared import write_table
from restitution.dem.export import export, write_export
from restitution.laws.law import Law

VALUES = (0.2, 0.5, 0.8, 1.0)
STEPS = (10, 20, 50, 100, 200)
PLACES = (5.0, 5.25, 5.5, 5.75)  # steps before first touch
V = 1.0
DRIVER = """
import json, sys
for name in json.load(open("jobs.json")):
    exec(open(name).read(), {"__name__": "__main__"})
"""


def program(*command: str, at: Path) -> list[float]:
    """Every e that a program prints."""
    clean = command[0] in ("liggghts", "yade")
    mine = {
        "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
        "LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"),
        "OMP_NUM_THREADS": "1",
    }
    environment = CLEAN | {"HOME": str(at)} if clean else os.environ | mine
    done = subprocess.run(command, cwd=at, env=environment, capture_output=True, text=True)
    said = re.findall(r"^restitution = (\S+)", done.stdout, re.MULTILINE)
    return [float(e) for e in said] or [float("nan")]


def in_lammps(at: Path, n: int) -> list[float]:
    text = (at / "collision.in").read_text().replace("v_contact/5000", f"v_contact/{n}")
    return [
        run_changed(
            at, text.replace("equal 4.5*$V", f"equal {place}*$V"), "lmp", "-log", "none", "-in"
        )
        for place in PLACES
    ]


def in_liggghts(at: Path, n: int) -> list[float]:
    text = (at / "collision.in.liggghts").read_text().replace("v_contact/5000", f"v_contact/{n}")
    text = text.replace("\nrun 100\n", "\nrun 1\n")
    return [
        run_changed(
            at, text.replace("v_Ri+5*", f"v_Ri+{place}*"), "liggghts", "-log", "none", "-in"
        )
        for place in PLACES
    ]


def in_mujoco(at: Path, n: int) -> list[float]:
    text = (at / "collision_mujoco.py").read_text()
    text = text.replace("CONTACT[I, J] / 500", f"CONTACT[I, J] / {n}")
    return [
        run_changed(at, text.replace("3.4 * V", f"{place} * V"), sys.executable) for place in PLACES
    ]


def in_kratos(at: Path, n: int) -> list[float]:
    text = (at / "collision_kratos.py").read_text().replace("contact / 500", f"contact / {n}")
    python = os.environ["KRATOS_PYTHON"]
    return [run_changed(at, text.replace("5 * V", f"{place} * V"), python) for place in PLACES]


def run_changed(at: Path, text: str, *command: str) -> float:
    """e of a changed collision."""
    (at / "changed").write_text(text)
    return program(*command, "changed", at=at)[0]


def in_yade(at: Path, n: int) -> list[float]:
    text = (at / "collision_yade.py").read_text().replace("** -0.2 / 2000", f"** -0.2 / {n}")
    names = []
    for place in PLACES:
        above = f"(0, 0, RADIUS[I] * (1 + {place} * V * CONTACT[I, J] / {n} / RADIUS[I]))"
        names.append(f"changed_{place}.py")
        (at / names[-1]).write_text(text.replace("(0, 0, RADIUS[I])", above))
    (at / "jobs.json").write_text(json.dumps(names))
    (at / "driver.py").write_text(DRIVER)
    return program("yade", "-n", "-x", "-j1", "driver.py", at=at)


RUN = {"lammps": in_lammps, "liggghts": in_liggghts, "yade": in_yade, "mujoco": in_mujoco}
if "KRATOS_PYTHON" in os.environ:
    RUN["kratos"] = in_kratos


def constant(law: Law, e: float) -> Law:
    points = tuple(
        replace(p, restitution=e, ratio=e**2, quasi_static=None, factors={}) for p in law.points
    )
    return replace(law, points=points, fit=None, laws=())


if __name__ == "__main__":
    law = law_of_case(ROUGH)
    rows = []
    for code, run in RUN.items():
        for e in VALUES:
            with tempfile.TemporaryDirectory() as place:
                folder = Path(place)
                write_export(export([constant(law, e)], code, V), folder)
                row = {"code": code, "e": f"{e:g}"}
                for n in STEPS:
                    row[f"{n}_steps"] = f"{max(run(folder, n), key=lambda x: abs(x - e)):.4f}"
            rows.append(row)
            print(row, flush=True)
            write_table("codes/time_steps.csv", rows)
