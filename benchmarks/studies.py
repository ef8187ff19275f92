"""Speed-up of a study by a second worker, with local processes and with a Dask cluster.

`python benchmarks/studies.py` runs a study of 40 cases on 256² nodes with one and two workers in
turn, twice each, and prints the ratio of the median times of the whole command. Clusters are
started before the time is measured.
"""

from __future__ import annotations

import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
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
ROUNDS = 2


def seconds(folder: Path, *where: str) -> float:
    """Time (s) of the command `restitution study` with the options `where`."""
    began = time.perf_counter()
    subprocess.run(
        [
            sys.executable,
            "-m",
            "restitution",
            "study",
            folder / "study.toml",
            "-o",
            folder / f"out-{time.time_ns()}",
            *where,
        ],
        check=True,
        capture_output=True,
    )
    return time.perf_counter() - began


@contextmanager
def cluster(workers: int) -> Iterator[str]:
    """Start a local cluster with `workers` workers of one thread; yield the scheduler's address."""

    def start(*arguments: str) -> subprocess.Popen[str]:
        return subprocess.Popen(
            [
                sys.executable,
                "-m",
                f"distributed.cli.{arguments[0]}",
                *arguments[1:],
                "--no-dashboard",
            ],
            stderr=subprocess.PIPE,
            text=True,
            env={**os.environ, "DUCC0_NUM_THREADS": "1"},
        )

    def said(process: subprocess.Popen[str], words: str) -> str:
        for line in process.stderr or ():
            if found := re.search(words, line):
                return found[0]
        raise RuntimeError(f"a process of the cluster ended without printing {words!r}")

    started = [start("dask_scheduler", "--host", "127.0.0.1", "--port", "0")]
    address = said(started[0], r"tcp://127\.0\.0\.1:\d+")
    started += [start("dask_worker", address, "--nthreads", "1") for _ in range(workers)]
    for worker in started[1:]:
        said(worker, "Registered to")
    try:
        yield address
    finally:
        for process in reversed(started):
            process.terminate()
            process.communicate(timeout=60)


def main() -> None:
    """Print the median times with one and two workers, and their ratio."""
    taken: dict[tuple[str, int], list[float]] = {}
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        (folder / "study.toml").write_text(STUDY.format(seeds=list(range(40))))
        for _ in range(ROUNDS):
            for workers in (1, 2):
                local = seconds(folder, "--workers", str(workers))
                taken.setdefault(("local processes", workers), []).append(local)
                with cluster(workers) as address:
                    far = seconds(folder, "--scheduler", address)
                taken.setdefault(("Dask cluster", workers), []).append(far)
    for kind in ("local processes", "Dask cluster"):
        one, two = (statistics.median(taken[kind, workers]) for workers in (1, 2))
        print(
            f"40 cases, {kind}: {one:.1f} s on one worker, {two:.1f} s on two: "
            f"{one / two:.2f} times faster"
        )


if __name__ == "__main__":
    main()
