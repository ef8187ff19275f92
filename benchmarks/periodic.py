"""Time this program beside Tamaas and ContactMechanics on periodic contacts under a given pressure.

`make bench-periodic` makes an environment for each program and runs this script. The script writes
periodic.csv and periodic.md beside this file. Times are measured as in `compare.py`.
"""

from __future__ import annotations

import argparse
import contextlib
import csv
import math
import os
import tempfile
from pathlib import Path

from problems import SPACING, Problem
from unit import machine, today

from compare import OURS, PROGRAMS, RESIDUAL, ROOT, Worker, compare, power, short
from restitution import Body, Contact, Grid, Pair, generate_surface, solve_at_pressure
from restitution.contact.plasticity.bound import ConstantBound
from restitution.surfaces import rms_slope

WALL = Body(radius=math.inf, youngs_modulus=210e9, poissons_ratio=0.25)
FLAT = Pair(WALL, WALL)
NAMES = (OURS, "contactmechanics", "tamaas")
# Name, nominal pressure and yield pressure. Both pressures are over E* times the rms slope h'.
CASES = (
    ("elastic, low pressure", 0.01, math.inf),
    ("elastic, high pressure", 0.1, math.inf),
    ("plastic", 0.05, 0.3),
)

REPORT = """\
# Periodic contacts beside other programs

{date}, {machine}.
{versions}. {threads}

This page compares the time of restitution with that of Tamaas and ContactMechanics for the same
[periodic contacts](../docs/periodic.md). Each ratio is the time of the other program divided by
the time of restitution in the same round. `make bench-periodic` writes this page;
`periodic.csv` contains all columns.

{table}

All contacts are between flat steel bodies (E* = 112 GPa) on {nodes} × {nodes} nodes with a spacing
of 0.25 µm. The surface is self-affine with the Hurst exponent H = 0.8, a roll-off wavelength of an
eighth of the period and eight nodes per shortest wavelength (`seed = 1`). The numbers in brackets
in the table are the nominal pressures divided by E* times the rms slope.

Every program solves for a prescribed nominal pressure. The benchmark tries powers of ten as the
tolerance of each program. It uses the loosest tolerance that meets two requirements: the contact
conditions hold to {residual} δ, and the relative error of the force is below 1e-6. Here δ is the
indentation at the prescribed pressure. Both requirements are checked from the computed pressures
alone, by code that none of the programs use. In the table, "residual" is the largest violation of
the contact conditions divided by δ. "force" is the relative difference between the computed and the
prescribed force. "nodes" is the number of nodes in contact minus the number found by `restitution`.
`restitution` always meets the prescribed pressure to 1e-8. It therefore solves the contact more
accurately than its tolerance demands, and a loose tolerance suffices (column "own tolerance"). The
programs take turns {rounds} times, in an order that is reversed each time; ratios are medians
(smallest–largest). `peers.md` states what a time includes.

Tamaas solves elastic contact by `PolonskyKeerRey` and plastic contact by `KatoSaturated`.
ContactMechanics solves them by `minimize_proxy` with `external_force`. A program that needs more
than {limit:.0f} s for a solution is not timed.
"""


def problems(n: int) -> list[Problem]:
    """The contacts of `CASES` on n × n nodes."""
    grid = Grid(n, SPACING)
    surface = generate_surface(
        grid,
        kind="self-affine",
        rms=0.2e-6,
        hurst=0.8,
        rolloff=n * SPACING / 8,
        shortest=8 * SPACING,
        seed=1,
    )
    E_star = FLAT.contact_modulus
    unit, found = E_star * rms_slope(surface), []
    for name, pressure, limit in CASES:
        contact = Contact(
            FLAT,
            surface,
            plasticity=ConstantBound(limit * unit),
            periodic=True,
        )
        state = solve_at_pressure(contact, pressure * unit, residual=1e-10)
        found.append(
            Problem(
                f"{name} ({pressure:g}), {100 * state.relative_area:.1f} % contact",
                contact.gap,
                SPACING,
                E_star,
                contact.hardness,
                state.indentation,
                math.inf,
                state.force,
                periodic=True,
            )
        )
    return found


def table(rows: list[dict], problems_of: dict[str, Problem]) -> str:
    """Format the rows as a Markdown table."""
    lines = [
        "| problem | program | time, s | ratio | own tolerance | residual | force | nodes |",
        "|---|---|---|---|---|---|---|---|",
    ]
    ours = {row["problem"]: row for row in rows if row["program"] == OURS}
    for row in rows:
        where = f"{row['problem']} | {PROGRAMS[row['program']]}"
        if "failure" in row:
            lines.append(f"| {where} | {row['failure']} | | | | | |")
            continue
        ratio = "{} ({}–{})".format(
            *(short(row[key]) for key in ("ratio", "least_ratio", "largest_ratio"))
        )
        force = row["force_N"] / problems_of[row["problem"]].force - 1
        nodes = row["contact_nodes"] - ours[row["problem"]]["contact_nodes"]
        lines.append(
            f"| {where} | {row['seconds']:.3g} | {'1' if row['program'] == OURS else ratio} "
            f"| {power(row['tolerance'])} | {power(row['residual'])} | {power(force)} | {nodes:d} |"
        )
    return "\n".join(lines)


def main() -> None:
    """Run all problems and write the report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--environments", type=Path, default=ROOT / ".venv-peers")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent)
    parser.add_argument("--nodes", type=int, default=512)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--limit", type=float, default=60, help="seconds for one solve")
    options = parser.parse_args()

    where, rows, all_problems = machine(), [], problems(options.nodes)
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        python = {name: options.environments.resolve() / name / "bin" / "python" for name in NAMES}
        workers = [Worker(name, python[name], Path(folder), options.limit) for name in NAMES]
        for worker in workers:
            stack.callback(worker.stop)
        for problem in all_problems:
            problem.save(Path(folder) / "problem.npz")
            rows += compare(problem, "period", workers, options.rounds, options.nodes)[0]
    with open(options.out / "periodic.csv", "w", newline="") as file:
        writer = csv.DictWriter(
            file, list(dict.fromkeys(name for row in rows for name in row)), lineterminator="\n"
        )
        writer.writeheader()
        writer.writerows(rows)
    versions = {row["program"]: row["version"] for row in rows if row.get("version")}
    threads = os.environ.get("OMP_NUM_THREADS")
    report = REPORT.format(
        date=today(),
        machine=where,
        versions=", ".join(f"{PROGRAMS[name]} {version}" for name, version in versions.items()),
        threads=f"Each program used {threads} thread." if threads == "1" else "",
        table=table(rows, {problem.name: problem for problem in all_problems}),
        nodes=options.nodes,
        residual=power(RESIDUAL),
        rounds=options.rounds,
        limit=options.limit,
    )
    (options.out / "periodic.md").write_text(report)
    print(report)


if __name__ == "__main__":
    main()
