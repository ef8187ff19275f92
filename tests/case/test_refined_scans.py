"""`refine` of a measured surface adds the scan's shorter waves, down to its pixel."""

import numpy as np
import pytest

from restitution import Grid, Surface, extend, place_on_grid, refine
from restitution.case.case_file import parse_case
from tolerance import approx

PIXELS = Grid((120, 120), (0.1e-6, 0.1e-6))


@pytest.fixture
def surface_of(case_text, tmp_path):
    """The surface of a scan of white noise on 24 cells of 0.4 um, refined."""
    height = 1e-8 * np.random.default_rng(1).standard_normal(PIXELS.nodes)
    np.save(tmp_path / "scan.npy", height)
    table = '[[roughness]]\nkind = "measured"\nfile = "scan.npy"\nsize = "12 um"\n'
    table += 'below_grid = "omit"\n'

    def call(more="", refined=1, nodes=24, also=""):
        grid = f'[grid]\nnodes = {nodes}\nspacing = "0.4 um"\nrefine = {refined}\n'
        begin, end = case_text.index("[roughness]"), case_text.index("[indentation]")
        text = case_text[:begin] + table + more + "\n" + also + grid + case_text[end:]
        return parse_case(text).surface(tmp_path)

    call.scan = Surface(height, PIXELS)
    return call


def finer(factor, nodes=24):
    return Grid((nodes * factor,) * 2, (0.4e-6 / factor,) * 2)


@pytest.mark.parametrize("factor", [1, 2, 4])
def test_a_finer_grid_gets_the_shorter_waves_of_a_scan(surface_of, factor):
    made = surface_of(refined=factor)
    placed = place_on_grid(surface_of.scan, finer(factor))
    assert made.grid == placed.grid
    np.testing.assert_allclose(made.height, placed.height, rtol=0, atol=1e-17)
    assert made.provenance["removed_slope"] == approx({1: 0.99, 2: 0.95, 4: 0.0}[factor], abs=0.04)


def test_below_the_pixel_no_wave_is_added(surface_of):
    made = surface_of(refined=16)
    expected = refine(place_on_grid(surface_of.scan, finer(4)), 4)
    np.testing.assert_allclose(made.height, expected.height, rtol=0, atol=1e-17)
    assert made.provenance["refined"] == 16
    assert made.provenance["refinement"].startswith("placed on cells 4 times as small, then zero")


@pytest.mark.parametrize("how", ["twin", "mirror"])
def test_extended_scans_gain_them_too(surface_of, how):
    seed = 3 if how == "twin" else None
    more = f'extend = "{how}"' + (f"\nseed = {seed}" if seed else "")
    made = surface_of(more, refined=4, nodes=48)
    expected = extend(surface_of.scan, finer(4, 48), how, seed=seed)
    np.testing.assert_allclose(made.height, expected.height, rtol=0, atol=1e-17)
    assert made.height.std() > 2 * surface_of(more, nodes=48).height.std()


def test_a_generated_surface_stays_as_it_is(surface_of):
    also = '[[roughness]]\nkind = "gaussian"\nrms = "30 nm"\nseed = 1\n'
    also += 'correlation_length = "2 um"\n'
    both, scan = (surface_of(refined=2, also=text) for text in (also, ""))
    coarse = surface_of(also=also).height - surface_of().height
    generated = refine(Surface(coarse, finer(1), {"periodicity": "periodic"}), 2)
    np.testing.assert_allclose(both.height - scan.height, generated.height, rtol=0, atol=1e-18)
    assert both.provenance["refined"] == 2
    assert both.provenance["removed_slope"] == scan.provenance["removed_slope"]
