"""The discretisation error of a curve, found on successive grids."""

import csv
import json
import math

import numpy as np
import pytest
import xarray as xr

from points import point
from restitution.case.case_file import parse_case
from restitution.errors import CaseError
from restitution.results.writer import ResultsFolder
from restitution.runs import convergence
from restitution.runs.convergence import _OnGrid, discretisation, observed_order, run_convergence
from tolerance import approx


@pytest.fixture(scope="module")
def converged(case_text, tmp_path_factory):
    return converge(case_text, tmp_path_factory.mktemp("converge"))


def converge(text, folder, grids=3, **more):
    out = ResultsFolder(folder / "out")
    return out, run_convergence(parse_case(text), text, folder, out, grids, **more)


def table_of(out, *names):
    with open(out.path.joinpath(*names), newline="") as file:
        return list(csv.DictReader(file))


@pytest.mark.parametrize("order", [0.7, 1.0, 2.0, 4.0])
def test_the_error_covers_what_is_left_of_a_power(order):
    values = [0.5 + 0.1 * 2 ** (-order * k) for k in range(3)]
    error, found = discretisation(values)
    assert found == approx(order)
    assert abs(values[-1] - 0.5) <= error * (1 + 1e-12) if order >= 1 else error > 0
    assert error < 0.1


def test_values_that_go_up_and_down_have_an_error_but_no_order():
    error, order = discretisation([0.50, 0.54, 0.53])
    assert error == approx(0.02)
    assert math.isnan(order)
    assert discretisation([0.5, 0.53])[0] == approx(0.09)
    assert discretisation([0.5, 0.55, 0.6])[0] == approx(1.5 * 0.05)
    assert discretisation([0.5, 0.7, 0.71])[0] == approx(0.5 * 0.2)
    assert np.isnan(discretisation([0.5])).all()


def test_the_order_over_depths_is_that_of_the_root_mean_square():
    def depth(*values):
        on = [_OnGrid(point(restitution=v), 0, math.nan, math.nan) for v in values]
        return {2**k: one for k, one in enumerate(on)}

    depths = [depth(0.5, 0.54, 0.53), depth(0.7, 0.66, 0.67)]
    assert observed_order(depths) == approx(2)
    assert math.isnan(observed_order([depth(0.5, 0.54)]))
    assert math.isnan(observed_order([]))


def test_the_curve_is_that_of_the_finest_grid_with_errors(converged):
    out, summary = converged
    curve, finest = table_of(out, "curve.csv"), table_of(out, "refine-4", "curve.csv")
    for row, same in zip(curve, finest, strict=True):
        assert row["restitution"] == same["restitution"]
        assert same["discretisation_error"] == ""
        assert 0 < float(row["discretisation_error"]) < 0.2
    assert summary["grids"] == [1, 2, 4]
    assert summary["status"] == "complete"
    assert json.loads((out.path / "summary.json").read_text()) == summary


def test_depths_count_from_one_first_touch(converged):
    out, _ = converged
    by_depth = {}
    for row in table_of(out, "convergence.csv"):
        by_depth.setdefault(row["max_indentation_m"], set()).add(row["refine"])
    assert [float(depth) for depth in by_depth] == approx(np.geomspace(20e-9, 300e-9, 4))
    assert all(grids == {"1", "2", "4"} for grids in list(by_depth.values())[1:])
    pressed = [
        float(table_of(out, f"refine-{k}", "curve.csv")[-1]["max_indentation_m"]) for k in (1, 2, 4)
    ]
    assert pressed[0] < pressed[1] < pressed[2] == approx(300e-9)


def test_errors_and_coarser_grids_are_in_the_results_file(converged):
    with xr.open_dataset(converged[0].path / "results.nc") as results:
        assert np.isfinite(results["discretisation_error"]).all()
        assert results["coarser_restitution"].dims == ("refine", "indentation_max")
        assert results["refine"].values.tolist() == [1, 2]
        assert results["pressure"].shape == (288, 256)


def test_the_error_covers_a_finer_grid(converged, case_text, tmp_path):
    finer = case_text.replace("[indentation]", "refine = 8\n[indentation]")
    out = ResultsFolder(tmp_path / "out")
    from restitution.runs.run import run_case

    run_case(parse_case(finer), finer, tmp_path, out)
    found = [float(row["restitution"]) for row in table_of(converged[0], "curve.csv")]
    error = [float(row["discretisation_error"]) for row in table_of(converged[0], "curve.csv")]
    off = [abs(f - row["restitution"]) for f, row in zip(found, out.rows, strict=True)]
    assert all(o <= 2 * e for o, e in zip(off, error, strict=True))
    assert sum(o <= e for o, e in zip(off, error, strict=True)) >= 3


def test_loads_are_compared_as_they_are(case_text, tmp_path):
    a, b = case_text.index("[indentation]"), case_text.index("[unloading]")
    text = case_text[:a] + '[load]\nvalues = ["5 mN", "20 mN"]\n' + case_text[b:]
    out, _ = converge(text, tmp_path, 2)
    forces = [float(row["force_N"]) for row in table_of(out, "convergence.csv")]
    assert forces == approx([5e-3, 5e-3, 20e-3, 20e-3])
    rows = table_of(out, "curve.csv")
    assert all(float(row["discretisation_error"]) > 0 for row in rows)


def test_depths_that_a_coarse_grid_misses_have_no_error_and_it_is_said(case_text, tmp_path):
    rough = case_text.replace('"gaussian"', '"exponential"').replace('"0.05 um"', '"0.2 um"')
    said = []
    out, summary = converge(rough, tmp_path, 2, warn=said.append)
    few = [row for row in table_of(out, "curve.csv") if row["discretisation_error"] == ""]
    assert 0 < len(few) < 4
    assert any("have no discretisation_error" in line for line in said)
    assert any("have no discretisation_error" in line for line in summary["warnings"])


def test_a_scan_is_refined_on_its_own_pixels(case_text, tmp_path):
    grid = np.arange(64) - 32
    height = 2e-8 * np.cos(grid / 3)[:, None] * np.cos(grid / 4)[None, :]
    np.save(tmp_path / "scan.npy", height)
    a, b = case_text.index("[roughness]"), case_text.index("[indentation]")
    measured = '[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "32 um"\n'
    out, _ = converge(case_text[:a] + measured + case_text[b:], tmp_path, 2)
    spacings = [
        json.loads((out.path / f"refine-{k}" / "summary.json").read_text())["model"]["spacing"][0]
        for k in (1, 2)
    ]
    assert spacings == approx([0.5e-6, 0.25e-6])


def test_what_cannot_converge_is_refused(case_text, tmp_path):
    for text, grids, words in (
        (case_text, 1, "grids: a study on 1 grid cannot"),
        (case_text.replace("seed = 1", "seed = 1\nrealisations = 2"), 2, "study uses one surface"),
        (case_text.replace("[72, 64]", "[8000, 8000]"), 3, "at most 134217728 are allowed"),
    ):
        with pytest.raises(CaseError, match=words):
            converge(text, tmp_path, grids)
        assert not (tmp_path / "out").exists()


def test_interruption_keeps_the_grids_that_are_done(case_text, tmp_path):
    def stop(words):
        if words.startswith("refine = 2, 3 of 4"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        converge(case_text, tmp_path, progress=stop)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert (summary["status"], summary["grids"]) == ("interrupted", [1, 2])
    out = ResultsFolder.__new__(ResultsFolder)
    out.path = tmp_path / "out"
    assert len(table_of(out, "curve.csv")) == 3


def test_converge_adds_the_yielding_that_no_grid_shows(case_text, tmp_path, monkeypatch):
    def study(name, unseen):
        (tmp_path / name).mkdir()
        monkeypatch.setattr(
            convergence, "unseen_yield", lambda _, __, rows: np.full(len(rows), unseen)
        )
        out, _ = converge(case_text, tmp_path / name, 2)
        return np.array([each["discretisation_error"] for each in out.rows])

    without = study("without", 0.0)
    known = np.isfinite(without)
    assert known.any()
    assert study("with", 0.05)[known] == approx(np.hypot(without[known], 0.05), rel=1e-9)


def test_a_row_with_an_unknown_scatter_has_no_total(case_text, tmp_path, monkeypatch):
    real = convergence.spread_errors

    def unknown(companions, work, *more, **options):
        found = real(companions, work, *more, **options)
        found["surface_scatter"][0] = math.nan
        return found

    monkeypatch.setattr(convergence, "spread_errors", unknown)
    out, _ = converge(case_text, tmp_path, 2)
    known = [math.isfinite(row["total_error"]) for row in out.rows]
    assert known == [False, *[True] * (len(known) - 1)]
