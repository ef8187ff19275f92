"""What LAMMPS, LIGGGHTS and YADE return for a 6 mm steel ball on steel walls of 10 to 2 mm.

    python -m evidence.losses.codes

Writes `codes.csv`. `mpich` of the Python environment must be findable for LAMMPS.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

from evidence.codes.laws import law_of_case
from evidence.dem.dem import COMMANDS, rebound
from evidence.losses.losses import STEEL
from evidence.shared import write_table
from restitution.dem.export import export, write_export

VELOCITY = 0.999  # m/s


def main() -> None:
    rows = []
    for thickness in (10, 5, 3, 2):
        text = STEEL.format(
            thickness=thickness,
            tangent=0.01,
            interface="yield_strength = '2 GPa'",
            roughness="",
        ).replace("steps = 5", "steps = 2")
        law = law_of_case(text)
        row = {
            "thickness_mm": thickness,
            "quasi_static": round(law.points[-1].quasi_static, 4),
            "product": round(law.at(VELOCITY).restitution, 4),
        }
        with tempfile.TemporaryDirectory() as folder:
            place = Path(folder)
            for code in COMMANDS:
                write_export(export([law], code, VELOCITY), place / code)
                row[code] = rebound(code, place / code)
        rows.append(row)
        print(*row.values(), flush=True)
    write_table("losses/codes.csv", rows)


if __name__ == "__main__":
    main()
