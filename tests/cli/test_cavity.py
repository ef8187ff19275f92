"""A yield strength in a case file: through every verb that takes a run."""

import csv
import json
import math

import pytest

from tolerance import approx


@pytest.fixture
def case(case_text, tmp_path):
    """The small case with a yield strength, hardening, and impact velocities."""

    text = case_text.replace(
        'yield_pressure = "750 MPa"',
        'yield_strength = "268 MPa"\ntangent_modulus = "2 GPa"\nwork_of_adhesion = "0 J/m^2"',
    )
    begin, end = text.index("[indentation]"), text.index("[unloading]")
    text = text[:begin] + '[impact]\nvelocity = ["0.02 m/s", "0.1 m/s"]\n' + text[end:]
    (tmp_path / "case.toml").write_text(text)
    return tmp_path / "case.toml"


def table(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_run_law_report_and_export(cli, case, tmp_path):
    status, out, _ = cli("check", case)
    assert status == 0
    assert "yield strength Y" in out
    status, out, _ = cli("run", case, "-o", tmp_path / "run")
    assert status == 0
    assert "± model" in out
    rows = table(tmp_path / "run" / "curve.csv")
    for row, velocity in zip(rows, (0.02, 0.1), strict=True):
        assert float(row["impact_velocity_m_per_s"]) == approx(velocity, rel=1e-3, abs=0)
        assert 0.001 < float(row["model_error"]) < 0.1
        assert float(row["total_error"]) >= float(row["restitution_error"]) > 0
    summary = json.loads((tmp_path / "run" / "summary.json").read_text())
    assert summary["model"]["plasticity"] == "expanding-cavity"
    assert summary["diagnostics"]["largest_model_error"] == max(
        float(r["model_error"]) for r in rows
    )
    assert "2.8 times the yield strength" in summary["conventions"]["yield_pressure"]
    for verb in (
        ("fit-law", tmp_path / "run", "-o", tmp_path / "law"),
        ("report", tmp_path / "run"),
    ):
        status, out, said = cli(*verb)
        assert status == 0, said
    law = json.loads((tmp_path / "law" / "law.json").read_text())
    assert "model_error is up to" in law["conventions"]["restitution_error"]
    assert law["yield_pressure"] == approx(2.8 * 268e6, rel=1e-9, abs=0)
    page = (tmp_path / "run" / "report.html").read_text()
    assert "model_error" in page
    assert "Johnson (1970)" in page
    status, _, said = cli("compare-theory", case, "--law", tmp_path / "law")
    assert status == 0, said


def test_ensemble_and_converge(cli, case, tmp_path):
    several = tmp_path / "several.toml"
    several.write_text(case.read_text().replace("seed = 1", "seed = 1\nrealisations = 2"))
    assert cli("run", several, "-o", tmp_path / "several")[0] == 0
    rows = table(tmp_path / "several" / "curve.csv")
    parts = [table(tmp_path / "several" / f"realisation-{n}" / "curve.csv") for n in (1, 2)]
    for row, *each in zip(rows, *parts, strict=True):
        assert float(row["model_error"]) == max(float(one["model_error"]) for one in each)
    assert cli("converge", case, "-o", tmp_path / "fine", "--grids", "2")[0] == 0
    assert all(float(row["model_error"]) > 0 for row in table(tmp_path / "fine" / "curve.csv"))


def test_a_study_sweeps_the_strength(cli, case, tmp_path):
    study = tmp_path / "study.toml"
    text = case.read_text() + '[sweep]\n"interface.yield_strength" = ["200 MPa", "400 MPa"]\n'
    study.write_text("total_error = false\n" + text)
    status, _, said = cli("study", study, "-o", tmp_path / "study", "--workers", "1")
    assert status == 0, said
    rows = table(tmp_path / "study" / "table.csv")
    cor = {row["interface.yield_strength"]: [] for row in rows}
    for row in rows:
        cor[row["interface.yield_strength"]].append(float(row["restitution"]))
    weak, strong = cor["200 MPa"], cor["400 MPa"]
    assert all(a < b for a, b in zip(weak, strong, strict=True))
    assert not any(math.isnan(e) for e in weak + strong)
