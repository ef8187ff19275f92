"""How much faster a study is on two workers than on one.

`python benchmarks/studies.py`: a study of 40 cases on 256² nodes, one and two local processes in
turns, twice each; the ratio of medians, with starting the processes and without.
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

STUDY = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "750 MPa"
[roughness]
kind = "gaussian"
rms = "0.1 um"
correlation_length = "2 um"
seed = 1
[grid]
nodes = 256
spacing = "0.25 um"
[indentation]
from = "50 nm"
to = "1 um"
steps = 24
[sweep]
"roughness.seed" = {seeds}
"""


def seconds(folder: Path, workers: int) -> float:
    """Of the whole command."""
    began = time.perf_counter()
    subprocess.run(
        [sys.executable, "-m", "restitution", "study", folder / "study.toml", "-o",
         folder / f"out-{time.time_ns()}", "--workers", str(workers)],
        check=True, capture_output=True,
    )  # fmt: skip
    return time.perf_counter() - began


def main() -> None:
    """Print medians and their ratio."""
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "study.toml").write_text(STUDY.format(seeds=list(range(40))))
        taken: dict[int, list[float]] = {1: [], 2: []}
        for _ in range(2):
            for workers, times in taken.items():
                times.append(seconds(folder, workers))
    one, two = (statistics.median(taken[workers]) for workers in (1, 2))
    print(f"40 cases: {one:.1f} s on one worker, {two:.1f} s on two: {one / two:.2f} times faster")


if __name__ == "__main__":
    main()
