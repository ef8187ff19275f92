"""Adhesion with a range through the command line: the choice of the model, and refusals."""

import csv
import json

import pytest

from tolerance import approx

CASE = """
total_error = false
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "1.5 GPa"
work_of_adhesion = "0.02 J/m^2"
adhesion = "cohesive"
[grid]
nodes = 60
spacing = "0.08 um"
[indentation]
values = ["3 nm", "6 nm"]
[unloading]
curves = 1
"""
GIVEN = 'adhesion = "cohesive"\n'


@pytest.fixture
def run(cli, tmp_path):
    def call(*replacements):
        text = CASE
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new, 1)
        (tmp_path / "case.toml").write_text(text)
        out = tmp_path / f"out-{len(list(tmp_path.iterdir()))}"
        status, _, warned = cli("run", tmp_path / "case.toml", "-o", out)
        assert status == 0, warned
        with open(out / "curve.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        return rows, json.loads((out / "summary.json").read_text()), warned

    return call


def test_a_run_states_its_attraction(run):
    rows, summary, _ = run()
    assert summary["model"]["adhesion"].startswith("Lennard-Jones")
    assert "detachment" not in summary["model"]
    assert all(row["adhesion_resolved"] == "true" for row in rows)
    # µ = 0.67: no loss, where JKR would stick
    assert all(float(row["restitution"]) > 0.99 for row in rows)
    check = summary["diagnostics"]["unloading_checks"][0]
    assert check["relative_to_stored_energy"] == approx(0.0, abs=0.005)
    assert check["unloading_work_J"] == approx(float(rows[-1]["unloading_work_J"]), rel=0.03)


def test_the_grid_chooses_the_model(run):
    fine, summary, warned = run((GIVEN, ""))
    assert summary["model"]["adhesion"].startswith("Lennard-Jones")
    assert "interface.adhesion" not in warned
    coarse, summary, warned = run((GIVEN, ""), ("0.08 um", "0.25 um"))
    assert summary["model"]["adhesion"] == "JKR limit"
    assert "interface.adhesion is not given" in warned
    assert "needs a spacing of 82.16 nm" in warned
    # the model error of JKR covers the difference
    for with_range, without in zip(fine, coarse, strict=True):
        off = abs(float(with_range["restitution"]) - float(without["restitution"]))
        assert off <= float(without["model_error"]) + float(without["restitution_error"]) + 0.01


def test_keys_of_jkr_choose_jkr(run):
    _, summary, _ = run((GIVEN, 'approach = "hertzian"\n'))
    assert summary["model"]["adhesion"] == "JKR limit"


def test_refine_auto_finds_the_spacing(run):
    auto = ('spacing = "0.08 um"', 'spacing = "0.16 um"\nrefine = "auto"')
    _, summary, _ = run(auto, ("nodes = 60", "nodes = 30"), ('"3 nm", "6 nm"', '"6 nm"'))
    assert summary["model"]["refine"] >= 2


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (
            '"0.08 um"',
            '"0.25 um"',
            ("cells of 250 nm", "82.16 nm", "multiply grid.refine by 4"),
        ),
        (GIVEN, GIVEN + 'detachment = "pohrt-popov"\n', ("detachment", "cohesive")),
        (GIVEN, GIVEN + 'approach = "hertzian"\n', ("approach", "cohesive")),
        (GIVEN, GIVEN + 'approach = "pull-increments"\n', ("approach", "cohesive")),
        (GIVEN, GIVEN + 'plasticity = "truncated"\n', ("truncated", "cohesive")),
        (GIVEN, GIVEN + 'equilibrium_separation = "-0.3 nm"\n', ("equilibrium_separation",)),
        (GIVEN, 'adhesion = "dmt"\n', ("interface.adhesion",)),
        ('work_of_adhesion = "0.02 J/m^2"\n', "", ("adhesion", "work_of_adhesion")),
    ],
)
def test_refusals_are_one_line(refused, tmp_path, old, new, words):
    assert old in CASE
    (tmp_path / "case.toml").write_text(CASE.replace(old, new, 1))
    message = refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert not (tmp_path / "out").exists()
    assert len(message.strip().splitlines()) == 1
    for word in words:
        assert word in message
