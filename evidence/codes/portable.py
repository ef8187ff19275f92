"""The portable contact: e at any time step, and 10^5 random sequences without gain of energy.

    python -m evidence.codes.portable

Writes portable.csv. Needs GCC. Takes two minutes.
"""

from __future__ import annotations

import shutil
import subprocess
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

from evidence.codes.laws import ROUGH, STICKY, law_of_case
from evidence.shared import write_table
from restitution.dem.export import export, write_export
from restitution.laws.law import Law

SEQUENCES = 100_000
STEPS = (20, 30, 50, 200, 1000)
HARNESS = Path(__file__).parents[2] / "tests" / "dem" / "reapproach.c"


def elastic(law: Law) -> Law:
    """`law` with e = 1."""
    points = tuple(replace(p, restitution=1.0, ratio=1.0, separation=0.0) for p in law.points)
    return replace(law, points=points)


def measure(name: str, law: Law) -> dict[str, str]:
    """Largest error of e and largest gain of energy of one law."""
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_export(export([law], "c", None), folder)
        shutil.copy(HARNESS, folder)
        for source in ("collide.c", "reapproach.c"):
            command = ["gcc", "-O2", source, "-o", source[:-2], "-lm"]
            subprocess.run(command, cwd=folder, check=True)
        worst = 0.0
        for V in np.geomspace(law.lowest, law.highest, 20):
            e = law.at(float(V)).restitution
            for steps in STEPS:
                said = _printed(folder / "collide", f"{V:.12g}", "1", "1", str(steps))
                worst = max(worst, abs(float(said.split()[2]) - e))
        ended, gain = _printed(folder / "reapproach", str(SEQUENCES)).split()
    return {
        "law": name,
        "largest_error_of_e": f"{worst:.2g}",
        "sequences": str(SEQUENCES),
        "ended": ended,
        "largest_gain_over_kinetic_energy": gain,
    }


def _printed(*command: str | Path) -> str:
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


if __name__ == "__main__":
    rough = law_of_case(ROUGH)
    rows = [measure("rough", rough), measure("adhesive", law_of_case(STICKY)),
            measure("elastic", elastic(rough))]  # fmt: skip
    write_table("codes/portable.csv", rows)
    for row in rows:
        print(row)
