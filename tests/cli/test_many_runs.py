"""Cases that take several runs: ensembles of surfaces, and successive grids."""

import csv
import json

import pytest


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_an_ensemble_from_start_to_figures(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace("seed = 1", "seed = 1\nrealisations = 3"))
    status, said, _ = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 0
    assert "4 depths of 3 curves" in said
    assert " ± 0." in said
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {
        "results.nc",
        "curve.csv",
        "summary.json",
        "realisations.csv",
        "load-displacement.png",
        "restitution-indentation.png",
        "restitution-velocity.png",
        "realisation-1",
        "realisation-2",
        "realisation-3",
        "SHA256SUMS",
    }
    rows = rows_of(tmp_path / "out" / "curve.csv")
    assert list(rows[0])[-4:] == [
        "realisations",
        "restitution_std",
        "restitution_low",
        "restitution_high",
    ]
    for row in rows:
        low, mean, high = (float(row[f"restitution{end}"]) for end in ("_low", "", "_high"))
        assert low < mean < high
    each = rows_of(tmp_path / "out" / "realisations.csv")
    assert [row["realisation"] for row in each] == ["1"] * 4 + ["2"] * 4 + ["3"] * 4


def test_an_ensemble_is_described_before_it_is_run(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text.replace("seed = 1", "seed = 1\nrealisations = 3"))
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert status == 0
    assert "realisations" in said


def test_convergence_from_start_to_figures(cli, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    status, said, _ = cli("converge", tmp_path / "case.toml", "-o", tmp_path / "out", "--grids", 2)
    assert status == 0
    assert "refine = 1, 2" in said
    assert " ± 0." in said
    names = {path.name for path in (tmp_path / "out").iterdir()}
    assert names == {
        "results.nc",
        "curve.csv",
        "convergence.csv",
        "summary.json",
        "load-displacement.png",
        "restitution-indentation.png",
        "restitution-velocity.png",
        "pressure.png",
        "refine-1",
        "refine-2",
        "SHA256SUMS",
    }
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["diagnostics"]["largest_discretisation_error"] > 0


@pytest.mark.parametrize("verb", ["run", "converge"])
def test_a_grid_that_is_found(cli, case_text, tmp_path, verb):
    text = case_text.replace("[indentation]", 'refine = "auto"\n[indentation]')
    text = text.replace('from = "20 nm"', 'from = "150 nm"').replace("steps = 4", "steps = 2")
    (tmp_path / "case.toml").write_text(text)
    more = ("--grids", 2) if verb == "converge" else ()
    status, _, _ = cli(verb, tmp_path / "case.toml", "-o", tmp_path / "out", *more)
    assert status == 0
    assert rows_of(tmp_path / "out" / "curve.csv")[0]["resolved"] == "true"
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert 'or more (refine = "auto")' in said


def test_what_cannot_converge_is_refused(refused, case_text, tmp_path):
    text = case_text.replace("seed = 1", "seed = 1\nrealisations = 2")
    (tmp_path / "case.toml").write_text(text)
    message = refused("converge", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert "case.toml: roughness.realisations: a convergence study uses one surface" in message
    assert not (tmp_path / "out").exists()
