"""A law from stored results: errors of its points, what is left out, and damaged folders."""

import csv
import json
import math
import shutil
from dataclasses import replace

import pytest

from points import mean_point, point
from restitution.case.case_file import parse_case
from restitution.dem.fits import NAMES, fit_law
from restitution.errors import CaseError, DomainError, OutputError
from restitution.laws import from_results
from restitution.laws.from_results import bare_law
from restitution.results.checksums import CHECKSUMS
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import run_realisations
from tolerance import approx

CASE = """
title = "Rough glass on steel"
total_error = false
[first]
radius = "500 um"
youngs_modulus = "70 GPa"
poissons_ratio = 0.25
density = "2500 kg/m^3"
[second]
material = "steel"
radius = "flat"
[interface]
yield_pressure = "750 MPa"
[roughness]
kind = "gaussian"
rms = "50 nm"
correlation_length = "6 um"
seed = 1
[grid]
nodes = 48
spacing = "0.8 um"
[indentation]
from = "20 nm"
to = "500 nm"
steps = 4
[unloading]
curves = 0
"""


def results_of(text, out):
    run_realisations(parse_case(text), text, out.parent, ResultsFolder(out))
    return out


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return results_of(CASE, tmp_path_factory.mktemp("run") / "out")


def rows_of(out):
    with open(out / "curve.csv", newline="") as file:
        return list(csv.DictReader(file))


def edited(run, folder, change, name="summary.json"):
    """The same folder with `change` made to its summary, whose checksum is gone."""
    shutil.copytree(run, folder)
    (folder / CHECKSUMS).unlink()
    content = json.loads((folder / name).read_text())
    change(content)
    (folder / name).write_text(json.dumps(content))
    return folder


def test_files_that_disagree_are_said_without_words_of_pydantic(run, tmp_path):
    folder = edited(run, tmp_path / "x", lambda read: read["derived"].update(yield_pressure_Pa=-1))
    with pytest.raises(OutputError, match=r"\(yield_pressure: Input should be [a-z ]* 0\); run"):
        bare_law(folder)


def test_the_bodies_are_those_of_the_case(run):
    law = bare_law(run)
    assert (law.first.name, law.second.name) == ("first", "steel")
    assert law.first.radius == approx(500e-6)
    assert law.first.density == approx(2500)
    assert law.second.wall
    assert law.radius == approx(500e-6)
    assert law.mass == approx(2500 * 4 / 3 * math.pi * 500e-6**3)
    assert law.yield_pressure == approx(750e6)
    assert (law.title, law.case) == ("Rough glass on steel", CASE)
    assert (law.fit, law.laws, law.sticks_below) == (None, (), None)


def test_without_a_total_error_the_known_parts_are_the_error(run):
    law, rows = bare_law(run), rows_of(run)
    assert len(law.points) == len(rows) == 4
    for stored, row in zip(law.points, rows, strict=True):
        assert row["total_error"] == ""
        assert stored.error == approx(float(row["restitution_error"]))
        assert stored.pull_off_force == float(row["pull_off_force_N"])
    assert law.conventions.restitution_error.startswith("solver; not: ")
    assert "; model_error is up to 0." in law.conventions.restitution_error


@pytest.mark.parametrize(("e", "largest"), [(0.8, 0.8), (0.3, 0.7)])
def test_an_error_of_which_a_part_is_not_known_may_be_anything(e, largest):
    one = point(restitution=e, restitution_error=0.03, discretisation_error=0.04, total_error=0.2)
    assert from_results._error(one, wanted=True) == 0.2
    unknown = replace(one, total_error=math.nan)
    assert from_results._error(unknown, wanted=True) == largest
    assert from_results._error(unknown, wanted=False) == approx(0.05)


def test_a_law_says_that_the_total_error_is_unknown_after_an_interruption(tmp_path):
    def stop(text):
        if len(found.rows) == 3:
            raise KeyboardInterrupt

    text = CASE.replace("total_error = false\n", "")
    found = ResultsFolder(tmp_path / "out")
    with pytest.raises(KeyboardInterrupt):
        run_realisations(parse_case(text), text, tmp_path, found, stop)
    law = bare_law(tmp_path / "out")
    assert [point.error for point in law.points] == [
        max(point.restitution, 1 - point.restitution) for point in law.points
    ]
    assert any("the total error is unknown at 3 of 3 depths" in text for text in law.warnings)
    assert "largest possible error" in law.conventions.restitution_error
    assert "solver" not in law.conventions.restitution_error


def test_the_ratio_of_a_mean_is_that_of_its_restitution_unless_it_sticks():
    works = {"loading_work": 1e-8, "unloading_work": 3e-9}
    assert point(restitution=0.5, **works).ratio == approx(0.3)
    assert mean_point(restitution=0.5, **works).ratio == 0.25
    works["unloading_work"] = -3e-9
    assert mean_point(restitution=0.0, **works).ratio == approx(-0.3)


def test_both_fits_are_made_only_where_they_are_asked_for(run):
    began = []
    law = fit_law(run, lambda *begun: began.append(begun))
    assert replace(law, fit=None, laws=()) == bare_law(run)
    assert [name for name, *_ in began] == list(NAMES)
    assert [each.name for each in law.laws] == list(NAMES)


def test_a_run_that_failed_has_a_law_of_what_it_reached_and_says_so(tmp_path):
    deep = CASE.replace('to = "500 nm"', 'to = "2 um"')
    with pytest.raises(DomainError):
        results_of(deep, tmp_path / "out")
    law = bare_law(tmp_path / "out")
    assert 0 < len(law.points) < 4
    assert law.warnings[0].startswith("the run is not complete (failed: the contact reaches the")


def test_a_depth_that_no_impact_reaches_is_left_out(tmp_path):
    """Adhesion does more work than the approach at the first of three depths."""
    text = (
        CASE.replace('"50 nm"', '"0.5 nm"')
        .replace('"0.8 um"', '"0.4 um"')
        .replace("[roughness]", 'work_of_adhesion = "0.5 J/m^2"\n[roughness]')
    )
    text = text.replace("curves = 0", 'curves = 0\nmethod = "energy-estimate"').replace(
        'from = "20 nm"\nto = "500 nm"\nsteps = 4', 'values = ["2 nm", "60 nm", "90 nm"]'
    )
    law = bare_law(results_of(text, tmp_path / "out"))
    assert len(law.points) == 2
    assert any(said.startswith("1 of 3 depths are left out") for said in law.warnings)
    assert any(said.startswith("COR is an estimate") for said in law.warnings)
    assert [point.pull_off_force for point in law.points] == [None, None]
    none = text.replace(', "60 nm", "90 nm"', "")
    with pytest.raises(CaseError, match="none of the stored depths is the maximum indentation"):
        bare_law(results_of(none, tmp_path / "none"))


@pytest.mark.parametrize("name", ["reduced_radius_m", "reduced_mass_kg", "contact_modulus_Pa"])
def test_a_summary_of_another_pair_is_refused(run, tmp_path, name):
    def change(content):
        content["derived"][name] *= factor

    factor = 1 + 1e-10
    assert bare_law(edited(run, tmp_path / "close", change)).points
    factor = 1 + 1e-8
    with pytest.raises(OutputError, match=f"{name} in summary.json differs from the case in"):
        bare_law(edited(run, tmp_path / "other", change))


def test_a_summary_without_its_entries_is_refused(run, tmp_path):
    lacking = edited(run, tmp_path / "lacking", lambda content: content["derived"].clear())
    with pytest.raises((OutputError, CaseError)):
        bare_law(lacking)


def test_a_folder_without_its_curve_or_its_end(run, tmp_path):
    (tmp_path / "empty").mkdir()
    with pytest.raises(OutputError, match="holds no results of a run; give the folder"):
        bare_law(tmp_path / "empty")
    shutil.copytree(run, tmp_path / "cut")
    (tmp_path / "cut" / "summary.json").unlink()
    with pytest.raises(OutputError, match="this run has not ended, or was killed"):
        bare_law(tmp_path / "cut")
