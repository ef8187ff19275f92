"""Time adhesive impacts near sticking, and `converge`, with two versions of the program.

`python benchmarks/adhesion.py OTHER` measures this version and the version in the folder OTHER, in
turn and in separate processes. To make OTHER, use `git archive COMMIT src | tar x -C OTHER` and
copy the compiled kernels; its processes run with PYTHONPATH=OTHER/src. The results are in
benchmarks/adhesion.md.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent.parent / "src"
BODY = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
work_of_adhesion = "0.09 J/m^2"
yield_pressure = "{hardness}"
[grid]
nodes = {nodes}
spacing = "{spacing}"
"""
# Twelve velocities from 0.8 to 20 times the sticking velocity (0.29 mm/s). The pull-off radius is
# 12.7 cells.
VELOCITIES = """
[impact]
from = "0.2326 mm/s"
to = "5.816 mm/s"
steps = 12
"""
DEPTHS = """
[indentation]
from = "2.5 nm"
to = "17 nm"
steps = 6
"""
CASES = {
    "velocities, elastic": (BODY + VELOCITIES, "elastic", 128, "44.2 nm", 1),
    "velocities, yields at 3 GPa": (BODY + VELOCITIES, "3 GPa", 128, "48 nm", 1),
    "converge to 256^2": (BODY + DEPTHS, "elastic", 64, "88.4 nm", 3),
    "converge to 512^2": (BODY + DEPTHS, "elastic", 128, "44.2 nm", 3),
    "converge to 1024^2": (BODY + DEPTHS, "elastic", 256, "22.1 nm", 3),
}


def measure(name: str) -> dict[str, float]:
    """CPU time (s), convolutions and COR of a case, in this process."""
    import tempfile
    import time

    from restitution.case.case import Case
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.convergence import run_convergence
    from restitution.runs.run import run_case

    template, hardness, nodes, spacing, grids = CASES[name]
    keys = Case.model_fields["interface"].annotation.model_fields
    if "adhesion" in keys:  # older versions only have the model "jkr"
        template = template.replace("[interface]\n", '[interface]\nadhesion = "jkr"\n')
    text = "total_error = false\n" + template.format(
        hardness=hardness, nodes=nodes, spacing=spacing
    )
    case = parse_case(text)
    with tempfile.TemporaryDirectory() as folder:
        out = ResultsFolder(Path(folder) / "out")
        began, wall = time.process_time(), time.perf_counter()
        if grids == 1:
            summary = run_case(case, text, Path(), out)
        else:
            summary = run_convergence(case, text, Path(), out, grids)
        return {
            "cpu_s": time.process_time() - began,
            "wall_s": time.perf_counter() - wall,
            "convolutions": summary["convolutions"],
            "restitution": [row["restitution"] for row in out.rows],
            "restitution_error": [row["restitution_error"] for row in out.rows],
        }


def main() -> None:
    """Measure cases with both versions of the program, and print a table.

    The arguments of the command are the folder of the other version and then the names of the
    cases, by default all of them.
    """
    if sys.argv[1] == "--measure":
        print(json.dumps(measure(sys.argv[2])))
        return
    other, names = Path(sys.argv[1]) / "src", sys.argv[2:] or list(CASES)
    print("| case | other, CPU s | this, CPU s | ratio | convolutions | largest change of COR |")
    print("|---|---|---|---|---|---|")
    for name in names:
        found = []
        for source in (other, HERE):
            environment = {**os.environ, "PYTHONPATH": str(source)}
            command = [sys.executable, __file__, "--measure", name]
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, check=True
            )
            found.append(json.loads(done.stdout.splitlines()[-1]))
        old, new = found
        change = max(
            abs(a - b) for a, b in zip(old["restitution"], new["restitution"], strict=True)
        )
        ratio = old["convolutions"] / new["convolutions"]
        print(
            f"| {name} | {old['cpu_s']:.1f} | {new['cpu_s']:.1f} "
            f"| {old['cpu_s'] / new['cpu_s']:.1f} | {ratio:.1f} times fewer | {change:.4f} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
