"""Several surfaces of one case: mean, spread, confidence interval and failures."""

import json
import math

import numpy as np
import pytest
from scipy.stats import ttest_1samp

from points import point
from restitution.case.case_file import parse_case
from restitution.errors import DomainError, SurfaceError
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import mean_points, run_realisations
from tolerance import approx


def ensemble(text, tmp_path, realisations=3, **more):
    text = text.replace("seed = 1", f"seed = 1\nrealisations = {realisations}")
    said = []
    out = ResultsFolder(tmp_path / "out")
    summary = run_realisations(parse_case(text), text, tmp_path, out, warn=said.append, **more)
    return out, summary, said


def test_every_surface_is_what_its_seed_alone_gives(case_text, tmp_path):
    out, summary, _ = ensemble(case_text, tmp_path)
    for number in (1, 2, 3):
        # The errors of an ensemble are those of its mean, not of single surfaces.
        alone = "total_error = false\n" + case_text.replace("seed = 1", f"seed = {number}")
        one = ResultsFolder(tmp_path / f"alone-{number}")
        run_realisations(parse_case(alone), alone, tmp_path, one)
        stored = (out.path / f"realisation-{number}" / "curve.csv").read_text()
        assert stored == (one.path / "curve.csv").read_text()
    assert [part["depths"] for part in summary["realisations"]] == [4, 4, 4]
    assert summary["status"] == "complete"
    assert json.loads((out.path / "summary.json").read_text()) == summary


def row(restitution, **more):
    return point(restitution=restitution, **more)


def test_statistics_are_those_of_student():
    values = [0.5, 0.55, 0.62, 0.48]
    (mean,) = mean_points([[row(value)] for value in values])
    interval = ttest_1samp(values, 0).confidence_interval(0.95)
    assert mean.restitution == approx(np.mean(values))
    assert mean.restitution_std == approx(np.std(values, ddof=1))
    assert mean.restitution_low == approx(interval.low)
    assert mean.restitution_high == approx(interval.high)
    assert mean.realisations == 4


def test_an_interval_stays_within_what_restitution_can_be():
    (mean,) = mean_points([[row(0.99)], [row(0.5)]])
    assert mean.restitution_high == 1
    assert mean.restitution_low == 0


def test_flags_are_those_of_all_and_trust_that_of_the_worst():
    good = row(0.5, resolved=True, residual=1e-9, median_patch_nodes=30, convolutions=7)
    bad = row(0.6, resolved=False, residual=3e-9, median_patch_nodes=12, convolutions=8)
    (mean,) = mean_points([[good], [bad]])
    assert mean.resolved is False
    assert mean.residual == 3e-9
    assert mean.median_patch_nodes == 12
    assert mean.convolutions == 15


def test_a_surface_that_ends_early_leaves_the_others_and_one_has_no_spread():
    short, long = mean_points([[row(0.5)], [row(0.7), row(0.6)]])
    assert short.realisations == 2
    assert long.realisations == 1
    assert long.restitution == 0.6
    assert np.isnan([long.restitution_std, long.restitution_low]).all()
    assert mean_points([]) == []


def test_a_mean_over_one_surface_has_no_total_error():
    a, b, c = (row(e, total_error=math.nan) for e in (0.5, 0.51, 0.6))
    several, alone = mean_points([[a, c], [b]], [row(0.5), row(0.6)])
    assert several.total_error >= several.surface_scatter > 0.05
    assert np.isnan(alone.total_error)


def test_more_surfaces_narrow_the_interval():
    random = np.random.default_rng(0)
    widths = []
    for n in (5, 80):
        (mean,) = mean_points([[row(value)] for value in random.normal(0.5, 0.05, n)])
        widths.append(mean.restitution_high - mean.restitution_low)
    assert widths[1] < 0.5 * widths[0]


def test_what_fails_is_recorded_and_said(case_text, tmp_path, monkeypatch):
    from restitution.runs import ensemble as module

    run = module.run_case
    monkeypatch.setattr(module, "run_case", lambda case, *a, **k: fail_or(run, case, *a, **k))
    out, summary, said = ensemble(case_text, tmp_path)
    assert [bool(part["reason"]) for part in summary["realisations"]] == [False, True, False]
    assert any("realisation 2 of 3: the contact" in line for line in said)
    assert any("means of only 2 of 3" in line for line in said)
    assert out.rows[0]["realisations"] == 2


def fail_or(run, case, text, folder, part, *arguments, **more):
    if case.roughness[0].seed == 2:
        part.discard()
        raise DomainError("the contact reaches the edge")
    return run(case, text, folder, part, *arguments, **more)


def test_when_all_fail_the_first_failure_is_raised_and_the_folder_taken_back(case_text, tmp_path):
    deep = case_text.replace('from = "20 nm"\nto = "300 nm"', 'from = "5 um"\nto = "9 um"')
    with pytest.raises(DomainError):
        ensemble(deep, tmp_path, 2)
    assert not (tmp_path / "out").exists()


def test_a_missing_scan_ends_the_run_with_one_error(case_text, tmp_path):
    before, after = case_text.split("[roughness]")[0], case_text.split("[grid]")[1]
    scan = '[roughness]\nkind = "measured"\nfile = "scan.npy"\nrealisations = 3\n[grid]'
    text = before + scan + after
    said = []
    with pytest.raises(SurfaceError, match="there is no such file"):
        run_realisations(
            parse_case(text), text, tmp_path, ResultsFolder(tmp_path / "out"), warn=said.append
        )
    assert said == []
    assert not (tmp_path / "out").exists()


def test_interruption_keeps_the_surfaces_that_are_done(case_text, tmp_path):
    def stop(words):
        if words.startswith("realisation 2 of 3, 2 of 4"):
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        ensemble(case_text, tmp_path, progress=stop)
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "interrupted"
    assert [part["depths"] for part in summary["realisations"]] == [4, 2]
    lines = (tmp_path / "out" / "realisations.csv").read_text().splitlines()
    assert len(lines) == 1 + 6
