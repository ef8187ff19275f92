"""Repeated impacts of a rough sphere in 3D with Tamaas: at one place, and at shifted places.

Runs in the environment of ../rough_plastic (see its method.md). The roughness belongs to the body
that yields, so a shift moves the smooth sphere over the rough half-space, with all plastic strain
and residual stress of the impacts before. Each impact ends at the same loading work.
"""

import os

os.environ.setdefault("OMP_NUM_THREADS", "1")
import argparse
import json
import sys
import time
from pathlib import Path

import numpy as np
import tamaas as tm

HERE = Path(__file__).parent
ROUGH = HERE.parent / "rough_plastic"
sys.path.insert(0, str(ROUGH))

from solve import work  # noqa: E402

from contact import Contact, State  # noqa: E402

RADIUS = 500.0  # µm


class Movable(Contact):
    """A contact whose sphere can be moved, and that can be unloaded completely."""

    def solve_contact(self, force, traction, plastic):
        if force == 0:
            return np.zeros_like(traction)
        return super().solve_contact(force, traction, plastic)

    def move(self, shift):
        """Move the sphere to `shift` (nodes); the roughness stays on the half-space."""
        x, y = ((np.arange(self.n) - self.n // 2 - s) * self.cell for s in shift)
        self.r2 = x[:, None] ** 2 + y[None, :] ** 2
        self.surface = self.heights - self.r2 / (2 * RADIUS)
        self.guess[...] = 0
        self.last_step = 0.0


def impact(solver, wanted, first_force, steps, back):
    """Load to the work `wanted` (pJ), unload to zero force; return what was reached."""
    path, done, slope, k = [(solver.approach(), 0.0)], 0.0, 0.0, 0
    while wanted - done > 4e-3 * wanted:
        # A step never goes beyond the work, because `State` cannot take back plastic strain.
        k += 1
        before, last = State(solver), path[-1][1]
        force = max(first_force * (k / steps) ** 2, 1.001 * last)
        if slope and done + 1.1 * slope * (force - last) > wanted:
            force = last + 0.97 * (wanted - done) / (1.1 * slope)
        try:
            solver.step(force)
        except tm.FloatingPointError:  # a contact of one node, which the solver refuses
            before.restore(solver)
            continue
        path.append((solver.approach(), force))
        now = work(*np.array(path).T)
        slope, done = (now - done) / (force - last), now
    area = solver.area()
    down, top = [path[-1]], path[-1][1]
    solver.guess[...] = 0
    for s in np.arange(1, back + 1) / back:
        before, force = State(solver), top * (1 - s) ** 1.5 if s < 1 else 0.0
        try:
            solver.step(force)
        except tm.FloatingPointError:
            before.restore(solver)
            continue
        down.append((solver.approach(), force))
    loading, unloading = work(*np.array(path).T), -work(*np.array(down).T)
    return {
        "loading_work_J": loading * 1e-12,
        "unloading_work_J": unloading * 1e-12,
        "restitution": float(np.sqrt(unloading / loading)),
        "force_N": top * 1e-6,
        "indentation_m": (path[-1][0] - path[0][0]) * 1e-6,
        "contact_area_m2": area * 1e-12,
    }


def main():
    p = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    p.add_argument("name")
    p.add_argument("--surface", default="rough_b_coarse")
    p.add_argument("--work", type=float, default=21.0, help="loading work, nJ")
    p.add_argument("--force", type=float, default=0.2853, help="force of the first guess, N")
    p.add_argument("--shifts", type=int, nargs="+", default=[0, 0, 0, 0, 0, 0], help="nodes, x y …")
    p.add_argument("--steps", type=int, default=16)
    p.add_argument("--back", type=int, default=10)
    a = p.parse_args()
    model = json.loads((ROUGH / "data" / f"{a.surface}.json").read_text())
    grid = model["grid"]
    heights = np.load(ROUGH / "data" / f"{a.surface}_heights.npy").astype(float) * 1e6
    solver = Movable(
        heights,
        1e6 * grid["period_m"],
        1e6 * grid["depth_m"],
        grid["layers"],
        210e3,
        0.3,
        1000.0,
        RADIUS,
        tolerance=1e-4,
    )
    rows, start = [], time.time()
    for number, shift in enumerate(zip(a.shifts[::2], a.shifts[1::2], strict=True), 1):
        solver.move(shift)
        row = impact(solver, 1e3 * a.work, 1e6 * a.force, a.steps, a.back)
        rows.append({"impact": number, "shift_nodes": list(shift), **row})
        print(a.name, rows[-1], f"{time.time() - start:.0f} s", flush=True)
        out = {"case": a.name, "surface": a.surface, "impacts": rows}
        out["versions"] = {"tamaas": tm.__version__, "numpy": np.__version__}
        (HERE / "data" / f"{a.name}.json").write_text(json.dumps(out, indent=1) + "\n")


if __name__ == "__main__":
    main()
