"""`grid.refine = "auto"`: the grid that each depth needs."""

import json

import pytest

from restitution import solve
from restitution.case.case_file import parse_case
from restitution.contact.checks.resolution import NODES_PER_PATCH, median_patch
from restitution.errors import CaseError
from restitution.results.reader import RunResults
from restitution.results.writer import ResultsFolder
from restitution.runs import refinement
from restitution.runs.depths import later_touches
from restitution.runs.ensemble import run_realisations
from restitution.runs.refinement import least_refined, with_chosen_grids
from restitution.runs.run import run_case
from tolerance import approx


@pytest.fixture
def auto(case_text):
    return case_text.replace("[indentation]", 'refine = "auto"\n[indentation]')


def patch(case, factor, tmp_path, depth):
    contact = case.refined(factor).contact(tmp_path)
    return median_patch(solve(contact, depth).patch_sizes())


def test_each_depth_gets_the_coarsest_grid_that_resolves_it(auto, tmp_path):
    case = parse_case(auto)
    said = []
    refined = with_chosen_grids(case, tmp_path, said.append)
    assert said == []
    factors = refined.factors()
    assert factors == sorted(factors, reverse=True)
    assert factors[0] > factors[-1]
    for depth, factor in zip(case.depths(), factors, strict=True):
        assert patch(case, factor, tmp_path, depth) >= 1.5 * NODES_PER_PATCH
        if factor > 1:
            assert patch(case, factor // 2, tmp_path, depth) < 1.5 * NODES_PER_PATCH


def test_the_rows_of_a_run_are_those_of_their_grids(auto, tmp_path):
    case = parse_case(auto)
    out = ResultsFolder(tmp_path / "out")
    summary = run_case(case, auto, tmp_path, out)
    factors = [row["refine"] for row in out.rows]
    assert list(summary["model"]["refine"]) == factors
    assert all(row["resolved"] for row in out.rows)
    assert all(row["total_error"] > 0 for row in out.rows)
    # Depths count from the first touch of the finest grid.
    depths = [row["max_indentation_m"] for row in out.rows]
    assert depths == approx(case.depths(), rel=1e-12)
    touch = later_touches(case, tmp_path, set(factors))
    assert touch[max(factors)] == 0
    assert touch[min(factors)] > 0
    for row in (out.rows[0], out.rows[-1]):
        contact = case.refined(int(row["refine"])).contact(tmp_path)
        state = solve(contact, row["max_indentation_m"] - touch[row["refine"]])
        assert row["force_N"] == approx(state.force, rel=1e-6)
        assert row["loading_work_J"] == approx(state.loading_work, rel=1e-3)
    results = RunResults(out.path)
    results.check()
    assert out.unloading[-1][0] == depths[-1]
    assert (results.dataset["refinement"].values == factors).all()


def test_an_ensemble_has_the_same_grids_on_every_surface(auto, tmp_path):
    text = auto.replace("seed = ", "realisations = 2\nseed = ")
    out = ResultsFolder(tmp_path / "out")
    run_realisations(parse_case(text), text, tmp_path, out)
    assert len({row["refine"] for row in out.rows}) > 1
    assert all(row["total_error"] > 0 for row in out.rows)


def test_a_list_has_a_factor_for_each_depth(auto, tmp_path):
    refined = parse_case(auto.replace('"auto"', "[4, 2, 1, 1]"))
    assert refined.factors() == [4, 2, 1, 1]
    assert with_chosen_grids(refined, tmp_path, pytest.fail) == refined
    with pytest.raises(CaseError, match=r"grid\.refine: 2 values for 4 depths"):
        parse_case(auto.replace('"auto"', "[4, 2]"))


def test_a_number_is_left_as_it_is(case_text, tmp_path):
    case = parse_case(case_text)
    assert with_chosen_grids(case, tmp_path, pytest.fail) == case


def test_it_says_why_it_cannot(auto, tmp_path, monkeypatch):
    monkeypatch.setattr(refinement, "MOST_NODES", 2 * 72 * 64)
    said = []
    refined = with_chosen_grids(parse_case(auto), tmp_path, said.append)
    assert refined.grid.refine == 1
    assert "the next grid would have 144 x 128 nodes" in said[0]
    assert "does not resolve" in said[0]
    monkeypatch.setattr(refinement, "MOST_NODES", 2**24)
    monkeypatch.setattr(refinement, "FACTORS", (1, 2))
    refined = with_chosen_grids(
        parse_case(auto.replace("0.05 um", "0.5 um")), tmp_path, said.append
    )
    assert refined.grid.refine == 2
    assert "2 is the largest refine" in said[1]


def test_a_run_has_it_in_its_results(auto, tmp_path, monkeypatch):
    auto = auto.replace('from = "20 nm"\nto = "300 nm"\nsteps = 4', 'values = ["100 nm"]')
    out = ResultsFolder(tmp_path / "out")
    summary = run_realisations(parse_case(auto), auto, tmp_path, out)
    assert summary["model"]["refine"] in (1, 2, 4)
    assert out.rows[0]["resolved"]
    monkeypatch.setattr(refinement, "FACTORS", (1,))
    shallow = auto.replace("100 nm", "10 nm")
    said = []
    out = ResultsFolder(tmp_path / "unresolved")
    summary = run_realisations(parse_case(shallow), shallow, tmp_path, out, warn=said.append)
    assert said[0].startswith('grid.refine = "auto" stopped at 1')
    assert summary["warnings"][0] == said[0]
    stored = json.loads((out.path / "summary.json").read_text())
    assert stored["warnings"] == summary["warnings"]


def test_a_load_is_probed_as_a_load(auto, tmp_path):
    a, b = auto.index("[indentation]"), auto.index("[unloading]")
    loaded = auto[:a] + '[load]\nvalues = ["1 mN"]\n' + auto[b:]
    refined = with_chosen_grids(parse_case(loaded), tmp_path, pytest.fail)
    assert refined.grid.refine >= 1


SMOOTH = """
total_error = false
[first]
radius = "5 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.33
density = "1050 kg/m^3"
[interface]
work_of_adhesion = "0.05 J/m^2"
{adhesion}yield_pressure = "elastic"
[grid]
nodes = 48
spacing = "60 nm"
refine = "auto"
[indentation]
values = ["8 nm", "15 nm"]
"""


def test_the_pull_off_radius_is_resolved(tmp_path):
    """a_c = 84 nm needs cells of 21 nm, a quarter of 60 nm; patches alone would take 60 nm."""
    text = SMOOTH.format(adhesion='adhesion = "jkr"\n')
    assert with_chosen_grids(parse_case(text), tmp_path, pytest.fail).grid.refine == 4


def test_an_affordable_range_of_the_attraction_is_resolved(tmp_path, monkeypatch):
    """E* z0^2/w and sqrt(R* z0) of these hard spheres need 8.2 nm."""
    hard = (
        SMOOTH.format(adhesion="").replace("3 GPa", "80 GPa").replace('"8 nm", "15 nm"', '"1 nm"')
    )
    hard = hard.replace("60 nm", "20 nm")
    refined = with_chosen_grids(parse_case(hard), tmp_path, pytest.fail)
    assert (refined.interface.adhesion, refined.grid.refine) == ("cohesive", 4)
    assert least_refined(parse_case(hard), tmp_path).grid.refine == 4
    monkeypatch.setattr(refinement, "MOST_COHESIVE_NODES", 96**2)
    said = []
    refined = with_chosen_grids(parse_case(hard), tmp_path, said.append)
    assert refined.interface.adhesion == "jkr"
    assert 'too coarse for "cohesive"' in said[0]


def test_what_adhesion_would_need_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(refinement, "MOST_NODES", 96**2)
    said = []
    text = SMOOTH.format(adhesion='adhesion = "jkr"\n')
    assert with_chosen_grids(parse_case(text), tmp_path, said.append).grid.refine == 2
    assert "the next grid would have 192 x 192 nodes" in said[0]
    assert "adhesion needs cells of 2" in said[0]
    assert "(grid.refine = 4, 192 x 192 nodes, about " in said[0]
    cohesive = SMOOTH.format(adhesion='adhesion = "cohesive"\n')
    monkeypatch.setattr(refinement, "MOST_COHESIVE_NODES", 96**2)
    with_chosen_grids(parse_case(cohesive), tmp_path, said.append)
    assert "or less (6144 x 6144 nodes)" in said[1]
