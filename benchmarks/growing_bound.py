"""Time of a curve with a growing pressure bound, relative to the time with a constant bound.

Writes benchmarks/growing-bound.md. `--repeats 1` is quicker. `growing_bound.py OTHER` measures the
version in the folder OTHER, too (as for `benchmarks/cohesive.py`), in turn with this one.
"""

from __future__ import annotations

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

for _name in ("OMP_NUM_THREADS", "DUCC0_NUM_THREADS"):
    os.environ[_name] = "1"

import numpy as np  # noqa: E402
from unit import machine, today  # noqa: E402

from restitution import (  # noqa: E402
    Body,
    ConstantBound,
    Contact,
    ExpandingCavity,
    Grid,
    Pair,
    Plasticity,
    Surface,
    collide,
    generate_surface,
    loading_path,
    smooth,
)

Curve = Callable[[Surface, Plasticity], None]
Times = list[tuple[float, float]]  # s, with the constant bound and with the bound that grows
HERE = Path(__file__).resolve().parents[1]
OUT = Path(__file__).with_name("growing-bound.md")
PART = 3  # repeats of a process
# Also runs the functions of earlier versions of this file.
WORKER = """
import json, sys
import growing_bound as version
found = {}
for name, surface in version.surfaces().items():
    curves = {"loading": version.load, "loading and unloading": version.load_and_unload}
    for curve, work in curves.items():
        work(surface, version.CONSTANT)  # not timed: it also computes the influence coefficients
        found[f"{name} | {curve}"] = [
            [version.seconds(work, surface, bound) for bound in (version.CONSTANT, version.GROWING)]
            for _ in range(int(sys.argv[1]))
        ]
print(json.dumps(found))
"""
NODES = 512
GRID = Grid((NODES, NODES), (0.25e-6, 0.25e-6))
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
DEPTHS = np.geomspace(2e-9, 5e-6, 24)  # the depths of benchmarks/steel.toml
CONSTANT, GROWING = ConstantBound(750e6), ExpandingCavity(268e6)

REPORT = """\
# Time of the bound that grows

{date}, {machine}. Written by `benchmarks/growing_bound.py`.

Two steel spheres (R* = 250 µm, E* = 112 GPa) on {nodes}² nodes of 0.25 µm are loaded to 24 depths
from 2 nm to 5 µm, as in `benchmarks/steel.toml`. The page compares two upper bounds of the contact
pressure: a constant bound of 750 MPa, and a bound that grows with deformation, for the yield
strength Y = 268 MPa. The times are CPU times of one thread, because other programs on the machine
affect them less than the elapsed times. They do not include the time to generate the surface. Each
curve is computed {repeats} times with each bound, alternately. Each ratio is the time with the
bound that grows divided by the time with the constant bound. The table shows the median of the
repeats (smallest and largest in brackets).

| surface | curve | constant bound, s | bound that grows, s | ratio |
|---|---|---|---|---|
{rows}
{beside}
With the bound that grows, each depth of loading needs a second solve
(`contact/plasticity/cavity.py`): the elastic contact at twice the depth, in single precision, with
wrapped convolutions (`numerics/convolution/operators.py`) and a filter of 7 × 7 nodes as
preconditioner (`numerics/quadratic/near_filter.py`), to a residual (root mean square) of 1.5e-4 of
the largest overlap and one step more. Forces on these surfaces differ by at most 1.7e-4, and COR by
at most 5e-5, from those of an elastic contact at 1e-8. These contacts have no adhesion, so the
unloading work is the elastic energy, and unloading takes no solve.
"""

BESIDE = """
The same beside commit 50df63c, in processes of {part} repeats of each version in turn:

| surface | curve | constant, then, s | grows, then | grows, now | grows, now / constant, then |
|---|---|---|---|---|---|
{rows}
"""


def surfaces() -> dict[str, Surface]:
    """The surfaces, by name: smooth, and two kinds of roughness."""
    shape = {"rms": 0.1e-6, "correlation_length": 2e-6, "seed": 1}
    return {
        "gaussian, Rq = 0.1 µm": generate_surface(GRID, kind="gaussian", **shape),
        "exponential, Rq = 0.1 µm": generate_surface(GRID, kind="exponential", **shape),
        "smooth": smooth(GRID),
    }


def load(surface: Surface, strength: Plasticity) -> None:
    """Load to all depths."""
    for _ in loading_path(Contact(Pair(STEEL, STEEL), surface, plasticity=strength), DEPTHS):
        pass


def load_and_unload(surface: Surface, strength: Plasticity) -> None:
    """Load to all depths and unload from each."""
    for state in loading_path(Contact(Pair(STEEL, STEEL), surface, plasticity=strength), DEPTHS):
        collide(state)


def seconds(work: Curve, surface: Surface, strength: Plasticity) -> float:
    """Processor time of a curve."""
    began = time.process_time()
    work(surface, strength)
    return time.process_time() - began


def measure(version: Path, repeats: int) -> dict[str, Times]:
    """Times of all curves, by surface and curve, of the version in a folder and its benchmark."""
    paths = os.pathsep.join((str(version / "src"), str(version / "benchmarks")))
    done = subprocess.run(
        [sys.executable, "-P", "-W", "ignore", "-c", WORKER, str(repeats)],
        env={**os.environ, "PYTHONPATH": paths, "OPENBLAS_NUM_THREADS": "1"},
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def median(times: Times) -> tuple[float, float]:
    constant, growing = (statistics.median(each) for each in zip(*times, strict=True))
    return constant, growing


def rows_of(found: dict[str, Times]) -> str:
    """Format the rows of the table."""
    rows = []
    for curve, times in found.items():
        constant, growing = median(times)
        ratios = [after / before for before, after in times]
        rows.append(
            f"| {curve} | {constant:.3f} | {growing:.3f} | {statistics.median(ratios):.2f} "
            f"({min(ratios):.2f} to {max(ratios):.2f}) |"
        )
    return "\n".join(rows)


def rows_beside(found: dict[str, Times], before: dict[str, Times]) -> str:
    rows = []
    for curve, times in found.items():
        (_, growing), (constant, grew) = median(times), median(before[curve])
        rows.append(
            f"| {curve} | {constant:.3f} | {grew:.3f} | {growing:.3f} | {growing / constant:.2f} |"
        )
    return "\n".join(rows)


def main() -> None:
    """Time the curves and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("other", type=Path, nargs="?")
    parser.add_argument("--repeats", type=int, default=9)
    given, about = parser.parse_args(), machine()
    parts = -(-given.repeats // PART)
    versions = [HERE] if given.other is None else [HERE, given.other]
    found: list[dict[str, Times]] = [{} for _ in versions]
    for _ in range(parts):
        for version, times in zip(versions, found, strict=True):
            for curve, more in measure(version, min(PART, given.repeats)).items():
                times.setdefault(curve, []).extend(more)
    beside = "" if given.other is None else BESIDE.format(part=PART, rows=rows_beside(*found))
    page = REPORT.format(
        date=today(),
        machine=about,
        nodes=NODES,
        repeats=parts * min(PART, given.repeats),
        rows=rows_of(found[0]),
        beside=beside,
    )
    print(page)
    OUT.write_text(page, encoding="utf-8")


if __name__ == "__main__":
    main()
