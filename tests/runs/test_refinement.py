"""`grid.refine = "auto"`: the first grid that resolves the shallowest contact."""

import json

import pytest

from restitution import solve
from restitution.case.case_file import parse_case
from restitution.contact.checks.resolution import median_patch, resolves
from restitution.results.writer import ResultsFolder
from restitution.runs import refinement
from restitution.runs.ensemble import run_realisations
from restitution.runs.refinement import settled


@pytest.fixture
def auto(case_text):
    return case_text.replace("[indentation]", 'refine = "auto"\n[indentation]')


def patch(case, factor, tmp_path):
    contact = case.refined(factor).contact(tmp_path)
    return median_patch(solve(contact, case.depths()[0]).patch_sizes())


def test_the_first_grid_that_resolves_is_taken(auto, tmp_path):
    case = parse_case(auto)
    said = []
    found = settled(case, tmp_path, said.append)
    assert said == []
    assert found.grid.refine > 1
    assert resolves(patch(case, found.grid.refine, tmp_path))
    assert not resolves(patch(case, found.grid.refine // 2, tmp_path))


def test_a_number_is_left_as_it_is(case_text, tmp_path):
    case = parse_case(case_text)
    assert settled(case, tmp_path, pytest.fail) == case


def test_it_says_why_it_cannot(auto, tmp_path, monkeypatch):
    monkeypatch.setattr(refinement, "MOST_NODES", 2 * 72 * 64)
    said = []
    found = settled(parse_case(auto), tmp_path, said.append)
    assert found.grid.refine == 1
    assert "the next grid would have 144 x 128 nodes" in said[0]
    assert "not resolved" in said[0]
    monkeypatch.setattr(refinement, "MOST_NODES", 2**24)
    monkeypatch.setattr(refinement, "FACTORS", (1, 2))
    found = settled(parse_case(auto.replace("0.05 um", "0.5 um")), tmp_path, said.append)
    assert found.grid.refine == 2
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
    assert said[0].startswith('grid.refine = "auto" ends at 1')
    assert summary["warnings"][0] == said[0]
    stored = json.loads((out.path / "summary.json").read_text())
    assert stored["warnings"] == summary["warnings"]


def test_a_load_is_probed_as_a_load(auto, tmp_path):
    a, b = auto.index("[indentation]"), auto.index("[unloading]")
    loaded = auto[:a] + '[load]\nvalues = ["1 mN"]\n' + auto[b:]
    found = settled(parse_case(loaded), tmp_path, pytest.fail)
    assert found.grid.refine >= 1
