"""COR after many impacts: does it depend on the size of the surface, its seed, the order?"""

import sys
from pathlib import Path

import numpy as np

from restitution import ConstantBound, Contact, Grid, RunIn, generate_surface
from restitution.numerics.intervals import half_interval
from restitution.repeated.velocities import drawn, in_turn

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import PAIR, write_table

SPACING, COVERAGE, PLACES, PROBED = 0.25e-6, 6.0, 48, 0.1
WAVES = {"kind": "gaussian", "rms": 0.1e-6, "correlation_length": (2e-6, 2e-6)}


def measured(name: str, nodes: int, seed: int, speeds) -> dict:
    grid = Grid((nodes, nodes), (SPACING, SPACING))
    surface = generate_surface(grid, seed=seed, **WAVES)
    contact = Contact(PAIR, surface, plasticity=ConstantBound(0.75e9), yields="first")
    runs = RunIn(contact, seed=seed)
    hits = runs.impacts(speeds)
    while runs.coverage < COVERAGE:
        next(hits)
    e = np.array([one.restitution for one in runs.probe(PROBED, PLACES, seed + 1)])
    row = {
        "case": name,
        "nodes": nodes,
        "seed": seed,
        "impacts": runs.count,
        "restitution": round(float(e.mean()), 4),
        "half_interval": round(half_interval(PLACES) * float(e.std(ddof=1)), 4),
        "standard_deviation": round(float(e.std(ddof=1)), 4),
    }
    print(row, flush=True)
    return row


def main() -> None:
    rows = [measured("size", nodes, 1, in_turn([PROBED])) for nodes in (128, 192, 256, 384)]
    rows += [measured("seed", 256, seed, in_turn([PROBED])) for seed in (2, 3)]
    slow, fast = 0.05, 0.15
    rows.append(measured("in turn", 256, 1, in_turn([slow, fast])))
    rows.append(measured("drawn", 256, 1, drawn([slow, fast], [1, 1], 5)))
    rows.append(measured("size", 512, 1, in_turn([PROBED])))
    write_table("run_in/steady.csv", rows)


if __name__ == "__main__":
    main()
