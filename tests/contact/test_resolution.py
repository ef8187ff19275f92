import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.contact.contact import Contact, smooth
from restitution.contact.resolution import (
    NODES_PER_PATCH,
    NODES_PER_RADIUS,
    median_patch,
    predicted_radius,
    predicted_warnings,
    require_fine_scan,
    resolves,
    unresolved_warning,
)
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from tolerance import approx

R = 250e-6
P_Y = 750e6
YIELD = (math.pi * P_Y / (2 * 112e9)) ** 2 * R  # 28 nm


def test_the_foreseen_radius_is_hertz_then_grows_to_the_overlap(pair):
    assert predicted_radius(pair, 1e-8) == approx(math.sqrt(R * 1e-8), rel=1e-14)
    assert predicted_radius(pair, 1e-2) == approx(math.sqrt(R * 1e-2), rel=1e-14)
    assert predicted_radius(pair, YIELD, P_Y) == approx(math.sqrt(R * YIELD), rel=1e-12)
    assert predicted_radius(pair, 1e-8, 1e-3) == approx(math.sqrt(2 * R * 1e-8), rel=1e-3)


@pytest.mark.parametrize(("x", "area"), [(1.5, 1.011), (2, 1.037), (6, 1.272), (16, 1.507)])
def test_the_foreseen_radius_is_close_to_the_solved_one(pair, x, area):
    """Contact area over πR*δ of smooth spheres at δ = x δ_y, REFERENCE section 3."""
    radius = predicted_radius(pair, x * YIELD, P_Y)
    assert radius == approx(math.sqrt(area * R * x * YIELD), rel=0.06)


@given(st.floats(1e-12, 1e-5), st.floats(1.0, 10), st.floats(1e6, 1e12))
def test_the_foreseen_radius_grows_with_depth_and_lies_between_its_limits(pair, d, factor, p_y):
    radius = predicted_radius(pair, d, p_y)
    assert math.sqrt(R * d) * (1 - 1e-12) <= radius <= math.sqrt(2 * R * d)
    assert predicted_radius(pair, factor * d, p_y) >= radius * (1 - 1e-12)


@pytest.fixture
def contact(pair):
    """64 x 100 nodes of 0.25 x 0.2 um: 16 um wide, 8 nodes on a radius of 2 um."""

    def make(pair=pair, yield_pressure=math.inf, **provenance):
        grid = Grid((64, 100), (0.25e-6, 0.2e-6))
        return Contact(pair, Surface(np.zeros(grid.nodes), grid, provenance), yield_pressure)

    return make


def test_a_contact_that_fits_and_is_resolved_needs_no_warning(contact):
    assert predicted_warnings(contact(), (5e-6) ** 2 / R) == []


def test_a_contact_larger_than_the_grid_is_foreseen(contact):
    just, beyond = (7.99e-6) ** 2 / R, (8.01e-6) ** 2 / R
    assert predicted_warnings(contact(), just) == []
    (line,) = predicted_warnings(contact(), beyond)
    assert "8.01 um from the centre" in line
    assert "ends at 8 um" in line
    assert f"{1e9 * beyond:.4g} nm" in line
    assert "use more nodes" in line
    # yielding widens the contact: elastic it would have fitted
    assert len(predicted_warnings(contact(yield_pressure=1e6), just)) == 1


def test_a_contact_on_few_nodes_is_foreseen(contact):
    assert predicted_warnings(contact(), (2.01e-6) ** 2 / R) == []
    (line,) = predicted_warnings(contact(), (1e-6) ** 2 / R)
    assert "spacing 0.25 um puts 4 nodes" in line
    assert f"({NODES_PER_RADIUS} are needed)" in line


def test_a_sphere_too_small_for_a_half_space_is_foreseen(contact, pair):
    from restitution.contact.bodies import Body, Pair

    tiny = Body(20e-6, 210e9, 0.25)
    lines = predicted_warnings(contact(Pair(tiny, tiny)), (3e-6) ** 2 / 10e-6)
    assert len(lines) == 1
    assert "0.3 of R*" in lines[0]


def test_a_grid_finer_than_the_scan_is_told(contact):
    deep = (5e-6) ** 2 / R
    assert predicted_warnings(contact(pixel_x_m=0.2e-6), deep) == []
    lines = predicted_warnings(contact(pixel_x_m=0.5e-6), deep)
    assert any("finer than the scan's pixel 0.5 um" in line for line in lines)


def test_a_scan_coarser_than_the_contact_is_refused(contact):
    shallow = (1e-6) ** 2 / R
    scan = contact(source="measured", file="scan.txt", pixel_x_m=1.5e-6)
    with pytest.raises(SurfaceError, match=r"scan\.txt: one pixel \(1\.5 um\).*\(1 um at 4 nm\)"):
        require_fine_scan(scan, shallow)
    require_fine_scan(scan, 9 * shallow)
    require_fine_scan(contact(source="generated", pixel_x_m=1.5e-6), shallow)
    require_fine_scan(contact(), shallow)


@pytest.mark.parametrize(
    ("patches", "median"),
    [([7], 7), ([5, 1, 1, 1], 5), ([3, 1, 1, 1], 3), ([3, 1, 1, 1, 1], 1), ([4, 3, 2], 3), ([], 0)],
)
def test_the_median_patch_holds_the_median_node(patches, median):
    assert median_patch(np.array(patches, dtype=int)) == median
    assert resolves(median) == (median >= NODES_PER_PATCH)


def test_what_is_resolved_is_not_mentioned():
    assert unresolved_warning([1e-9, 2e-9], [NODES_PER_PATCH, 500]) is None
    assert unresolved_warning([], []) is None


def test_unresolved_depths_are_counted_up_to_the_deepest():
    line = unresolved_warning([1e-9, 5e-9, 20e-9, 40e-9], [1, NODES_PER_PATCH - 1, 3, 90])
    assert line.startswith("3 of 4 depths (up to 20 nm)")
    assert f"fewer than {NODES_PER_PATCH} nodes" in line
    # rough contacts may lose resolution again: the deepest counts, not the last
    assert "up to 7 nm" in unresolved_warning([7e-9, 3e-9], [1, 1])


def test_depths_and_patches_come_in_pairs():
    with pytest.raises(ValueError, match="zip"):
        unresolved_warning([1e-9], [1, 2])


def test_a_smooth_surface_has_no_pixel(pair):
    grid = Grid((64, 64), (0.25e-6, 0.25e-6))
    assert predicted_warnings(Contact(pair, smooth(grid)), (5e-6) ** 2 / R) == []
