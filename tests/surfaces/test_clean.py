import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, crop, generate_surface, remove_outliers
from tolerance import approx

GRID = Grid((96, 80), (0.1e-6, 0.2e-6))
ROUGH = generate_surface(GRID, kind="gaussian", rms=50e-9, correlation_length=1.2e-6, seed=1)


def test_a_part_is_cut_out_by_the_coordinates_of_the_map():
    x, y = np.meshgrid(GRID.x, GRID.y, indexing="ij")
    part = crop(Surface(1e3 * x + y, GRID), x=(-2e-6, 3e-6), y=(0.0, 4.05e-6))
    assert part.grid.nodes == (51, 21)
    assert part.height[0, 0] == approx(1e3 * -2e-6)
    assert part.height[-1, -1] == approx(1e3 * 3e-6 + 4e-6)
    assert part.provenance["cropped"] == "51 x 21 of 96 x 80 pixels"
    assert part.provenance["size_x_m"] == approx(5.1e-6)


def test_without_ranges_everything_stays():
    assert np.array_equal(crop(ROUGH).height, ROUGH.height)


@pytest.mark.parametrize("y", [(20e-6, 30e-6), (0.0, 8.5e-6), (-8.5e-6, 0.0)])
def test_a_range_beyond_the_scan_is_refused(y):
    with pytest.raises(SurfaceError, match=r"^y: .* beyond the scan, .* from -8 to 7.8 um \("):
        crop(ROUGH, y=y)


def test_a_range_to_the_edges_keeps_all_pixels():
    assert crop(ROUGH, x=(-4.8e-6, 4.8e-6), y=(-8e-6, 8e-6)).grid == GRID


def test_a_range_between_two_pixels_is_refused():
    with pytest.raises(SurfaceError, match=r"^x: no pixel lies from 0.01 to 0.02 um; .* 0.1 um"):
        crop(ROUGH, x=(0.01e-6, 0.02e-6))


def test_spikes_are_removed_and_nothing_else_changes():
    random = np.random.default_rng(0)
    spoiled, at = ROUGH.height.copy(), random.choice(ROUGH.height.size, 40, replace=False)
    spoiled.ravel()[at] += random.choice([-1, 1], 40) * 1e-6
    cleaned = remove_outliers(Surface(spoiled, GRID, {"source": "measured"}), 8)
    assert cleaned.provenance["outliers"] == 40
    assert cleaned.provenance["outlier_largest_step_m"] == approx(1e-6, rel=0.2)
    assert cleaned.provenance["source"] == "measured"
    others = np.ones(spoiled.size, bool)
    others[at] = False
    assert np.array_equal(cleaned.height.ravel()[others], ROUGH.height.ravel()[others])
    assert np.abs(cleaned.height - ROUGH.height).max() < 0.5 * 50e-9


@pytest.mark.parametrize("bend", [0.0, 1 / 25e-6, -1 / 60e-6])
def test_spikes_on_a_slope_are_removed(bend):
    """On a steep slope most pixels equal the median of their neighbours."""
    x, y = np.meshgrid(GRID.x, GRID.y, indexing="ij")
    form = 0.1 * x - 0.05 * y + 0.5 * bend * (x**2 + y**2)
    spoiled = ROUGH.height.copy()
    spoiled[[10, 40, 70], [20, 60, 30]] += 0.5e-6
    flat, sloped = (remove_outliers(Surface(spoiled + f, GRID), 8) for f in (0 * form, form))
    assert flat.provenance["outliers"] == sloped.provenance["outliers"] == 3
    assert sloped.height - form == approx(flat.height, abs=2e-8)


def test_a_slipped_scan_line_is_removed():
    spoiled = ROUGH.height.copy()
    spoiled[20:70, 33] += 3e-7
    cleaned = remove_outliers(Surface(spoiled, GRID), 6)
    # neighbours of the spike on a slope may be replaced, too
    assert 50 <= cleaned.provenance["outliers"] < 60
    assert np.all(cleaned.height[20:70, 33] != spoiled[20:70, 33])
    assert np.abs(cleaned.height - ROUGH.height).max() < 50e-9


def test_a_clean_surface_and_a_flat_one_stay():
    assert np.array_equal(remove_outliers(ROUGH, 8).height, ROUGH.height)
    flat = Surface(np.zeros(GRID.nodes), GRID)
    assert remove_outliers(flat, 6).provenance["outliers"] == 0


def test_a_threshold_that_takes_the_surface_is_refused():
    with pytest.raises(SurfaceError, match=r"^threshold: \d\d% of the pixels .* at most 10%"):
        remove_outliers(ROUGH, 0.5)
    for bad in (0.0, -1.0, float("nan")):
        with pytest.raises(SurfaceError, match=r"^threshold: .* is not a positive number"):
            remove_outliers(ROUGH, bad)
