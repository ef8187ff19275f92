"""Halve or drop every error bar, one at a time, and see that a test fails.

    python evidence/mutation/error_bars.py [--python PYTHON] [NAME ...]

works on a copy of the repository, after `make test`. A bar that survives is printed, and the exit
status is then 1. `--python` names another Python to run the tests with than that of `make test`.
"""

from __future__ import annotations

import argparse
import os
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

HERE = Path(__file__).resolve().parents[2]
TESTS = {
    "contact/jkr/loading_work.py": "contact/test_work_error.py contact/test_balance.py "
    "contact/test_loading.py",
    "contact/jkr/limit.py": "contact/test_work_error.py contact/test_loading.py "
    "contact/test_model_error.py contact/test_separation.py "
    "verification/test_adhesive_restitution.py",
    "contact/plasticity/cavity.py": "contact/test_work_error.py contact/test_cavity.py "
    "contact/test_model_error.py",
    "contact/plasticity/increments.py": "contact/test_work_error.py contact/test_cavity.py",
    "contact/plasticity/truncated.py": "contact/test_work_error.py contact/test_loading.py",
    "contact/plasticity/bound.py": "contact/test_model_error.py",
    "contact/jkr/separation.py": "contact/test_separation.py contact/test_cohesive.py "
    "contact/test_energy_account.py test_collision.py verification/test_adhesive_restitution.py",
    "contact/cohesive/law.py": "contact/test_cohesive.py",
    "contact/cohesive/steps.py": "contact/test_cohesive.py contact/test_periodic_cohesive.py",
    "contact/cohesive/separation.py": "contact/test_cohesive.py contact/test_periodic_cohesive.py",
    "collision.py": "test_collision.py contact/test_energy_account.py contact/test_separation.py "
    "verification/test_adhesive_restitution.py",
    "numerics/quadrature.py": "numerics/test_quadrature.py",
    "runs/error_budget.py": "runs/test_error_budget.py",
    "runs/convergence.py": "runs/test_convergence.py",
    "runs/ensemble.py": "runs/test_ensemble.py",
    "runs/oblique.py": "runs/test_oblique_impacts.py",
    "results/compare.py": "cli/test_compare.py",
    "curve/point.py": "curve/test_total_error.py runs/test_error_budget.py",
    "fit/uncertainty.py": "fit/test_uncertainty.py fit/test_fit.py",
    "mixtures/scaling.py": "mixtures/test_mixture.py",
    "laws/law.py": "curve/test_interpolation.py laws/test_law.py",
    "impacts/oblique.py": "impacts/test_oblique.py",
    "impacts/tangential_error.py": "impacts/test_tangential_error.py impacts/test_oblique.py",
    "curve/interpolation.py": "curve/test_interpolation.py",
    "laws/compact_fit.py": "laws/test_compact_fit.py",
}


def survives(copy: Path, python: Path, bar: dict[str, str]) -> bool:
    """Whether the tests of its module pass on the copy with this bar changed."""
    file, old, new = bar["file"], bar["stands"], bar["becomes"]
    path = copy / "src" / "restitution" / file
    text = path.read_text(encoding="utf-8")
    if text.count(old) != 1:
        raise SystemExit(f"{file}: {text.count(old)} times, not once: {old}")
    path.write_text(text.replace(old, new), encoding="utf-8")
    environment = {**os.environ, "PYTHONPATH": str(copy / "src"), "DUCC0_NUM_THREADS": "1"}
    command = [python, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    try:
        ended = subprocess.run(
            [*command, *(f"tests/{test}" for test in TESTS[file].split())],
            cwd=copy,
            env=environment,
            capture_output=True,
            check=False,
        )
    finally:
        path.write_text(text, encoding="utf-8")
    if ended.returncode not in (0, 1):
        raise SystemExit(f"{file}: the tests cannot run\n{ended.stdout.decode()}")
    return ended.returncode == 0


def main() -> None:
    """Change one bar after the other."""
    bars = tomllib.loads(Path(__file__).with_name("bars.toml").read_text(encoding="utf-8"))
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("names", nargs="*", metavar="NAME")
    parser.add_argument("--python", type=Path, default=HERE / ".venv" / "bin" / "python")
    options = parser.parse_args()
    names = options.names or list(bars)
    survivors = []
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy"
        shutil.copytree(HERE, copy, ignore=shutil.ignore_patterns(".git", ".venv*", "demo"))
        for name in names:
            survived = survives(copy, options.python, bars[name])
            print(f"{name}: {'SURVIVED' if survived else 'killed'}", flush=True)
            survivors += [name] * survived
    print(f"{len(names) - len(survivors)} of {len(names)} killed")
    sys.exit(bool(survivors))


if __name__ == "__main__":
    main()
