"""A heap of 500 sticking particles in LAMMPS, and the same with the export without pull-off.

    python -m evidence.codes.heap

In a centrifuge of 1000 g, loose particles fall into a tube on a plate. Then the tube is taken away,
and at last the centrifuge turns over and pulls at the heap. Writes heap.csv.
Needs `lmp` and, for it, `mpich` of the Python environment.
"""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from evidence.codes.adhesive import LACTOSE
from evidence.codes.laws import law_of_case
from evidence.shared import write_table
from restitution.dem.export import export, write_export
from restitution.dem.pair import contact_time
from restitution.laws.law import Law

V = 0.1  # m/s
GRAVITY = 9810.0  # m/s²
COUNT = 500
FALL, FREE, TURNED = 3.0e-4, 1.0e-4, 1.0e-4  # s
FRAGMENTS = {"lammps-adhesive": "restitution_adhesive.lmp", "lammps": "restitution.lmp"}


def heap(law: Law, plate: Law, code: str) -> dict[str, str]:
    """What the heap with the export to `code` is like."""
    R, density = law.first.radius, law.first.density
    step = contact_time(law) * 0.5**-0.2 / 20
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        write_export(export([law, plate], code, V), folder)
        (folder / "heap.in").write_text(f"""
units si
atom_style sphere
boundary f f f
comm_modify vel yes
newton off
region box block {-60 * R} {60 * R} {-60 * R} {60 * R} {-30 * R} {60 * R} units box
create_box 1 box
include {FRAGMENTS[code]}
region column cylinder z 0 0 {9 * R} {1.1 * R} {34 * R} units box
create_atoms 1 random {COUNT} 77 column overlap {2.02 * R} maxtry 20000 units box
set group all diameter {2 * R} density {density}
velocity all set 0 0 {-V} units box
fix plate all wall/gran ${{wall_1_2}} zplane 0.0 NULL
fix tube all wall/gran ${{wall_1_2}} zcylinder {10 * R}
fix gravity all gravity {GRAVITY} vector 0 0 -1
fix move all nve/sphere
neighbor {0.3 * R} bin
timestep {step}
thermo 100000
thermo_modify lost ignore
run {int(FALL / step)}
unfix tube
run {int(FREE / step)}
write_dump all custom heap.txt id x y z vx vy vz
fix gravity all gravity {GRAVITY} vector 0 0 1
run {int(TURNED / step)}
write_dump all custom turned.txt id x y z vx vy vz
print "spheres = $(atoms)"
""")
        environment = os.environ | {
            "PATH": f"{Path(sys.executable).parent}:{os.environ['PATH']}",
            "LD_LIBRARY_PATH": str(Path(sys.prefix) / "lib"),
            "OMP_NUM_THREADS": "1",
        }
        done = subprocess.run(
            ["lmp", "-in", "heap.in"], cwd=folder, env=environment, capture_output=True, text=True
        )
        if done.returncode:
            raise SystemExit(done.stdout[-2000:])
        rest, after = read(folder / "heap.txt"), read(folder / "turned.txt")
    largest, contacts = clusters(rest[:, :3], R)
    away = np.hypot(rest[:, 0], rest[:, 1])
    hang = clusters(after[:, :3], R, plate=True)[0] if len(after) else 0.0
    return {
        "export": code,
        "particles": len(rest),
        "height_over_diameter": f"{np.quantile(rest[:, 2], 0.95) / (2 * R) + 0.5:.1f}",
        "half_width_over_diameter": f"{np.quantile(away, 0.95) / (2 * R) + 0.5:.1f}",
        "contacts_per_particle": f"{contacts:.2f}",
        "in_the_largest_clump": f"{largest:.3f}",
        "hang_after_turning": f"{hang:.3f}",
    }


def read(path: Path) -> np.ndarray:
    """Positions and velocities of a dump, by particle, shape (particles, 6)."""
    lines = path.read_text().splitlines()
    start = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS")) + 1
    return np.array([line.split()[1:7] for line in lines[start:]], dtype=float)


def clusters(x: np.ndarray, R: float, *, plate: bool = False) -> tuple[float, float]:
    """Share of all particles in the largest clump, or in those on the `plate`; contacts of each."""
    pairs = cKDTree(x).query_pairs(2 * R, output_type="ndarray")
    linked = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(x), len(x)))
    _, label = connected_components(linked, directed=False)
    sizes = np.bincount(label)
    held = sizes[np.unique(label[x[:, 2] < R])].sum() if plate else sizes.max()
    return float(held) / COUNT, 2 * len(pairs) / len(x)


if __name__ == "__main__":
    law = law_of_case(LACTOSE)
    plate = law_of_case(
        LACTOSE.replace("[first]", 'second = "lactose"\n[first]').replace(
            "nodes = 140", "nodes = 200"
        )
    )
    rows = []
    for code in FRAGMENTS:
        rows.append(heap(law, plate, code))
        print(rows[-1], flush=True)
    write_table("codes/heap.csv", rows)
