"""Time this program beside Tamaas, ContactMechanics and SlipPy on the same contacts.

`make bench-peers` makes an environment for each program and runs this script. The script writes
peers.csv, peers.md and peers.png beside this file. `peers.md` (`REPORT` below) describes the
method.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import json
import select
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from problems import Problem, all_problems, residual
from unit import convolution, machine, seconds, today

HERE = Path(__file__).parent
ROOT = HERE.parent
OURS = "restitution"
PROGRAMS = {
    OURS: "restitution",
    "slippy": "SlipPy",
    "contactmechanics": "ContactMechanics",
    "tamaas": "Tamaas",
}
RESIDUAL = 1e-8  # residual divided by δ that every program must reach
LADDER = [10.0**-k for k in range(4, 21)]  # tolerances tried, loosest first
LEAST_SECONDS = 0.2  # quick solves are repeated for this time, and the median time is used

REPORT = """\
# Beside other programs

{date}, {machine}.
Measured versions: {versions}.

This page compares the computing time of the program restitution with that of other programs for the
same contacts. Each ratio is the time of the other program divided by that of restitution in the
same run. `make
bench-peers` writes this page; `peers.csv` contains all columns.

{table}

![time divided by that of restitution](peers.png)

## What is timed

**Contacts.** All contacts have R* = 250 µm, E* = 112 GPa and {nodes} × {nodes} nodes with a spacing
of 0.25 µm. The indentation is δ = a²/R*, where a is the contact radius of smooth elastic spheres.

* Elastic contacts have a = 10 µm.
* In plastic contacts the pressure is limited to 750 MPa, and the contact radius a is 20 µm.
* Rough surfaces have a Gaussian autocorrelation of length 2 µm and Rq = 0.1 µm (`seed = 1`).
* "full": each program receives the whole grid, as in ordinary use.
* "cropped": each program receives only the bounding box of the nodes whose initial gap h₀ is below
  δ, enlarged to sizes for which the FFT is fast. If restitution receives the whole grid, it finds
  this box by itself.

**Time.** A time is that of one complete solution in a process that is already running. It includes
the set-up and the computation of the kernel. It does not include imports, compilation or reading
the problem. Nothing is kept from earlier solutions, with one exception: FFTW keeps its plans, so
SlipPy does most of its planning only once. "first" is the time to start the process with its
imports, plus the time of the first solution.

**Accuracy.** Every program defines its tolerance in its own way. The benchmark tries powers of ten
as the tolerance, and uses the loosest one with which the contact conditions (0 ≤ p ≤ p_y) hold to
{residual} δ. Here p is the contact pressure, and p_y is its limit in plastic contacts. The
conditions are checked from the computed pressures alone, by code that none of the programs use.
This code computes the gap g = h₀ + K p − δ. Here K p, the displacement due to the pressure, follows
from Love's formula in extended precision and a zero-padded FFT over the whole grid. If a program
needs more than {limit:.0f} s for a solution, or does not reach this accuracy at any tolerance, the
table says so.

**Repetitions.** The programs take turns {rounds} times, in an order that is reversed each time.
Times are medians. Ratios are computed for each turn, and the table shows their median
(smallest–largest). The column U is the time divided by that of one zero-padded convolution (forward
and inverse) of {nodes} × {nodes} nodes with scipy.fft, two workers and float64. The time of this
convolution is measured at every turn, and its median is {unit:.1f} ms ({least:.1f}–{largest:.1f}).
A wide range means that other processes ran at the same time. Such processes slow down programs with
several threads most.

**Settings.** Each program runs with the best settings that were found, and in the units that suit
it best (see the workers in `benchmarks/peers`). For a half-space that is not periodic, Tamaas
accepts only a force, not an indentation. The benchmark gives Tamaas the correct force, so Tamaas
does not have to search for the force. The installed package of Tamaas runs on one core. SlipPy uses
one core on grids of up to 256², where its threads save no time.
"""


class Worker:
    """A program in a process of its own, started by the first request."""

    def __init__(self, name: str, python: Path, folder: Path, limit: float) -> None:
        self.name, self.limit = name, limit
        self.version = ""
        self.start_seconds = float("nan")
        self._python, self._folder = python, folder
        self._process: subprocess.Popen[bytes] | None = None

    def solve(self, tolerance: float, least_seconds: float = 0.0) -> tuple[list[float], np.ndarray]:
        """Solve `problem.npz`; return the times (s) and the pressure. Raises `UnsolvedError`."""
        if not self.running:
            self._start()
        request = {
            "problem": "problem.npz",
            "pressure": f"{self.name}.npy",
            "tolerance": tolerance,
            "least_seconds": least_seconds,
        }
        self._process.stdin.write(json.dumps(request).encode() + b"\n")
        self._process.stdin.flush()
        reply = self._reply(self.limit + least_seconds)
        if "error" in reply:
            raise UnsolvedError(reply["error"])
        return reply["seconds"], np.load(self._folder / request["pressure"])

    @property
    def running(self) -> bool:
        """Whether the process runs; a process that exceeds the time limit is ended."""
        return self._process is not None

    def stop(self) -> None:
        """End the process, if there is one."""
        if self.running:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _start(self) -> None:
        began = time.perf_counter()
        with open(self._folder / f"{self.name}.log", "ab") as log:
            self._process = subprocess.Popen(
                [self._python, HERE / "peers" / f"solve_{self.name}.py"],
                cwd=self._folder,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
            )
        self.version = self._reply(600)["version"]
        self.start_seconds = time.perf_counter() - began

    def _reply(self, limit: float) -> dict:
        if not select.select([self._process.stdout], [], [], limit)[0]:
            self.stop()
            raise UnsolvedError(f"over {limit:.0f} s")
        line = self._process.stdout.readline()
        if not line:
            self.stop()
            log = (self._folder / f"{self.name}.log").read_text().splitlines()
            raise UnsolvedError(f"ended: {log[-1] if log else 'without a message'}")
        return json.loads(line)


class UnsolvedError(Exception):
    """A program did not solve the problem; the message gives the reason."""


def find_tolerance(worker: Worker, problem: Problem) -> float:
    """Find the largest tolerance at which `worker` reaches `RESIDUAL`. Raises `UnsolvedError`."""
    best, failure = "", "stalls"
    least = float("inf")
    for tolerance in LADDER:
        try:
            _, pressure = worker.solve(tolerance)
        except UnsolvedError as unsolved:
            failure = f"{unsolved} at {power(tolerance)}"
            if not worker.running:  # the time limit was exceeded; smaller tolerances take longer
                break
            continue
        found = residual(problem, pressure)
        if found <= RESIDUAL:
            return tolerance
        if found < least:
            least, best = found, f" (residual {power(found)} at {power(tolerance)})"
    raise UnsolvedError(f"not solved: {failure}{best}")


def power(number: float) -> str:
    """Format a number as 2e-8."""
    return f"{number:.0e}".replace("e-0", "e-")


def compare(
    problem: Problem, grid: str, workers: list[Worker], rounds: int, nodes: int
) -> tuple[list[dict], list[float]]:
    """Return a row of times for each program, and the unit of time U measured in every round."""
    rows = {}
    for worker in workers:
        row = {
            "problem": problem.name,
            "grid": grid,
            "program": worker.name,
            "nodes": "{}x{}".format(*problem.gap.shape),
        }
        rows[worker.name] = row
        try:
            row["tolerance"] = find_tolerance(worker, problem)
            worker.stop()
            first, pressure = worker.solve(row["tolerance"])
            row |= {
                "residual": residual(problem, pressure),
                "force_N": float(pressure.sum()) * problem.spacing**2,
                "contact_nodes": int(np.count_nonzero(pressure)),
                "start_s": worker.start_seconds,
                "first_s": first[0],
            }
        except UnsolvedError as unsolved:
            row["failure"] = str(unsolved)
        row["version"] = worker.version
        print(row, flush=True)

    able = [worker for worker in workers if "failure" not in rows[worker.name]]
    turns = {worker.name: [] for worker in able}
    units = []
    for turn in range(rounds):
        units.append(seconds(lambda: convolution(nodes)))
        for worker in able if turn % 2 == 0 else able[::-1]:
            times, _ = worker.solve(rows[worker.name]["tolerance"], LEAST_SECONDS)
            turns[worker.name].append(statistics.median(times))
    for name, times in turns.items():
        ratios = [t / ours for t, ours in zip(times, turns[OURS], strict=True)]
        rows[name] |= {
            "seconds": statistics.median(times),
            "least_s": min(times),
            "largest_s": max(times),
            "ratio": statistics.median(ratios),
            "least_ratio": min(ratios),
            "largest_ratio": max(ratios),
        }
    for worker in workers:
        worker.stop()
    return list(rows.values()), units


def table(rows: list[dict], unit: float) -> str:
    """Format the rows as a Markdown table."""
    lines = [
        "| problem | grid | program | time, s | ratio | U | own tolerance | first, s |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for row in rows:
        where = f"{row['problem']} | {row['grid']}, {row['nodes']} | {PROGRAMS[row['program']]}"
        if "failure" in row:
            lines.append(f"| {where} | {row['failure']} | | | | |")
            continue
        ratio = "{} ({}–{})".format(
            *(short(row[key]) for key in ("ratio", "least_ratio", "largest_ratio"))
        )
        lines.append(
            f"| {where} | {row['seconds']:.3g} | {'1' if row['program'] == OURS else ratio} "
            f"| {short(row['seconds'] / unit)} | {power(row['tolerance'])} "
            f"| {row['start_s']:.2g} + {row['first_s']:.2g} |"
        )
    return "\n".join(lines)


def short(number: float) -> str:
    """Format a positive number with about two digits, without exponent."""
    return f"{number:.0f}" if number >= 10 else f"{number:.2g}"


def draw(rows: list[dict], path: Path) -> None:
    """Draw bars of the ratios, one group for each problem; a text replaces the bar of a failure."""
    groups = list(dict.fromkeys((row["problem"], row["grid"]) for row in rows))
    peers = [name for name in PROGRAMS if name != OURS]
    figure = Figure(figsize=(9, 4.2), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.subplots()
    axes.set_yscale("log")
    width = 0.8 / len(peers)
    for k, peer in enumerate(peers):
        for row in (row for row in rows if row["program"] == peer):
            x = groups.index((row["problem"], row["grid"])) + (k - (len(peers) - 1) / 2) * width
            if "failure" in row:
                axes.text(x, 1.1, "not solved", rotation=90, ha="center", va="bottom", size=8)
                continue
            ends = [[row["ratio"] - row["least_ratio"]], [row["largest_ratio"] - row["ratio"]]]
            axes.bar(x, row["ratio"], 0.9 * width, color=f"C{k}", yerr=ends, capsize=2)
            axes.annotate(
                short(row["ratio"]),
                (x, row["largest_ratio"]),
                (0, 3),
                ha="center",
                textcoords="offset points",
                size=8,
            )
        axes.bar(0, np.nan, color=f"C{k}", label=PROGRAMS[peer])
    axes.axhline(1, color="black", linewidth=0.8)
    axes.margins(y=0.15)
    axes.set_xticks(range(len(groups)), [f"{problem}\n{grid} grid" for problem, grid in groups])
    axes.set_ylabel(f"time over that of {OURS}")
    axes.legend(ncols=len(peers))
    figure.savefig(path, dpi=150)


def main() -> None:
    """Run all problems and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--environments", type=Path, default=ROOT / ".venv-peers")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--nodes", type=int, default=512, help="at least 256")
    parser.add_argument("--rounds", type=int, default=7)
    parser.add_argument("--limit", type=float, default=120, help="seconds for one solve")
    options = parser.parse_args()

    where = machine()
    rows, units = [], []
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        workers = [
            Worker(
                name,
                options.environments.resolve() / name / "bin" / "python",
                Path(folder),
                options.limit,
            )
            for name in PROGRAMS
        ]
        for worker in workers:
            stack.callback(worker.stop)
        for whole in all_problems(options.nodes):
            for grid, problem in (("full", whole), ("cropped", whole.cropped())):
                problem.save(Path(folder) / "problem.npz")
                its_rows, its_units = compare(problem, grid, workers, options.rounds, options.nodes)
                rows += its_rows
                units += its_units

    unit = statistics.median(units)
    options.out.mkdir(parents=True, exist_ok=True)
    with open(options.out / "peers.csv", "w", newline="") as file:
        names = list(dict.fromkeys(name for row in rows for name in row))
        writer = csv.DictWriter(file, names, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    versions = ", ".join(f"{PROGRAMS[w.name]} {w.version}" for w in workers)
    report = REPORT.format(
        date=today(),
        machine=where,
        versions=versions,
        table=table(rows, unit),
        nodes=options.nodes,
        residual=power(RESIDUAL),
        limit=options.limit,
        rounds=options.rounds,
        unit=1e3 * unit,
        least=1e3 * min(units),
        largest=1e3 * max(units),
    )
    (options.out / "peers.md").write_text(report)
    draw(rows, options.out / "peers.png")
    print(report)


if __name__ == "__main__":
    main()
