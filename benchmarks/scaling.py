"""Time, convolutions and memory of one rough solve against the size of the grid.

The contact is the same at every size: a sphere on a band-limited surface of 64 µm, which is made on
256² nodes and refined by zero padding its spectrum. Writes scaling.csv, scaling.md and scaling.png
beside this file; `--largest 8192` adds one size.
"""

from __future__ import annotations

import argparse
import csv
import json
import math
import resource
import statistics
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import scipy.fft
from unit import machine, measure_unit, today

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, operator_cache, solve
from restitution.contact.plasticity.bound import ConstantBound

OUT = Path(__file__).parent
COARSEST = 256
DOMAIN = 64e-6
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
PAIR = Pair(STEEL, STEEL)  # R* = 250 µm, E* = 112 GPa
LIMITS = {"elastic": math.inf, "plastic": 750e6}
DEPTHS = ("a = 20 µm", "filling")
REPEAT_SECONDS, FEWEST, MOST = 3.0, 5, 25  # time for which a solve is repeated, and bounds

REPORT = """\
# Time and memory against size

{date}, {machine}. Written by `make bench`.
All columns are in `scaling.csv`.

This page shows how time and memory grow with the size of the grid. Each row is one contact of a
sphere (R* = 250 µm, E* = 112 GPa), solved with a tolerance of 1e-8. All rows have the same rough
surface with an edge length of 64 µm (Rq = 0.1 µm, Gaussian autocorrelation of length 2 µm). The
surface is made on {coarsest}² nodes and refined by zero padding its spectrum. Each row was measured
in a process of its own.

* case: "a = 20 µm" has an indentation of 20²/250 µm. "filling" has an indentation δ of
  {filling:.2f} µm, so that the nodes with an initial gap h₀ < δ nearly fill the grid. Plastic
  contacts have p ≤ 750 MPa.
* time: the median time of {fewest} to {most} solutions, including the set-up and the computation of
  the kernel.
* U: the time divided by that of one zero-padded convolution (forward and inverse) on the whole grid
  with scipy.fft, two workers and float64. The convolution is timed just before the solution.
* least: the shortest time of these solutions.
* first: the time of the first solution in the process. During this solution the process accesses
  its memory for the first time. This machine is virtual, and its host reclaims idle memory. In any
  program on such a machine, the first access can take 1 to 2 s per GiB.
* memory: the peak memory of the process, including Python and the surface, in GiB.
* arrays per node: the peak memory, divided by the memory of one float64 array of the whole grid.

{table}

Time grows with the number of nodes to the power {exponents}. If the shortest times are used instead
of the medians, the powers are {least}. For the first solution in each process (column "first"),
the powers are {first}.

![time and memory against nodes](scaling.png)
"""


def refined(surface: Surface, n: int) -> Surface:
    """The same band-limited surface on n × n nodes of the same domain."""
    coarse = surface.grid.nodes[0]
    half = coarse // 2
    modes = scipy.fft.rfft2(surface.height)
    padded = np.zeros((n, n // 2 + 1), dtype=complex)
    # Leave out the Nyquist modes, because their phase is ambiguous on a finer grid.
    padded[:half, :half] = modes[:half, :half]
    padded[1 - half :, :half] = modes[1 - half :, :half]
    height = scipy.fft.irfft2(padded, s=(n, n), overwrite_x=True)
    height *= (n / coarse) ** 2
    return Surface(height, Grid((n, n), (DOMAIN / n, DOMAIN / n)))


def surface_of(n: int) -> Surface:
    """The surface of this benchmark on n × n nodes."""
    grid = Grid((COARSEST, COARSEST), (DOMAIN / COARSEST, DOMAIN / COARSEST))
    surface = generate_surface(grid, kind="gaussian", rms=0.1e-6, correlation_length=2e-6, seed=1)
    return refined(surface, n)


def indentation(depth: str) -> float:
    """The indentation δ (m), which is the same at every size."""
    if depth == "a = 20 µm":
        return (20e-6) ** 2 / PAIR.radius
    gap = Contact(PAIR, surface_of(COARSEST)).gap
    rim = min(gap[0].min(), gap[-1].min(), gap[:, 0].min(), gap[:, -1].min())
    return 0.99 * float(rim)


def measure(n: int, limit: str, depth: str) -> dict:
    """Solve in this process; return the time, the memory and the number of convolutions."""
    delta = indentation(depth)
    surface = surface_of(n)
    times: list[float] = []
    while len(times) <= FEWEST or (sum(times) < REPEAT_SECONDS and len(times) <= MOST):
        operator_cache.clear()
        began = time.perf_counter()
        state = solve(
            Contact(PAIR, surface, plasticity=ConstantBound(LIMITS[limit])),
            delta,
        )
        times.append(time.perf_counter() - began)
        box = "x".join(str(part.stop - part.start) for part in state.box)
        found = {
            "box": box,
            "convolutions": state.convolutions,
            "residual": state.residual,
            "force": state.force,
        }
        del state  # free its memory for the next solve
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024
    return {
        "seconds": statistics.median(times[1:]),
        "least_s": min(times[1:]),
        "first_s": times[0],
        "solves": len(times) - 1,
        "peak_bytes": peak,
        "arrays_per_node": peak / (8 * n * n),
    } | found


def in_its_own_process(*arguments: object) -> dict:
    """Call this script with `--measure` and the arguments, and return what it prints."""
    command = [sys.executable, __file__, "--measure", *map(str, arguments)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


def exponent(rows: list[dict], time: str = "seconds") -> float:
    """Slope of log time against log nodes, by least squares."""
    nodes, times = ([row[key] for row in rows] for key in ("nodes", time))
    return float(np.polyfit(np.log(nodes), np.log(times), 1)[0])


def table(rows: list[dict]) -> str:
    """Format the rows as a Markdown table."""
    lines = [
        "| case | grid | box | time, s | U | least, s | first, s | convolutions | memory, GiB "
        "| arrays per node |",
        "|---|---|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        lines.append(
            f"| {row['limit']}, {row['depth']} | {row['n']}² | {row['box']} | {row['seconds']:.3g} "
            f"| {row['seconds'] / row['unit_s']:.3g} | {row['least_s']:.3g} | {row['first_s']:.3g} "
            f"| {row['convolutions']} "
            f"| {row['peak_bytes'] / 2**30:.2f} | {row['arrays_per_node']:.1f} |"
        )
    return "\n".join(lines)


def draw(cases: dict[str, list[dict]], path: Path) -> None:
    """Draw time and memory against the number of nodes, on logarithmic axes."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9, 4), layout="constrained")
    FigureCanvasAgg(figure)
    left, right = figure.subplots(1, 2)
    for case, rows in cases.items():
        nodes = [row["nodes"] for row in rows]
        left.loglog(
            nodes,
            [row["seconds"] for row in rows],
            "o-",
            markersize=4,
            label=f"{case} (power {exponent(rows):.2f})",
        )
        right.loglog(nodes, [row["peak_bytes"] / 2**30 for row in rows], "o-", markersize=4)
    left.loglog(nodes, [row["unit_s"] for row in rows], "k--", linewidth=1, label="U")
    left.set_ylabel("time, s")
    left.legend(fontsize=8)
    right.set_ylabel("memory, GiB")
    for axes in (left, right):
        axes.set_xlabel("nodes")
        axes.grid(alpha=0.3)
    figure.savefig(path, dpi=150)


def main() -> None:
    """Measure every case in a process of its own and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--largest", type=int, default=4096)
    parser.add_argument("--out", type=Path, default=OUT)
    parser.add_argument("--measure", nargs="+", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.measure:
        what, n, *case = options.measure
        unit = {"unit_s": measure_unit(int(n), samples=3)} if what == "unit" else {}
        print(json.dumps(unit or measure(int(n), *case)))
        return

    sizes = [n for n in (256, 512, 1024, 2048, 4096, 8192) if n <= options.largest]
    where = machine()
    rows = []
    for limit in LIMITS:
        for depth in DEPTHS:
            for n in sizes:
                row = {"limit": limit, "depth": depth, "n": n, "nodes": n * n}
                row |= in_its_own_process("unit", n)
                row |= in_its_own_process("solve", n, limit, depth)
                rows.append(row)
                print(rows[-1], flush=True)

    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / "scaling.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    cases: dict[str, list[dict]] = {}
    for row in rows:
        cases.setdefault(f"{row['limit']}, {row['depth']}", []).append(row)
    report = REPORT.format(
        date=today(),
        machine=where,
        coarsest=COARSEST,
        filling=1e6 * indentation("filling"),
        fewest=FEWEST,
        most=MOST,
        table=table(rows),
        exponents=", ".join(f"{exponent(its):.2f} ({case})" for case, its in cases.items()),
        least=", ".join(f"{exponent(its, 'least_s'):.2f}" for its in cases.values()),
        first=", ".join(f"{exponent(its, 'first_s'):.2f}" for its in cases.values()),
    )
    (options.out / "scaling.md").write_text(report)
    draw(cases, options.out / "scaling.png")
    print(report)


if __name__ == "__main__":
    main()
