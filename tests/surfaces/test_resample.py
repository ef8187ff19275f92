import pickle

import numpy as np
import pytest

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, generate_surface, place_on_grid
from restitution.surfaces.refused import RefusedSurfaceError
from tolerance import approx

ROUGH = generate_surface(
    Grid((40, 31), (0.1e-6, 0.2e-6)),
    kind="exponential",
    rms=0.1e-6,
    correlation_length=1e-6,
    seed=1,
)


def wave(grid):
    """A sum of waves of at least 1.9 um, about 19 pixels of the scans below."""
    x, y = np.meshgrid(grid.x, grid.y, indexing="ij")
    return Surface(np.sin(3e6 * x + 1e6 * y + 0.4) + 0.5 * np.cos(1e6 * x - 2e6 * y), grid)


def test_identical_grid_leaves_the_heights():
    np.testing.assert_array_equal(place_on_grid(ROUGH, ROUGH.grid).height, ROUGH.height)


@pytest.mark.parametrize("scan", [(40, 31), (41, 30)])
@pytest.mark.parametrize("nodes", [(20, 11), (21, 12), (40, 1), (1, 30)])
def test_equal_spacing_crops_about_the_origin(scan, nodes):
    # Heights encode their coordinates in pixels, so that interpolation would show.
    spacing = (0.1e-6, 0.2e-6)
    i, j = np.indices(scan)
    surface = Surface(1000.0 * (i - scan[0] // 2) + (j - scan[1] // 2), Grid(scan, spacing))
    placed = place_on_grid(surface, Grid(nodes, spacing))
    i, j = np.indices(nodes)
    np.testing.assert_array_equal(placed.height, 1000.0 * (i - nodes[0] // 2) + (j - nodes[1] // 2))
    assert placed.grid == Grid(nodes, spacing)
    assert placed.provenance["placement"].startswith("cropped from ")


def test_spacing_that_differs_by_rounding_still_crops():
    third = Surface(ROUGH.height, Grid((40, 31), (0.1e-6 * (1 + 1e-13), 0.2e-6)))
    placed = place_on_grid(third, ROUGH.grid)
    np.testing.assert_array_equal(placed.height, ROUGH.height)


@pytest.mark.parametrize("spacing", [(0.05e-6, 0.03e-6), (0.13e-6, 0.17e-6)])
def test_smooth_surfaces_are_interpolated_accurately(spacing):
    scan = wave(Grid((101, 120), (0.1e-6, 0.1e-6)))
    grid = Grid((50, 50), spacing)
    placed = place_on_grid(scan, grid)
    np.testing.assert_allclose(placed.height, wave(grid).height, atol=2e-4)


def test_interpolation_converges_with_fourth_order():
    grid = Grid((20, 20), (0.07e-6, 0.07e-6))
    errors = []
    for n in (51, 71, 101, 141):
        scan = wave(Grid((n, n), (10e-6 / n, 10e-6 / n)))
        errors.append(abs(place_on_grid(scan, grid).height - wave(grid).height).max())
    orders = np.diff(-np.log(errors)) / np.diff(np.log([51, 71, 101, 141]))
    assert orders.min() > 3.5


def test_refining_keeps_the_coarse_nodes():
    fine = place_on_grid(ROUGH, Grid((80, 62), (0.05e-6, 0.1e-6)))
    np.testing.assert_allclose(fine.height[::2, 1::2], ROUGH.height, atol=1e-19)


def test_rim_is_held_not_extrapolated():
    grid = Grid((10, 10), (1e-6, 1e-6))
    x = np.broadcast_to(grid.x[:, None], grid.nodes)
    fine = Grid((80, 10), (0.125e-6, 1e-6))
    placed = place_on_grid(Surface(np.array(x), grid), fine)
    np.testing.assert_allclose(placed.height[:, 0], np.clip(fine.x, x.min(), x.max()), atol=1e-18)


def test_a_coarser_grid_gets_the_waves_it_can_carry_and_says_so():
    scan = Grid((120, 96), (0.1e-6, 0.1e-6))
    grid = Grid((40, 32), (0.3e-6, 0.3e-6))

    def sines(on, *numbers):
        # Waves with k half periods between the first and the last pixel.
        length = scan.x[-1] - scan.x[0]
        wave = sum(np.sin(np.pi * k * (on.x - scan.x[0]) / length) for k in numbers)
        return wave[:, None] + np.zeros((1, on.nodes[1]))

    placed = place_on_grid(Surface(sines(scan, 10, 61), scan), grid)
    np.testing.assert_allclose(placed.height, sines(grid, 10), atol=1e-3)
    long = place_on_grid(Surface(sines(scan, 10), scan), grid)
    np.testing.assert_allclose(placed.height, long.height, atol=1e-12)
    text = placed.provenance["placement"]
    assert text.startswith("sampled every 0.3 x 0.3 um from pixels of 0.1 x 0.1 um")
    assert "after removing waves shorter than 0.6 x 0.6 um" in text


def test_what_is_left_out_is_told():
    scan = Grid((120, 96), (0.1e-6, 0.1e-6))
    length = scan.x[-1] - scan.x[0]
    phase = np.pi * (scan.x - scan.x[0])[:, None] / length + np.zeros((1, 96))
    long, short = 3e-8 * np.sin(10 * phase), 1e-8 * np.sin(61 * phase)
    told = place_on_grid(Surface(long + short, scan), Grid((40, 32), (0.3e-6, 0.3e-6))).provenance
    assert told["removed_rms_m"] == approx(short.std(), rel=1e-6, abs=0)
    slopes = [np.sqrt(np.mean(np.diff(z, axis=0) ** 2)) for z in (short, long + short)]
    assert told["removed_slope"] == approx(slopes[0] / slopes[1], rel=1e-6, abs=0)
    assert told["shortest_carried_m"] == approx(0.6e-6, abs=0)
    finer = place_on_grid(Surface(long + short, scan), Grid((80, 64), (0.05e-6, 0.05e-6)))
    assert finer.provenance["removed_slope"] == finer.provenance["removed_rms_m"] == 0
    assert finer.provenance["shortest_carried_m"] == approx(0.2e-6, abs=0)


def test_only_the_axis_that_is_coarser_loses_waves():
    placed = place_on_grid(ROUGH, Grid((10, 31), (0.4e-6, 0.2e-6)))
    again = place_on_grid(
        Surface(ROUGH.height.T, Grid((31, 40), (0.2e-6, 0.1e-6))), Grid((31, 10), (0.2e-6, 0.4e-6))
    )
    np.testing.assert_allclose(placed.height, again.height.T, atol=1e-20)
    assert placed.height.std() < ROUGH.height.std()


def test_provenance_keeps_the_source_and_the_coarsest_pixel():
    fine = place_on_grid(ROUGH, Grid((30, 30), (0.05e-6, 0.05e-6)))
    assert fine.provenance["placement"] == (
        "interpolated from 0.1 x 0.2 um to 0.05 x 0.05 um by cubic spline"
    )
    assert fine.provenance["seed"] == 1
    again = place_on_grid(fine, Grid((10, 10), (0.05e-6, 0.05e-6)))
    assert again.provenance["pixel_x_m"] == 0.1e-6
    assert again.provenance["pixel_y_m"] == 0.2e-6


def test_grid_that_reaches_beyond_the_scan_is_refused():
    with pytest.raises(SurfaceError) as caught:
        place_on_grid(ROUGH, Grid((10, 64), (0.1e-6, 0.1e-6)))
    assert str(caught.value) == (
        "grid: its area of 1 x 6.4 um reaches beyond the surface of 4 x 6.2 um; use a smaller "
        "grid or a larger surface, or continue the surface with extend"
    )


def test_a_refused_surface_survives_pickling():
    error = RefusedSurfaceError("flat-scan", "x: is flat", "give another")
    copy = pickle.loads(pickle.dumps(error))
    assert (str(copy), copy.code) == ("x: is flat; give another", "flat-scan")


def test_grid_that_is_larger_by_rounding_is_accepted():
    place_on_grid(ROUGH, Grid((40, 62), (0.1e-6 * (1 + 1e-12), 0.1e-6 * (1 + 1e-12))))


@pytest.mark.parametrize("nodes", [(1, 1), (1, 3), (2, 2), (3, 4)])
def test_scans_too_small_for_a_cubic(nodes):
    scan = Surface(np.full(nodes, 0.7), Grid(nodes, (1.0, 1.0)))
    placed = place_on_grid(scan, Grid((2, 3), (0.25, 0.25)))
    np.testing.assert_allclose(placed.height, 0.7, rtol=1e-14)
