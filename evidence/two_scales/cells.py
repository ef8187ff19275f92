r"""Adhesive patches on smaller cells: are the cells needed that `adhesion_resolved` asks for?

    python -m evidence.two_scales.cells

appends to cells.csv a row for each velocity of random rough spheres. The split and the patches stay
the same; the cells and the blocks become smaller.
"""

from __future__ import annotations

import csv
import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from restitution.case.case_file import parse_case
from restitution.collision import collide
from restitution.contact.checks.resolution import adhesive_spacing
from restitution.contact.contact import Contact
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.errors import RestitutionError

TABLE = Path(__file__).with_suffix(".csv")
CASES, FINER = 8, (1, 2, 4)
VELOCITIES = (0.03, 0.15, 0.6)
COLUMNS = (
    "case",
    "material",
    "radius_um",
    "rms_nm",
    "split_nm",
    "velocity",
    "cell_nm",
    "cell_over_needed",
    "pull_off_nN",
    "cor",
    "seconds",
)
CASE = """
total_error = false
first = {{ material = "{material}", radius = "{radius} um" }}
[interface]
work_of_adhesion = "{w} J/m^2"
[roughness]
kind = "self-affine"
rms = "{rms} nm"
hurst = 0.8
rolloff = "{rolloff} nm"
shortest = "{shortest} nm"
seed = {seed}
below_grid = "patch"
split = "{split} nm"
[grid]
nodes = 96
spacing = "{cell} nm"
[impact]
from = "0.03 m/s"
to = "0.6 m/s"
steps = 2
"""


def draw(seed: int) -> dict[str, object]:
    rng = np.random.default_rng(1000 + seed)
    values = {
        "seed": seed,
        "material": ("silica", "lactose")[seed % 2],
        "radius": 10 ** rng.uniform(0.3, 1.1),
        "rms": 10 ** rng.uniform(-0.2, 0.9),
        "w": rng.uniform(0.02, 0.08),
        "cell": rng.uniform(6, 20),
    }
    cell = float(values["cell"])
    shortest, rolloff = cell * rng.uniform(1, 2), cell * rng.uniform(10, 60)
    return values | {"split": 4 * cell, "shortest": shortest, "rolloff": rolloff}


def contact_of(values: dict[str, object], finer: int) -> Contact:
    contact = parse_case(CASE.format(**values)).refined(finer).contact(Path())
    law = contact.adhesion
    return replace(contact, adhesion=replace(law, patches=law.patches[:1]))


def rows_of(seed: int) -> list[dict[str, object]]:
    values, rows = draw(seed), []
    for finer in FINER:
        state, began = None, time.process_time()
        try:
            contact = contact_of(values, finer)
            cell = max(contact.grid.spacing)
            for velocity in VELOCITIES:
                state = solve_at_velocity(contact, velocity, start=state)
                collision = collide(state)
                told = (
                    seed,
                    values["material"],
                    f"{values['radius']:.3g}",
                    f"{values['rms']:.3g}",
                    f"{values['split']:.3g}",
                    velocity,
                    f"{1e9 * cell:.3g}",
                    f"{cell / adhesive_spacing(state):.2f}",
                    f"{1e9 * collision.pull_off_force:.4g}",
                    f"{collision.restitution:.4f}",
                    f"{time.process_time() - began:.1f}",
                )
                rows.append(dict(zip(COLUMNS, told, strict=True)))
        except RestitutionError as error:  # cells too coarse for the range, or no separate scales
            print(seed, finer, str(error)[:90], flush=True)
    return rows


def main() -> None:
    """Append the cases that the table lacks."""
    new = not TABLE.exists()
    known = [] if new else list(csv.DictReader(TABLE.read_text().splitlines()))
    for seed in sorted(set(range(CASES)) - {int(row["case"]) for row in known}):
        rows = rows_of(seed)
        with open(TABLE, "a", newline="") as file:
            writer = csv.DictWriter(file, COLUMNS, lineterminator="\n")
            if new and rows:
                writer.writeheader()
                new = False
            writer.writerows(rows)


if __name__ == "__main__":
    main()
