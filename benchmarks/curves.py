"""Time complete curves of restitution; writes benchmarks/curves.md.

Times are also given in the unit U of `unit.py`, so that machines can be compared. `--repeats 1` is
quicker.
"""

from __future__ import annotations

import argparse
import csv
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
import tomllib
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
import tomli_w
from unit import convolution, machine, seconds, today

from restitution import (
    Body,
    Contact,
    Grid,
    Pair,
    collide,
    generate_surface,
    loading_path,
    smooth,
    solve,
)
from restitution.case.case_file import read_case
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.plasticity.bound import ConstantBound

ROOT = Path(__file__).parents[1]
EXAMPLE = ROOT / "benchmarks" / "steel.toml"
OUT = Path(__file__).with_suffix(".md")
FIG_10 = files("restitution.reproduce") / "studies" / "roughness.toml"
NODES = 512
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
GRID = Grid((NODES, NODES), (0.25e-6, 0.25e-6))
ROUGHNESS = (0.0, 0.1e-6, 0.2e-6, 0.5e-6, 1e-6)  # rms (m), of Ghanbarzadeh et al. (2019), Fig. 10
DEPTHS = np.geomspace(10e-9, 1e-6, 24)

REPORT = """\
# Time of whole curves

{date}, {machine}. Written by `make bench`.

Every contact is between two steel spheres. Their reduced radius is R* = 250 µm, their contact
modulus is E* = 112 GPa, and their yield pressure is p_y = 750 MPa. The grid has {nodes}² nodes with
a spacing of 0.25 µm. The times include the computation of the kernels of the convolutions, but not
the creation of the contact. They are medians of {repeats} runs (smallest and largest). The curves
of Fig. 10 were computed once. The column U is the time divided by that of one zero-padded
convolution (forward and inverse) on the same grid with scipy.fft, two workers and float64. The time
of this convolution was measured between the runs and is {unit_ms:.0f} ms.

| what | time, s | U | convolutions | largest error of COR |
|---|---|---|---|---|
{rows}

"Fig. 10" means the five curves of Fig. 10 in Ghanbarzadeh et al. (2019), with the work of adhesion
w = 0.09 J/m². One surface is smooth, and four are rough with Rq = 0.1, 0.2, 0.5 and 1 µm (Gaussian,
correlation length 2 µm). Each contact is loaded to 24 depths from 10 nm to 1 µm. From each depth it
is unloaded step by step until separation. The last row is the time of one `restitution study`
command, including its start and the writing of its tables. This command distributes the five
surfaces among its processes. The study varies Rq, which must be positive, so its smooth surface has
Rq = 1 pm.
"""


@dataclass
class Tally:
    """The number of convolutions of a computation, and the largest error of its results."""

    convolutions: int = 0
    error: float = 0.0


def adhesive(rms: float) -> Contact:
    """Make a contact of Fig. 10 with the given rms roughness (m)."""
    surface = smooth(GRID)
    if rms > 0:
        surface = generate_surface(GRID, kind="gaussian", rms=rms, correlation_length=2e-6, seed=1)
    return Contact(
        Pair(STEEL, STEEL), surface, plasticity=ConstantBound(750e6), adhesion=JKRLimit(0.09)
    )


def add(tally: Tally, state) -> None:
    """Unload `state` to separation, and add the cost of loading and unloading to `tally`."""
    collision = collide(state)
    tally.convolutions += state.convolutions + collision.convolutions
    tally.error = max(tally.error, collision.restitution_error)


def one(contact: Contact, depth: float) -> Tally:
    """Compute one coefficient of restitution."""
    tally = Tally()
    add(tally, solve(contact, depth))
    return tally


def curve(contacts: list[Contact], depths) -> Tally:
    """Compute curves of restitution, one depth after the other."""
    tally = Tally()
    for contact in contacts:
        for state in loading_path(contact, depths):
            add(tally, state)
    return tally


def study() -> Tally:
    """Compute Fig. 10 by the command `restitution study`, as users run it."""
    case = tomllib.loads(FIG_10.read_text())  # it also has the larger depths of Fig. 12
    case["indentation"] = {"from": "10 nm", "to": "1 um", "steps": len(DEPTHS)}
    with tempfile.TemporaryDirectory() as folder:
        path, out = Path(folder, "fig10.toml"), Path(folder, "out")
        path.write_text(tomli_w.dumps(case))
        subprocess.run(
            [sys.executable, "-m", "restitution", "study", path, "-o", out],
            check=True,
            capture_output=True,
        )
        with (out / "table.csv").open() as table:
            rows = list(csv.DictReader(table))
    if len(rows) != len(ROUGHNESS) * len(DEPTHS):
        raise RuntimeError(f"{len(rows)} rows in the table of the study")
    return Tally(
        sum(int(row["convolutions"]) for row in rows),
        max(float(row["restitution_error"] or 0) for row in rows),
    )


def main() -> None:
    """Time the curves and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--repeats", type=int, default=5)
    parser.add_argument("--out", type=Path, default=OUT)
    options = parser.parse_args()
    where = machine()
    case, _ = read_case(EXAMPLE)
    example = case.contact(EXAMPLE.parent)
    rough = adhesive(0.1e-6)
    figure = [adhesive(rms) for rms in ROUGHNESS]
    work = {
        "24 depths of `benchmarks/steel.toml`, 2 nm to 5 µm, rough, no adhesion": (
            lambda: curve([example], case.depths()),
            options.repeats,
        ),
        "one COR at 600 nm, Rq = 0.1 µm, w = 0.09 J/m²": (
            lambda: one(rough, 600e-9),
            options.repeats,
        ),
        "120 values of COR for Fig. 10, computed in sequence": (lambda: curve(figure, DEPTHS), 1),
        f"the same by `restitution study`, {os.cpu_count()} processes": (study, 1),
    }
    units: list[float] = []
    found: dict[str, tuple[list[float], Tally]] = {}
    convolution(NODES)
    for name, (call, repeats) in work.items():
        times, tallies = [], []
        for _ in range(repeats):
            units += [seconds(lambda: convolution(NODES)) for _ in range(3)]
            began = time.perf_counter()
            tallies.append(call())
            times.append(time.perf_counter() - began)
        found[name] = times, tallies[-1]
    U = statistics.median(units)
    rows = []
    for name, (times, tally) in found.items():
        t = statistics.median(times)
        spread = f" ({min(times):.3g} to {max(times):.3g})" if len(times) > 1 else ""
        error = f"{tally.error:.1g}" if tally.error and math.isfinite(tally.error) else "0"
        rows.append(f"| {name} | {t:.3g}{spread} | {t / U:.3g} | {tally.convolutions} | {error} |")
    report = REPORT.format(
        date=today(),
        machine=where,
        nodes=NODES,
        unit_ms=1e3 * U,
        repeats=options.repeats,
        rows="\n".join(rows),
    )
    options.out.write_text(report)
    print(report)


if __name__ == "__main__":
    main()
