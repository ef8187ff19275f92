"""CPU time and memory of 1000 impacts on 256² nodes, for both models of plasticity."""

import resource
import sys
import time
from itertools import islice
from pathlib import Path

from restitution import ConstantBound, Contact, ExpandingCavity, Grid, RunIn, generate_surface

sys.path.insert(0, str(Path(__file__).parents[1]))
from shared import PAIR, write_table

IMPACTS, SPEED = 1000, 0.05


def resident() -> int:
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024


def main() -> None:
    grid = Grid((256, 256), (0.25e-6, 0.25e-6))
    waves = {"kind": "gaussian", "rms": 0.1e-6, "correlation_length": (2e-6, 2e-6), "seed": 1}
    surface, rows = generate_surface(grid, **waves), []
    for model in (ConstantBound(0.75e9), ExpandingCavity(0.75e9 / 2.8)):
        runs = RunIn(Contact(PAIR, surface, plasticity=model, yields="first"))
        hits = runs.impacts(SPEED)
        for _ in islice(hits, 100):
            pass
        before, begun = resident(), time.process_time()
        for _ in islice(hits, IMPACTS):
            pass
        rows.append(
            {
                "plasticity": model.label,
                "impacts": IMPACTS,
                "cpu_s": round(time.process_time() - begun, 1),
                "growth_of_peak_memory_MB": resident() - before,
            }
        )
        print(rows[-1], flush=True)
        write_table("run_in/speed.csv", rows)


if __name__ == "__main__":
    main()
