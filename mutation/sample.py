"""Mutate random lines of one room and count the mutants that its tests kill.

    python mutation/sample.py contact --mutants 100 --seed 1

needs cosmic-ray (`pip install cosmic-ray`, in any environment) and `make test` once before. It
works on a copy of the repository, whose tests have to pass, prints each survivor with its
difference, and ends with the share that was killed. docs/mutation.md has the last results, with a
word on every survivor.
"""

from __future__ import annotations

import argparse
import contextlib
import os
import random
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parents[1]
ROOMS = {
    "contact": (
        "tests/contact tests/test_collision.py tests/runs/test_messages.py tests/test_house.py",
        "src/restitution/contact",
    ),
    "numerics": (
        "tests/numerics tests/contact/test_equilibrium.py tests/contact/test_threads.py "
        "tests/test_house.py",
        "src/restitution/numerics",
    ),
    "laws": ("tests/laws tests/test_house.py", "src/restitution/laws"),
}
BITS = ("BitOr", "BitAnd", "BitXor", "LShift", "RShift")
CONFIG = """
[cosmic-ray]
module-path = "{module}"
timeout = 3600.0
excluded-modules = []
test-command = "{command}"
[cosmic-ray.distributor]
name = "local"
"""


def main() -> None:
    """Draw, run and report."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("room", choices=ROOMS)
    parser.add_argument("--mutants", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--cosmic-ray", default=shutil.which("cosmic-ray") or "cosmic-ray")
    options = parser.parse_args()
    tests, module = ROOMS[options.room]
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(HERE, copy, ignore=shutil.ignore_patterns(".git", ".venv*", "demo"))
        python = HERE / ".venv" / "bin" / "python"
        plugins = "-p no:cacheprovider -p shortest_first"
        command = f"{python} -m pytest -q -x {plugins} {tests}"
        (copy / "mutate.toml").write_text(CONFIG.format(module=module, command=command))
        environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(copy / "src"), str(copy / "mutation")]),
            "MUTATION_TIMES": str(Path(folder) / "times.json"),
            "DUCC0_NUM_THREADS": "1",
        }

        def run(*arguments: str) -> None:
            subprocess.run(
                [options.cosmic_ray, *arguments],
                cwd=copy,
                env=environment,
                check=True,
                stdout=sys.stderr,
            )

        run("init", "mutate.toml", "session.sqlite")
        keep(copy, options.mutants, options.seed)
        subprocess.run(command.split(), cwd=copy, env=environment, check=True, stdout=sys.stderr)
        run("exec", "mutate.toml", "session.sqlite")
        report(copy / "session.sqlite")


def keep(copy: Path, mutants: int, seed: int) -> None:
    """Leave a random sample of the mutants in the session, the same for the same seed."""
    session = copy / "session.sqlite"
    with contextlib.closing(sqlite3.connect(session)) as base, base:
        rows = base.execute(
            "select job_id, operator_name, module_path, start_pos_row from mutation_specs "
            "order by module_path, operator_name, occurrence"
        ).fetchall()
        lines = {path: (copy / path).read_text().splitlines() for _, _, path, _ in rows}
        jobs = [job for job, name, path, row in rows if not pointless(name, lines[path][row - 1])]
        chosen = set(random.Random(seed).sample(jobs, min(mutants, len(jobs))))
        print(f"{len(chosen)} of {len(jobs)} mutants", flush=True)
        gone = [(job,) for job, *_ in rows if job not in chosen]
        base.executemany("delete from mutation_specs where job_id = ?", gone)
        base.executemany("delete from work_items where job_id = ?", gone)


def pointless(operator: str, line: str) -> bool:
    """Whether a mutation of `line` is known to change nothing, or known to be noticed.

    A mutated `|` is nearly always in a type hint, which is not evaluated. Arithmetic on floats that
    becomes a bit operation raises a TypeError at once. `strict` of `zip` guards against lengths
    that differ, which they never do.
    """
    if "ReplaceBinaryOperator" in operator:
        before, after = operator.split("_")[1:]
        return before == "BitOr" or (after in BITS and before not in BITS)
    return "ReplaceTrueWithFalse" in operator and "strict=True" in line


def report(session: Path) -> None:
    """Print the survivors and the share that was killed."""
    with contextlib.closing(sqlite3.connect(session)) as base:
        rows = base.execute(
            "select r.test_outcome, m.module_path, m.operator_name, m.start_pos_row, r.diff "
            "from work_results r join mutation_specs m on r.job_id = m.job_id "
            "order by m.module_path, m.start_pos_row"
        ).fetchall()
    killed = 0
    for outcome, path, operator, line, difference in rows:
        if str(outcome).rpartition(".")[2].upper() == "SURVIVED":
            print(f"survived: {path}:{line} {operator}\n{difference}")
        else:
            killed += 1
    print(f"{killed} of {len(rows)} killed ({killed / max(len(rows), 1):.0%})")


if __name__ == "__main__":
    main()
