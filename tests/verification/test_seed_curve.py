"""The whole rough curve of the seed case through the command line."""

import csv
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tolerance import approx

CASE = Path(__file__).parents[2] / "benchmarks" / "steel.toml"

# Linux counts the size of a parent as its child's until the child runs its own program, and a
# process of these tests may be large: so a small one starts the run.
MEASURED = """
import json, os, subprocess, sys
process = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(process.pid, 0)
print(json.dumps([os.waitstatus_to_exitcode(status), usage.ru_maxrss * 1024]))
"""


@pytest.fixture(scope="module")
def curve(tmp_path_factory):
    out = tmp_path_factory.mktemp("seed") / "out"
    run = [sys.executable, "-m", "restitution", "run", CASE, "-o", out]
    measured = subprocess.run(
        [sys.executable, "-c", MEASURED, *run],
        env={**os.environ, "NO_COLOR": "1"},
        stdout=subprocess.PIPE,
        check=True,
    )
    code, peak = json.loads(measured.stdout)
    assert code == 0
    with open(out / "curve.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    no_numbers = ("true", "false", "")
    numbers = [{k: float(v) for k, v in row.items() if v not in no_numbers} for row in rows]
    return numbers, peak


def test_the_memory_stays_below_one_gibibyte(curve):
    assert curve[1] < 2**30


def test_it_has_the_three_stages_of_a_rough_contact(curve):
    """Asperities yield, the bulk takes over, the bulk yields (Ghanbarzadeh 2019, fig. 10)."""
    cor = [row["restitution"] for row in curve[0]]
    assert len(cor) == 24
    bottom = cor.index(min(cor[:16]))
    top = bottom + cor[bottom:].index(max(cor[bottom:]))
    assert cor[0] > cor[bottom] + 0.3
    assert cor[top] > cor[bottom] + 0.2
    assert cor[-1] < cor[top] - 0.2
    assert 0 < bottom < top < 23


def test_every_depth_meets_the_residual_and_the_energy_balance(curve):
    for row in curve[0]:
        assert row["residual"] <= 1e-8
        assert row["convolutions"] <= 90
        assert row["loading_work_J"] == approx(
            row["stored_energy_J"] + row["plastic_work_J"], rel=1e-12
        )
        assert row["restitution"] ** 2 == approx(
            row["unloading_work_J"] / row["loading_work_J"], rel=1e-9
        )
