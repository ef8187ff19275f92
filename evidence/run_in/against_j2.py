"""The impacts of `j2.py` with this program: COR of each, under both models of plasticity."""

import json
import math
import sys
from pathlib import Path

import numpy as np

from restitution import (
    Body,
    ConstantBound,
    Contact,
    ExpandingCavity,
    Grid,
    Pair,
    RunIn,
    Surface,
    solve_at_velocity,
)

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import HERE as EVIDENCE
from shared import write_table

ROUGH, OWN = EVIDENCE / "rough_plastic" / "data", EVIDENCE / "run_in" / "data"
RADIUS, SPEED = 500e-6, 0.1
MODELS = {"growing": ExpandingCavity(1e9), "constant": ConstantBound(2.8e9)}


def rows_of(path: Path) -> list[dict]:
    data = json.loads(path.read_text())
    grid = json.loads((ROUGH / f"{data['surface']}.json").read_text())["grid"]
    nodes, spacing = grid["nodes"], grid["spacing_m"]
    heights = np.load(ROUGH / f"{data['surface']}_heights.npy").astype(float)
    surface = Surface(heights, Grid((nodes, nodes), (spacing, spacing)))
    works = [impact["loading_work_J"] for impact in data["impacts"]]
    density = 2 * works[0] / SPEED**2 / (4 / 3 * math.pi * RADIUS**3)
    rigid = Body(RADIUS, 1e20, 0.3, density)
    pair = Pair(Body(math.inf, 210e9, 0.3), rigid)
    runs = {
        name: RunIn(Contact(pair, surface, plasticity=model, yields="first"))
        for name, model in MODELS.items()
    }
    table = []
    for impact, work in zip(data["impacts"], works, strict=True):
        V, e = math.sqrt(2 * work / rigid.mass), impact["restitution"]
        at = tuple(nodes // 2 + shift for shift in impact["shift_nodes"])
        row = {"case": data["case"], "impact": impact["impact"], "work_nJ": round(1e9 * work, 1)}
        row |= {"j2": round(e, 4)}
        worn = runs["growing"].surfaces[0].height
        worn = Surface(np.roll(worn, [nodes // 2 - k for k in at], (0, 1)), surface.grid)
        state = solve_at_velocity(Contact(pair, worn, plasticity=MODELS["growing"]), V)
        forgetful = math.sqrt(state.stored_energy / state.loading_work)
        for name, run in runs.items():
            here = run.hit(V, at, at).restitution
            row |= {name: round(here, 4), f"{name}_off_%": round(100 * (here / e - 1), 1)}
        row["without_memory_off_%"] = round(100 * (forgetful / e - 1), 1)
        print(row, flush=True)
        table.append(row)
    return table


def main() -> None:
    paths = sorted(OWN.glob("*.json"))
    write_table("run_in/against_j2.csv", [row for path in paths for row in rows_of(path)])


if __name__ == "__main__":
    main()
