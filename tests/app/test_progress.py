"""How much of a run of the page is done, and the grid of a large scan."""

from pathlib import Path

import numpy as np

from restitution.app.content import text_of
from restitution.app.grid import with_grid
from restitution.app.presets import presets
from restitution.app.runs import Progress, Runs
from restitution.case.case_file import parse_case
from tolerance import approx

ROUGH = """
[first]
material = "polystyrene"
radius = "500 um"
[roughness]
kind = "gaussian"
rms = "0.1 um"
correlation_length = "6 um"
seed = 1
[grid]
nodes = 32
spacing = "3 um"
[indentation]
values = ["100 nm", "200 nm"]
"""
SCAN = """
[first]
material = "polystyrene"
radius = "500 um"
[roughness]
kind = "measured"
file = "large.npy"
size = "60 um"
[indentation]
values = ["100 nm", "200 nm"]
"""


def test_the_share_of_a_run_grows_to_the_end(tmp_path):
    progress, shares = Progress(parse_case(ROUGH), 1), []
    Runs(tmp_path).folder(ROUGH, tmp_path, lambda words: shares.append(progress.after(words)))
    assert len(shares) > 4
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] < 1
    assert shares[-1] + 0.2 * 2 / (2 + 0.4 * 9) == approx(1, rel=1e-6)


def test_the_share_of_a_convergence_study_is_unknown():
    assert Progress(parse_case(ROUGH), 3).after("1 of 2 depths") is None


def test_a_scan_of_many_pixels_gets_a_grid_with_cells_of_its_pixels(tmp_path):
    heights = 1e-8 * np.random.default_rng(1).standard_normal((1200, 1200))
    np.save(tmp_path / "large.npy", heights)
    text, grid = with_grid(SCAN, tmp_path)
    assert grid == {"nodes": 512, "spacing": "50 nm"}
    assert parse_case(text).grid.nodes == (512, 512)
    np.save(tmp_path / "large.npy", heights[:100, :100])
    assert with_grid(SCAN, tmp_path)[1] == {}


def test_a_scan_that_is_not_there_gets_no_grid():
    assert with_grid(SCAN, Path("nowhere"))[1] == {}


def test_many_impacts_do_not_change_the_grid():
    """The grid that probes a case is smaller than what they need."""
    text = text_of(presets()[0]["content"])
    _, grid = with_grid(text, Path("nowhere"))
    text, same = with_grid(text + "\n[impacts]\ncoverage = 1\n", Path("nowhere"))
    assert same == grid
    assert parse_case(text).impacts is not None
