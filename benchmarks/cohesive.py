"""Time cohesive contacts with two versions of the program, and beside the package Adhesion.

`python benchmarks/cohesive.py OTHER` measures this version and that in the folder OTHER in turn,
each in a process of its own with one thread (OTHER as for `benchmarks/adhesion.py`; its kernels
must be compiled). With `--peer PYTHON`, an environment with `peers/adhesion.txt`, it also times a
path of 40 steps of Adhesion with ContactMechanics. Writes benchmarks/cohesive.md.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

from unit import machine, today

HERE = Path(__file__).resolve().parent
OUT = Path(__file__).with_suffix(".md")
TEXT = """
total_error = {total_error}
first = {{ material = "{material}", radius = "5 um" }}
[interface]
work_of_adhesion = "0.05 J/m^2"
yield_pressure = "{hardness}"
adhesion = "cohesive"
[roughness]
rms = "{rms}"
{waves}
seed = {seed}
[grid]
nodes = {nodes}
spacing = "{spacing}"
{depths}
"""
SHORT = 'kind = "gaussian"\ncorrelation_length = "{} nm"'
AFFINE = 'kind = "self-affine"\nhurst = 0.8\nshortest = "20 nm"\nrolloff = "200 nm"'
FIVE = '[indentation]\nvalues = ["2 nm", "4 nm", "6 nm", "8 nm", "10 nm"]'
CASES = {
    "elastic, Rq 2 nm, one depth of 10 nm, 256²": {
        "hardness": "elastic",
        "rms": "2 nm",
        "waves": SHORT.format(50),
        "seed": 1,
        "nodes": 256,
        "depths": '[indentation]\nvalues = ["10 nm"]',
    },
    "elastic, self-affine Rq 1 nm, five depths to 10 nm, 256²": {
        "hardness": "elastic",
        "rms": "1 nm",
        "waves": AFFINE,
        "seed": 3,
        "nodes": 256,
        "depths": FIVE,
    },
    "yields at 2.5 GPa, Rq 1 nm, five depths to 10 nm, 256²": {
        "hardness": "2.5 GPa",
        "rms": "1 nm",
        "waves": SHORT.format(40),
        "seed": 3,
        "nodes": 256,
        "depths": FIVE,
    },
}
# The first run of a process imports its libraries and is not timed.
WARM = {**next(iter(CASES.values())), "nodes": 48, "depths": '[indentation]\nvalues = ["0.2 nm"]'}
# Contacts that jump, and the errors of the steps of a path for comparison, as a share of the usual.
JUMPS = {
    f"seed {seed}": {
        "material": "lactose",
        "hardness": "elastic",
        "rms": "0.15 nm",
        "waves": SHORT.format(50),
        "seed": seed,
        "nodes": 224,
        "spacing": "1 nm",
        "depths": '[indentation]\nvalues = ["2 nm", "2.5 nm"]',
    }
    for seed in (1, 2)
}
FINER = 0.05
COLUMNS = (
    "force_N",
    "restitution",
    "restitution_error",
    "pull_off_force_N",
    "loading_work_J",
    "unloading_work_J",
)
REPORT = """\
# Cohesive contacts

{date}, {machine}. Written by `benchmarks/cohesive.py`.

Two silica spheres (R = 5 µm, w = 0.05 J/m², z₀ = 0.3 nm). CPU time (s) of one thread, one BLAS
thread, of commit 50df63c ("old") and of this version ("new") in turn, medians of {repeats}. The
last columns are the largest differences over the depths, of COR beside the stated error of the
steps, and the largest memory of the processes.

| case | old, s | new, s | ratio | force | COR (stated) | pull-off | old, MiB | new, MiB |
|---|---|---|---|---|---|---|---|---|
{rows}

| the total error | run, s | error, s | ratio |
|---|---|---|---|
{errors}

## Losses by jumps

Lactose spheres (R = 5 µm, Rq = 0.15 nm, elastic) jump into contact and out of it, on 224² nodes of
1 nm. Both versions at depths of 2 and 2.5 nm, where the losses are equal; new, with {finer:g} of
the usual errors of the steps.

| surface | old, s | new, s | loss, old, aJ | loss, new, aJ | finer, aJ | new − finer |
|---|---|---|---|---|---|---|
{losses}
{peer}"""
PEER = """
## Beside Adhesion 0.93 with ContactMechanics 1.8.3

The same rough sphere ({nodes}² nodes, free half-space) and law (`Lj82`), {steps} given depths from
{first:.2g} to {last:.2g} nm, each from the state before. Adhesion: L-BFGS of `SmoothContactSystem`,
median residual {theirs_residual:.0e} z₀ (restitution {ours_residual:.0e} z₀); in {failed} steps it
stayed above {loose:.0e} z₀.

| | Adhesion, s | restitution, s | ratio |
|---|---|---|---|
| path | {theirs:.1f} | {ours:.2f} | {ratio:.0f} |
| the deepest step, from the one before | {their_step:.2f} | {our_step:.3f} | {step_ratio:.0f} |

Largest difference of the energies where it converged, by the largest energy: {difference:.1e}.
"""
LOOSE = 1e-3


def text_of(values: dict[str, object], total_error: bool = False) -> str:
    silica = {"material": "silica", "spacing": "2.6 nm"}
    return TEXT.format(**silica | values, total_error=str(total_error).lower())


def measure(arguments: dict[str, object]) -> dict[str, object]:
    """CPU time (s) and columns of a case, in this process."""
    import csv
    import time

    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs.run import run_case

    def run(values: dict[str, object], total_error: bool) -> tuple[float, list[dict[str, str]]]:
        text = text_of(values, total_error)
        case = parse_case(text)
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / "out"
            began = time.process_time()
            run_case(case, text, Path(), ResultsFolder(out))
            seconds = time.process_time() - began
            with open(out / "curve.csv") as file:
                return seconds, list(csv.DictReader(file))

    total = bool(arguments["total_error"])
    run(WARM, False)
    seconds, rows = run(dict(arguments["case"]), total)  # type: ignore[call-overload]
    return {
        "seconds": seconds,
        "memory": resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024,  # MiB
        "columns": {name: [float(row[name]) for row in rows] for name in COLUMNS},
    }


def in_process(source: Path, case: dict[str, object], *, total_error: bool = False) -> dict:
    given = {"case": case, "total_error": total_error}
    code = f"import json, cohesive; print(json.dumps(cohesive.measure({given!r})))"
    environment = {
        **os.environ,
        "PYTHONPATH": f"{source}{os.pathsep}{HERE}",
        "DUCC0_NUM_THREADS": "1",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_NUM_THREADS": "1",
    }
    done = subprocess.run(
        [sys.executable, "-W", "ignore", "-c", code],
        env=environment,
        check=True,
        stdout=subprocess.PIPE,
        text=True,
    )
    return json.loads(done.stdout.splitlines()[-1])


def differences(old: dict, new: dict) -> str:
    def largest(name: str, scale: str) -> float:
        pairs = zip(old["columns"][name], new["columns"][name], old["columns"][scale], strict=True)
        return max(abs(a - b) / c for a, b, c in pairs)

    stated = max(
        math.hypot(*pair)
        for pair in zip(
            old["columns"]["restitution_error"], new["columns"]["restitution_error"], strict=True
        )
    )
    off = max(
        abs(a - b)
        for a, b in zip(old["columns"]["restitution"], new["columns"]["restitution"], strict=True)
    )
    force = largest("force_N", "force_N")
    pull = largest("pull_off_force_N", "pull_off_force_N")
    return f"{force:.0e} | {off:.0e} ({stated:.0e}) | {pull:.0e}"


def losses(other: Path, name: str) -> str:
    """A row of the table of losses by jumps."""
    old, new = (in_process(source, JUMPS[name]) for source in (other, HERE.parent / "src"))

    def lost(run: dict) -> list[float]:
        works = (run["columns"][f"{name}_work_J"] for name in ("loading", "unloading"))
        return [1e18 * (a - b) for a, b in zip(*works, strict=True)]

    finer = finer_loss(name)
    off = max(abs(one / finer - 1) for one in lost(new))
    shown = (", ".join(f"{one:.3f}" for one in lost(run)) for run in (old, new))
    columns = (
        f"{old['seconds']:.1f}",
        f"{new['seconds']:.1f}",
        *shown,
        f"{finer:.3f}",
        f"{off:.1%}",
    )
    return f"| {name} | {' | '.join(columns)} |"


def finer_loss(name: str) -> float:
    """Loss (aJ) of an impact whose path is followed with shorter steps."""
    from restitution.case.case_file import parse_case
    from restitution.contact.cohesive.loading import load_cohesive
    from restitution.contact.cohesive.steps import ACCURACY
    from restitution.contact.models import RESTITUTION_ERROR
    from restitution.contact.path import unloading_path

    contact = parse_case(text_of(JUMPS[name])).contact(Path())
    accuracy = FINER * ACCURACY
    state = load_cohesive(contact, 2e-9, start=None, residual=1e-8, accuracy=accuracy)
    *_, last = unloading_path(state, tolerance=FINER * RESTITUTION_ERROR)
    return 1e18 * last.adhesive_loss


def beside(python: str, nodes: int = 128, steps: int = 40) -> str:
    import time

    import numpy as np

    import restitution as rs
    from restitution.contact.cohesive.equilibrium import rigid_start, solve_cohesive
    from restitution.contact.contact import whole_grid
    from restitution.contact.influence import half_space

    body = rs.Body(radius=5e-6, youngs_modulus=70e9, poissons_ratio=0.17, density=2200)
    grid = rs.Grid(nodes=(nodes, nodes), spacing=(3e-9, 3e-9))
    surface = rs.generate_surface(grid, kind="gaussian", rms=1e-9, correlation_length=50e-9, seed=1)
    contact = rs.Contact(rs.Pair(body, body), surface, adhesion=rs.Cohesive(0.05))
    depths = np.linspace(-0.6e-9, 2e-9, steps)
    modulus, z0 = contact.pair.contact_modulus, contact.adhesion.equilibrium_separation
    K = half_space(grid.nodes, grid.spacing, modulus)
    with tempfile.TemporaryDirectory() as folder:
        inputs = Path(folder) / "input.npz"
        np.savez(
            inputs,
            gap=contact.gap,
            spacing=grid.spacing[0],
            modulus=modulus,
            work=0.05,
            separation=z0,
            depths=depths,
            diagonal=K.diagonal,
            tolerance=3e-6,
        )
        done = subprocess.run(
            [python, "-W", "ignore", str(HERE / "peers/solve_adhesion.py"), str(inputs)],
            env={**os.environ, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"},
            check=True,
            stdout=subprocess.PIPE,
            text=True,
        )
    theirs = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
    residual, seconds, energies, box = 1e-8, [], [], whole_grid(contact)
    earlier, state = None, rigid_start(contact, limit=math.inf, residual=residual)
    p = np.zeros(grid.nodes)
    p[state.box] = state.box_pressure
    for depth in depths:
        guess = p
        if earlier is not None:
            guess = 2 * p - earlier
        began = time.process_time()
        state = solve_cohesive(
            contact,
            depth,
            box,
            start=(guess, None),
            limit=math.inf,
            history=None,
            residual=residual,
        )
        seconds.append(time.process_time() - began)
        earlier, p = p, state.box_pressure
        inside = float(state.contact.adhesion.energy(_gap(state)).sum()) * grid.cell_area
        energies.append((state.stored_energy + inside) * 1e18)
    converged = [row["residual"] <= LOOSE for row in theirs]
    pairs = zip(energies, theirs, converged, strict=True)
    off = max(abs(energy - row["energy"]) for energy, row, good in pairs if good)
    total = sum(row["seconds"] for row in theirs)
    return PEER.format(
        nodes=nodes,
        steps=steps,
        first=depths[0] * 1e9,
        last=depths[-1] * 1e9,
        theirs=total,
        ours=sum(seconds),
        ratio=total / sum(seconds),
        their_step=theirs[-1]["seconds"],
        our_step=seconds[-1],
        step_ratio=theirs[-1]["seconds"] / seconds[-1],
        theirs_residual=statistics.median(row["residual"] for row in theirs),
        loose=LOOSE,
        failed=converged.count(False),
        ours_residual=max(1e-7, 100 * residual),
        difference=off / max(map(abs, energies)),
    )


def _gap(state):
    from restitution.contact.cohesive.equilibrium import box_gap

    return box_gap(state)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("other", type=Path)
    parser.add_argument("--peer")
    parser.add_argument("--repeats", type=int, default=3)
    given = parser.parse_args()
    rows, errors = [], []
    here = HERE.parent / "src"
    for name, case in CASES.items():
        runs = []
        for _ in range(given.repeats):
            old, new = (in_process(source, case) for source in (given.other / "src", here))
            runs.append((old, new, in_process(here, case, total_error=True)))
        old, new, both = (
            statistics.median(run["seconds"] for run in kind) for kind in zip(*runs, strict=True)
        )
        memory = (
            f"{max(run['memory'] for run in kind):.0f}" for kind in [*zip(*runs, strict=True)][:2]
        )
        rows.append(
            f"| {name} | {old:.2f} | {new:.2f} | {old / new:.1f} | {differences(*runs[0][:2])} | "
            f"{' | '.join(memory)} |"
        )
        print(rows[-1], flush=True)
        ratio = statistics.median(b["seconds"] / a["seconds"] for _, a, b in runs) - 1
        errors.append(f"| {name} | {new:.2f} | {both - new:.2f} | {ratio:.1f} |")
        print(errors[-1], flush=True)
    lost = []
    for name in JUMPS:
        lost.append(losses(given.other / "src", name))
        print(lost[-1], flush=True)
    peer = beside(given.peer) if given.peer else ""
    OUT.write_text(
        REPORT.format(
            date=today(),
            machine=machine(),
            repeats=given.repeats,
            rows="\n".join(rows),
            errors="\n".join(errors),
            finer=FINER,
            losses="\n".join(lost),
            peer=peer,
        )
    )


if __name__ == "__main__":
    main()
