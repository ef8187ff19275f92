"""Whole tasks in Python: run a case, open its results, make a law, export it."""

import copy
import pickle
import re
import tomllib
from importlib import metadata
from pathlib import Path

import numpy as np
import pytest

import restitution as rs
from restitution.curve.curve import Curve
from restitution.errors import DomainError, OutputError
from tolerance import approx


@pytest.fixture(scope="module")
def case(case_text):
    """Tables of the small case, at depths that its grid resolves."""
    tables = tomllib.loads(case_text)
    tables["indentation"] = {"values": ["100 nm", "200 nm", "250 nm", "300 nm"]}
    tables["total_error"] = False
    return tables


@pytest.fixture(scope="module")
def results(case, tmp_path_factory):
    said = []
    found = rs.run(case, out=tmp_path_factory.mktemp("api") / "results", progress=said.append)
    assert said[-1] == "4 of 4 depths"
    return found


def test_a_run_gives_a_table_with_units(results):
    table = results.dataset
    assert table["restitution"].sizes == {"indentation_max": 4}
    assert table["force"].attrs["units"] == "N"
    assert table["indentation"].values == approx([1e-7, 2e-7, 2.5e-7, 3e-7])
    assert results.summary["status"] == "complete"
    assert 'RunResults: "A small rough contact", complete, 0 warnings' in repr(results)
    assert "4 of 4 depths to 300 nm, COR 0." in results._repr_html_()
    assert repr(results.curve) == "Curve: 4 points: COR 0.6387 to 0.6619"
    assert re.fullmatch(r"UnloadingCurve: \d+ points from 300 nm", repr(results.unloading[-1]))


def test_a_case_file_and_its_tables_give_the_same(results, case_text, tmp_path):
    text = case_text.replace('from = "20 nm"\nto = "300 nm"\nsteps = 4', 'values = ["100 nm"]')
    (tmp_path / "case.toml").write_text("total_error = false\n" + text)
    found = rs.run(str(tmp_path / "case.toml"), out=str(tmp_path / "out"))
    assert found.curve.rows[0]["force_N"] == results.curve.rows[0]["force_N"]


def test_warnings_of_a_run_are_issued(case, tmp_path):
    shallow = case | {"indentation": {"values": ["20 nm", "300 nm"]}}
    with pytest.warns(UserWarning, match="not resolved"):
        rs.run(shallow, out=tmp_path / "out")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"grid": {"nodes": 72}}, 'case: grid: the key "spacing" is missing'),
        ({"title": Path("a")}, "case: .*; use only types of values that a case file allows"),
    ],
)
def test_tables_that_are_wrong_are_refused(case, tmp_path, change, message):
    with pytest.raises(rs.RestitutionError, match=message):
        rs.run(case | change, out=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_results_are_not_overwritten(results, case):
    with pytest.raises(rs.RestitutionError, match="not empty"):
        rs.run(case, out=results.folder)


def test_stored_results_are_opened(results, tmp_path):
    found = rs.open_results(str(results.folder))
    assert found.curve.rows == results.curve.rows
    with pytest.raises(rs.RestitutionError, match="holds no results; give the folder"):
        rs.open_results(tmp_path)


def test_a_study_has_numeric_coordinates_with_units(cli, case_text, tmp_path):
    text = case_text.replace('rms = "0.05 um"\n', "").replace("steps = 4", "steps = 2")
    text = f'total_error = false\n{text}\n[sweep]\n"roughness.rms" = ["0.02 um", "50 nm"]\n'
    (tmp_path / "study.toml").write_text(text)
    assert cli("study", tmp_path / "study.toml", "-o", tmp_path / "out", "--workers", 1)[0] == 0
    study = rs.open_results(tmp_path / "out")
    assert repr(study).startswith("StudyResults: 2 cases, 2 complete; ")
    assert repr(study).endswith("swept: roughness.rms (2 values)")
    table = study.dataset
    assert table["roughness.rms"].values == approx([2e-8, 5e-8])
    assert table["roughness.rms"].attrs["units"] == "m"
    picked = table["restitution"].sel({"roughness.rms": 4.9e-8}, method="nearest")
    rows = study.cases[1].curve.rows
    assert np.array_equal(picked, [row["restitution"] for row in rows])


def test_a_law_is_made_and_exported(results, cli, tmp_path):
    law = rs.law_of(results)
    assert [point.restitution for point in law.points] == [
        row["restitution"] for row in results.curve.rows
    ]
    assert law.laws
    assert cli("fit-law", results.folder, "-o", tmp_path / "law")[0] == 0
    assert rs.law_of(tmp_path / "law") == law
    speed = 0.5 * (law.lowest + law.highest)
    for name, given in (("a", law), ("b", [tmp_path / "law"]), ("c", results.folder)):
        files = rs.export(given, to="lammps", velocity=f"{speed!r} m/s", out=tmp_path / name)
        assert [path.name for path in files] == [
            "restitution.lmp",
            "restitution_kokkos.lmp",
            "restitution_viscoelastic.lmp",
            "match_velocity.py",
            "collision.in",
            "restitution_lammps.txt",
        ]
        assert files[0].read_text() == (tmp_path / "a" / "restitution.lmp").read_text()
    rs.export(law, to="yade", velocity=speed, out=tmp_path / "d")
    assert rs.export(law, to="csv", out=tmp_path / "e") == [tmp_path / "e" / "restitution.csv"]
    with pytest.raises(rs.RestitutionError, match=r'to="lamps" .*; did you mean "lammps"\?'):
        rs.export(law, to="lamps", out=tmp_path / "f")


def test_the_library_of_materials():
    assert rs.material("52100") is rs.materials()["steel"]
    assert rs.materials()["glass"].youngs_modulus.value == 70e9


def test_the_package_offers_its_version_and_theory():
    assert rs.__version__ == metadata.version("restitution")
    assert rs.theory.Hertz(250e-6, 112e9).force(1e-7) > 0
    assert set(rs.__all__) | {"__version__"} <= set(dir(rs))
    for name in rs.__all__:
        assert getattr(rs, name) is not None


def test_results_in_memory_are_those_of_a_folder(case, tmp_path):
    stored, kept = rs.run(case, out=tmp_path / "out"), rs.run(case)
    opened = rs.open_results(tmp_path / "out")
    assert str(kept.curve.rows) == str(stored.curve.rows) == str(opened.curve.rows)
    assert kept.folder is None
    assert kept.curve.restitution.tolist() == stored.dataset["restitution"].values.tolist()
    same = [name for name in kept.summary if "seconds" not in name]
    assert {name: kept.summary[name] for name in same} == {
        name: stored.summary[name] for name in same
    }
    assert kept.dataset.drop_attrs().equals(stored.dataset.drop_attrs())
    assert rs.law_of(kept).points == rs.law_of(stored).points
    with pytest.raises(OutputError, match=r"maps.nc: is not stored; give `run` a folder"):
        _ = kept.maps


def test_an_ensemble_in_memory_has_its_means(case, tmp_path):
    case = case | {"roughness": case["roughness"] | {"realisations": 2}}
    stored, kept = rs.run(case, out=tmp_path / "out"), rs.run(case)
    assert str(kept.curve.rows) == str(stored.curve.rows)
    assert kept.curve.realisations.tolist() == [2] * 4
    assert kept.surfaces == 2


def test_a_curve_is_interpolated_and_not_extrapolated(results):
    curve, velocities = results.curve, results.curve.impact_velocity
    assert curve.at(velocities).tolist() == approx(curve.restitution.tolist())
    between = curve.at(np.sqrt(velocities[0] * velocities[1]))
    assert min(curve.restitution[:2]) <= between <= max(curve.restitution[:2])
    assert curve.errors["model_error"].tolist() == curve.model_error.tolist()
    with pytest.raises(DomainError, match="nothing is extrapolated"):
        curve.at(2 * velocities[-1])
    with pytest.raises(AttributeError):
        _ = curve.restitutions
    with pytest.raises(AttributeError):
        _ = curve.cells
    assert Curve().force.size == 0
    for same in (pickle.loads(pickle.dumps(curve)), copy.deepcopy(curve)):
        assert str(same.rows) == str(curve.rows)  # NaN differs from itself
    with pytest.raises(DomainError, match="no impact velocities"):
        Curve().at(0.1)
