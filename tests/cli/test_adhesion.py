"""Adhesive cases through the command line."""

import csv
import json
import re

import pytest

from tolerance import approx

CASE = """
title = "A small adhesive contact"
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "1.5 GPa"
work_of_adhesion = "0.09 J/m^2"
approach = "hertzian"
[grid]
nodes = 56
spacing = "0.07 um"
[indentation]
values = ["1.5 nm", "10 nm"]
[unloading]
curves = 1
restitution_error = 0.05
"""
NEW = [
    "pull_off_force_N",
    "pull_off_error_N",
    "separation_indentation_m",
    "restitution_error",
    "sticks",
    "adhesion_resolved",
]


@pytest.fixture
def run(cli, tmp_path):
    """Run the case with parts of its text replaced: rows, summary, what was said on stderr."""

    def call(*replacements):
        text = CASE
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "case.toml").write_text(text)
        status, _, warned = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
        assert status == 0, warned
        with open(tmp_path / "out" / "curve.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        return rows, json.loads((tmp_path / "out" / "summary.json").read_text()), warned

    return call


@pytest.fixture
def refusal(refused, tmp_path):
    def call(old, new):
        assert old in CASE
        (tmp_path / "case.toml").write_text(CASE.replace(old, new, 1))
        message = refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")
        assert not (tmp_path / "out").exists()
        return message

    return call


def test_the_run_says_whether_it_sticks_and_is_resolved(run, tmp_path):
    rows, summary, _ = run()
    first = list(rows[0]).index(NEW[0])
    assert list(rows[0])[first : first + len(NEW)] == NEW
    assert [row["sticks"] for row in rows] == ["true", "false"]
    assert [row["adhesion_resolved"] for row in rows] == ["true", "true"]
    assert float(rows[0]["restitution"]) == 0
    assert float(rows[0]["unloading_work_J"]) <= 0
    assert 0 < float(rows[1]["restitution"]) < 1
    for row in rows:
        assert float(row["pull_off_force_N"]) == approx(1.06e-4, rel=0.25)
        assert float(row["separation_indentation_m"]) < 0
        assert 0 <= float(row["restitution_error"]) <= 0.05
    assert summary["status"] == "complete"
    assert len(summary["seconds_by_depth"]) == len(rows)
    assert 0 < sum(summary["seconds_by_depth"]) <= summary["seconds"]
    model = summary["model"]
    assert (model["adhesion"], model["approach"]) == ("JKR limit", "hertzian")
    assert (model["detachment"], model["unloading"]) == ("crack-closure", "path")
    assert summary["derived"]["work_of_adhesion_J_per_m2"] == 0.09
    assert not any("adhesion is not resolved" in warning for warning in summary["warnings"])

    with open(tmp_path / "out" / "unloading.csv", newline="") as file:
        force = [float(row["force_N"]) for row in csv.DictReader(file)]
    assert force[0] == float(rows[1]["force_N"])
    assert min(force) == approx(-float(rows[1]["pull_off_force_N"]), rel=1e-12)
    assert force[-1] == 0


def test_results_keep_the_flags(run, tmp_path):
    import xarray as xr

    rows, *_ = run(("curves = 1", 'curves = 0\nmethod = "energy-estimate"'))
    with xr.open_dataset(tmp_path / "out" / "results.nc") as results:
        assert [bool(v) for v in results["sticks"]] == [row["sticks"] == "true" for row in rows]
        assert [bool(v) for v in results["adhesion_resolved"]] == [True, True]
        assert results["pull_off_force"].attrs["units"] == "N"


def test_without_adhesion_nothing_sticks_and_nothing_pulls(run):
    rows, summary, _ = run(('"0.09 J/m^2"', '"0 J/m^2"'))
    assert [row["sticks"] for row in rows] == ["false", "false"]
    assert [float(row["pull_off_force_N"]) for row in rows] == [0, 0]
    assert [row["adhesion_resolved"] for row in rows] == ["true", "true"]
    assert summary["model"]["adhesion"] == "none"
    assert "pull_off_radius_m" not in summary["derived"]


def test_a_coarse_grid_runs_and_says_so(run):
    rows, summary, warned = run(
        ("nodes = 56", "nodes = 24"),
        ('"0.07 um"', '"0.7 um"'),
        ('["1.5 nm", "10 nm"]', '["15 nm", "40 nm"]'),
    )
    assert summary["derived"]["nodes_over_pull_off_radius"] < 1
    assert [row["adhesion_resolved"] for row in rows] == ["false", "false"]
    said = "adhesion is not resolved at 2 of 2 depths"
    assert any(said in warning for warning in summary["warnings"])
    assert said in warned


def test_the_energy_estimate_has_no_pull_off_force(run):
    rows, summary, _ = run(("curves = 1", 'curves = 0\nmethod = "energy-estimate"'))
    for row in rows:
        assert row["pull_off_force_N"] == ""
        assert row["separation_indentation_m"] == ""
        assert float(row["restitution_error"]) > 0
    assert rows[0]["sticks"] == "true"
    assert 0 < float(rows[1]["restitution"]) < 1
    assert summary["model"]["unloading"] == "energy-estimate"


def test_check_prints_what_adhesion_asks_of_the_grid(cli, tmp_path):
    (tmp_path / "case.toml").write_text(CASE)
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert status == 0
    for line in (
        r"work of adhesion w\s+0.09\s+J/m\^2",
        r"pull-off force F_c, smooth\s+0.000106\d*\s+N",
        r"pull-off radius a_c, smooth\s+0.562\s+um",
        r"nodes over the pull-off radius, a_c/h\s+8.02\d*",
        r"expected error of pull-off on this grid\s+[\d.]+\s+%",
        r"Tabor parameter \(large in the JKR limit\)\s+[\d.]+",
        r"sticking velocity V_s, smooth elastic\s+[\d.e-]+\s+m/s",
    ):
        assert re.search(line, said), line
    assert [path.name for path in tmp_path.iterdir()] == ["case.toml"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"0.09 J/m^2"', '"-0.09 J/m^2"', ("interface.work_of_adhesion", "negative")),
        ('"0.09 J/m^2"', '"0.09 N"', ("interface.work_of_adhesion", "0.09 J/m^2")),
        ('"0.09 J/m^2"', "0.09", ("interface.work_of_adhesion", "no unit")),
        (
            '"hertzian"',
            '"hertz"',
            ("interface.approach", "hertzian", "equilibrium", "pull-increments"),
        ),
        ('"hertzian"', '"hertzian"\ndetachment = "vcct"', ("interface.detachment", "pohrt")),
        ("curves = 1", 'method = "guess"', ("unloading.method", "energy-estimate")),
    ],
)
def test_refusals_are_one_line_that_names_the_key(refusal, old, new, words):
    message = refusal(old, new)
    for word in words:
        assert word in message


def test_a_seed_that_lets_go_of_everything_is_a_row_without_an_impact(cli, run, tmp_path):
    """The surface is so soft that the pull of 0.1 nm takes all of it apart."""
    rows, summary, _ = run(
        ('"1.5 GPa"', '"1 MPa"'),
        ('"0.09 J/m^2"', '"0.001 J/m^2"'),
        ('"hertzian"', '"pull-increments"'),
        ('"0.07 um"', '"0.5 um"'),
        ('["1.5 nm", "10 nm"]', '["0.05 nm", "0.1 nm"]'),
    )
    assert [row["force_N"] for row in rows] == ["0.0", "0.0"]
    for name in ("restitution", "restitution_error", "model_error"):
        assert [row[name] for row in rows] == ["", ""]
    assert [row["sticks"] for row in rows] == ["false", "false"]
    assert summary["status"] == "complete"
    assert cli("report", tmp_path / "out")[0] == 0
