"""CPU time of cohesive contacts beside one busy process per core, against one BLAS thread.

Libraries of linear algebra start a thread per core, and idle threads that wait in a loop cost CPU
time if the cores are busy. Writes benchmarks/busy.md, and fails above 1.2 times.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
from contextlib import contextmanager
from pathlib import Path

from unit import machine, today

OUT = Path(__file__).with_suffix(".md")
MOST = 1.2
REPEATS = 3
WORK = """
import restitution as rs
silica = rs.Body(radius=5e-6, youngs_modulus=70e9, poissons_ratio=0.17, density=2200)
grid = rs.Grid(nodes=(256, 256), spacing=(2e-9, 2e-9))
surface = rs.generate_surface(grid, kind="gaussian", rms={rms}, correlation_length=50e-9, seed=1)
pair = rs.Pair(silica, silica)
contact = rs.Contact(pair, surface, adhesion=rs.{model}(0.05){more})
rs.collide(rs.solve(contact, indentation={depth}))
"""
CASES = {
    "cohesive, elastic": {"rms": 1e-9, "model": "Cohesive", "more": "", "depth": 3e-9},
    "cohesive, yielding": {
        "rms": 2e-9,
        "model": "Cohesive",
        "more": ", plasticity=rs.ConstantBound(2e9)",
        "depth": 3e-9,
    },
    "JKR": {"rms": 2e-9, "model": "JKRLimit", "more": "", "depth": 10e-9},
}
REPORT = """\
# Beside busy processes

{date}, {machine}. Written by `benchmarks/busy.py`.

CPU time (s) of one rough contact of two silica spheres (R = 5 µm, w = 0.05 J/m²) with its
unloading, in a process of its own, beside one busy process per core. The thread limits are those of
OpenBLAS and OpenMP. Median of {repeats} alternating runs.

| contact | one BLAS thread | default | ratio |
|---|---|---|---|
{rows}
"""


def cpu_seconds(code: str, **environment: str) -> float:
    """CPU time of a process that runs `code`."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, "-c", code], check=True, env=os.environ | environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


@contextmanager
def busy_cores():
    """Keep every core busy."""
    loops = [
        subprocess.Popen([sys.executable, "-c", "while True: pass"])
        for _ in range(os.cpu_count() or 1)
    ]
    try:
        yield
    finally:
        for loop in loops:
            loop.kill()


def main() -> None:
    """Write the page, and exit with 1 if a ratio is too large."""
    rows, worst = [], 0.0
    with busy_cores():
        for name, values in CASES.items():
            code = WORK.format(**values)
            one, default = [], []
            for _ in range(REPEATS):
                one.append(cpu_seconds(code, OPENBLAS_NUM_THREADS="1", OMP_NUM_THREADS="1"))
                default.append(cpu_seconds(code))
            ratio = statistics.median(d / o for d, o in zip(default, one, strict=True))
            worst = max(worst, ratio)
            few, many = statistics.median(one), statistics.median(default)
            rows.append(f"| {name} | {few:.1f} | {many:.1f} | {ratio:.2f} |")
            print(rows[-1])
    OUT.write_text(
        REPORT.format(date=today(), machine=machine(), repeats=REPEATS, rows="\n".join(rows))
    )
    if worst > MOST:
        sys.exit(f"{worst:.2f} times the CPU time of one BLAS thread (at most {MOST})")


if __name__ == "__main__":
    main()
