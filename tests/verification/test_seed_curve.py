"""The whole rough curve of the seed case through the command line."""

import csv
import os
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "steel.toml"


@pytest.fixture(scope="module")
def curve(tmp_path_factory):
    out = tmp_path_factory.mktemp("seed") / "out"
    process = subprocess.Popen(
        [sys.executable, "-m", "restitution", "run", EXAMPLE, "-o", out],
        env={**os.environ, "NO_COLOR": "1"},
        stdout=subprocess.DEVNULL,
    )
    # Of this child alone: other tests have had larger ones.
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    assert process.returncode == 0
    peak = usage.ru_maxrss * 1024
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
        assert row["loading_work_J"] == pytest.approx(
            row["stored_energy_J"] + row["plastic_work_J"], rel=1e-12
        )
        assert row["restitution"] ** 2 == pytest.approx(
            row["unloading_work_J"] / row["loading_work_J"], rel=1e-9
        )
