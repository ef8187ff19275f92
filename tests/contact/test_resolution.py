import math
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.case.models import adhesion_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.checks.findings import (
    AdhesionUnresolved,
    FinerThanScan,
    PatchesUnresolved,
)
from restitution.contact.checks.resolution import (
    NODES_PER_PATCH,
    adhesive_spacing,
    coarse_scan,
    divisions,
    grid_of_a_scan,
    median_patch,
    predicted_radius,
    resolution_findings,
    resolves,
    resolves_adhesion,
    unresolved_adhesion,
    unresolved_patches,
)
from restitution.contact.cohesive import law
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact, smooth
from restitution.contact.jkr.limit import ADHESIVE_NODES, JKRLimit
from restitution.contact.loading import solve
from restitution.contact.plasticity.bound import ConstantBound
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from tolerance import approx

R = 250e-6
P_Y = 750e6
YIELD = (math.pi * P_Y / (2 * 112e9)) ** 2 * R  # 28 nm


def test_the_predicted_radius_is_hertz_then_grows_to_the_overlap(pair):
    assert predicted_radius(pair, 1e-8) == approx(math.sqrt(R * 1e-8), rel=1e-14)
    assert predicted_radius(pair, 1e-2) == approx(math.sqrt(R * 1e-2), rel=1e-14)
    assert predicted_radius(pair, YIELD, P_Y) == approx(math.sqrt(R * YIELD), rel=1e-12)
    assert predicted_radius(pair, 1e-8, 1e-3) == approx(math.sqrt(2 * R * 1e-8), rel=1e-3)


@pytest.mark.parametrize(("x", "area"), [(1.5, 1.011), (2, 1.037), (6, 1.272), (16, 1.507)])
def test_the_predicted_radius_is_close_to_the_solved_one(pair, x, area):
    """Contact areas of smooth spheres over πR*δ, at δ = x δ_y, are from REFERENCE, section 3."""
    radius = predicted_radius(pair, x * YIELD, P_Y)
    assert radius == approx(math.sqrt(area * R * x * YIELD), rel=0.06)


@given(st.floats(1e-12, 1e-5), st.floats(1.0, 10), st.floats(1e6, 1e12))
def test_the_predicted_radius_grows_with_depth_and_lies_between_its_limits(pair, d, factor, p_y):
    radius = predicted_radius(pair, d, p_y)
    assert math.sqrt(R * d) * (1 - 1e-12) <= radius <= math.sqrt(2 * R * d)
    assert predicted_radius(pair, factor * d, p_y) >= radius * (1 - 1e-12)


@pytest.fixture
def contact(pair):
    """64 x 100 nodes of 0.25 x 0.2 um: 16 um wide, 8 nodes on a radius of 2 um."""

    def make(pair=pair, yield_pressure=math.inf, **provenance):
        grid = Grid((64, 100), (0.25e-6, 0.2e-6))
        return Contact(
            pair,
            Surface(np.zeros(grid.nodes), grid, provenance),
            plasticity=ConstantBound(yield_pressure),
        )

    return make


def test_a_contact_that_fits_and_is_resolved_has_no_finding(contact):
    assert resolution_findings(contact(), (5e-6) ** 2 / R) == []


def test_a_contact_larger_than_the_grid_is_predicted(contact):
    just, beyond = (7.99e-6) ** 2 / R, (8.01e-6) ** 2 / R
    assert resolution_findings(contact(), just) == []
    (found,) = resolution_findings(contact(), beyond)
    assert found.code == "contact-beyond-grid"
    assert found.radius == approx(8.01e-6, rel=1e-12)
    assert (found.half_width, found.indentation) == (approx(8e-6, rel=1e-12), beyond)
    assert not found.whole_scan
    (found,) = resolution_findings(
        contact(source="measured", size_x_m=16e-6, size_y_m=20e-6), beyond
    )
    assert found.whole_scan
    # yielding widens the contact; an elastic contact would fit
    assert len(resolution_findings(contact(yield_pressure=1e6), just)) == 1


def test_a_contact_on_few_nodes_is_found(contact):
    assert resolution_findings(contact(), (2.01e-6) ** 2 / R) == []
    (found,) = resolution_findings(contact(), (1e-6) ** 2 / R)
    assert found.code == "few-nodes"
    assert found.radius / found.spacing == approx(4, rel=1e-12)


def test_a_sphere_too_small_for_a_half_space_is_found(contact):
    tiny = Body(20e-6, 210e9, 0.25)
    (found,) = resolution_findings(contact(Pair(tiny, tiny)), (3e-6) ** 2 / 10e-6)
    assert found.code == "no-half-space"
    assert found.radius / found.reduced_radius == approx(0.3, rel=1e-12)


def test_a_grid_finer_than_the_scan_is_found(contact):
    deep = (5e-6) ** 2 / R
    assert resolution_findings(contact(pixel_x_m=0.2e-6), deep) == []
    assert resolution_findings(contact(pixel_x_m=0.2015e-6), deep) == []  # rounded by the user
    found = resolution_findings(contact(pixel_x_m=0.5e-6), deep)
    assert found == [FinerThanScan(spacing=0.2e-6, pixel=0.5e-6)]
    # cells that are finer only because refinement was chosen
    assert resolution_findings(contact(pixel_x_m=0.4e-6, refined=2), deep) == []
    found = resolution_findings(contact(pixel_x_m=0.5e-6, refined=2), deep)
    assert found == [FinerThanScan(spacing=0.4e-6, pixel=0.5e-6)]


def test_a_scan_coarser_than_the_contact_is_found(contact):
    shallow = (1e-6) ** 2 / R
    scan = contact(source="measured", file="scan.txt", pixel_x_m=1.5e-6)
    found = coarse_scan(scan, shallow)
    assert (found.code, found.file, found.pixel) == (
        "pixel-above-contact",
        "scan.txt",
        1.5e-6,
    )
    assert found.radius == approx(1e-6, rel=1e-12)
    assert coarse_scan(scan, 9 * shallow) is None
    assert coarse_scan(contact(source="generated", pixel_x_m=1.5e-6), shallow) is None
    assert coarse_scan(contact(), shallow) is None


@pytest.mark.parametrize(
    ("patches", "median"),
    [([7], 7), ([5, 1, 1, 1], 5), ([3, 1, 1, 1], 3), ([3, 1, 1, 1, 1], 1), ([4, 3, 2], 3), ([], 0)],
)
def test_the_median_patch_holds_the_median_node(patches, median):
    assert median_patch(np.array(patches, dtype=int)) == median
    assert resolves(median) == (median >= NODES_PER_PATCH)


def test_what_is_resolved_is_not_found():
    assert unresolved_patches([1e-9, 2e-9], [NODES_PER_PATCH, 500]) == []
    assert unresolved_patches([], []) == []
    assert unresolved_adhesion([1e-9, 2e-9], [2e-9, 1e-9], [2e-9, math.inf], 2e-9) == []


def test_unresolved_depths_are_counted_up_to_the_deepest():
    (found,) = unresolved_patches([1e-9, 5e-9, 20e-9, 40e-9], [1, NODES_PER_PATCH - 1, 3, 90])
    assert found == PatchesUnresolved(few=3, depths=4, deepest=20e-9, needed=NODES_PER_PATCH)
    # rough contacts can lose resolution with depth: the deepest unresolved depth is reported
    (found,) = unresolved_patches([7e-9, 3e-9], [1, 1])
    assert found.deepest == 7e-9
    (found,) = unresolved_adhesion([1e-9, 2e-9, 3e-9], [4e-9, 4e-9, 8e-9], [5e-9, 3e-9, 7e-9], 8e-9)
    assert found == AdhesionUnresolved(
        few=2,
        depths=3,
        first=2e-9,
        last=3e-9,
        spacing=4e-9,
        needed=3e-9,
        refine=4,
    )


@pytest.mark.parametrize(
    ("spacing", "needed", "times"),
    [(8e-9, 8e-9, 1), (8e-9, 9e-9, 1), (8e-9, 7.9e-9, 2), (8e-9, 4e-9, 2), (8e-9, 1.9e-9, 8)],
)
def test_cells_are_divided_by_a_power_of_two(spacing, needed, times):
    assert divisions(spacing, needed) == times


def test_depths_and_nodes_come_in_pairs():
    with pytest.raises(ValueError, match="zip"):
        unresolved_patches([1e-9], [1, 2])
    with pytest.raises(ValueError, match="zip"):
        unresolved_adhesion([1e-9], [1e-9], [1e-9, 2e-9], 1e-9)


def test_a_smooth_surface_has_no_pixel(pair):
    grid = Grid((64, 64), (0.25e-6, 0.25e-6))
    assert resolution_findings(Contact(pair, smooth(grid)), (5e-6) ** 2 / R) == []


@pytest.mark.parametrize(
    ("size", "whole"), [((16, 20), True), ((17, 22), True), ((18, 20), False), ((16, 22.5), False)]
)
def test_nine_tenths_of_both_edges_are_the_whole_scan(contact, size, whole):
    """The grid is 16 by 20 um."""
    wide, long = (1e-6 * edge for edge in size)
    scan = {"size_x_m": wide, "size_y_m": long}
    assert grid_of_a_scan(contact(source="measured", **scan)) is whole
    assert not grid_of_a_scan(contact(source="generated", **scan))


def adhesive_nodes(state):
    """Nodes per pull-off radius of the asperities in contact."""
    return ADHESIVE_NODES * adhesive_spacing(state) / max(state.contact.grid.spacing)


def adhesive(pair, curvatures, nodes=(40, 44)):
    """A paraboloid with these curvatures (1/m) besides those of the bodies, and w = 0.5 J/m2."""
    grid = Grid(nodes, (0.12e-6, 0.1e-6))
    x, y = grid.x[:, None], grid.y[None, :]
    height = -0.5 * (curvatures[0] * x**2 + curvatures[1] * y**2)
    return Contact(pair, Surface(height, grid), adhesion=JKRLimit(0.5))


@pytest.mark.parametrize(
    ("curvatures", "mean"),
    [((0.0, 0.0), 1 / R), ((6e4, 2e4), 4e4 + 1 / R), ((-3e3, -3e3), 1 / R)],
)
def test_an_asperity_pulls_off_at_the_radius_of_its_mean_curvature(pair, curvatures, mean):
    """a_c = (9πw/(8E*κ²))^⅓ with κ at least that of the bodies; nodes of the coarser spacing."""
    depth = 1e-9 if mean > 1e4 else 1e-10
    grid = (40, 44) if mean > 1e4 else (64, 72)
    state = solve(adhesive(pair, curvatures, grid), depth)
    a_c = (9 * math.pi * 0.5 / (8 * pair.contact_modulus * mean**2)) ** (1 / 3)
    assert adhesive_nodes(state) == approx(a_c / 0.12e-6, rel=1e-6)


def test_curvature_is_known_up_to_the_edge_of_the_grid(pair):
    """The contact ends a node before the edge of the smallest grid that holds it."""
    wide = solve(adhesive(pair, (6e4, 2e4)), 1e-9)
    nodes = []
    for state in (wide, solve(adhesive(pair, (6e4, 2e4), tight(wide)), 1e-9)):
        assert state.contact_nodes == wide.contact_nodes
        nodes.append(adhesive_nodes(state))
    assert any(part.start == 0 for part in state.box)
    assert nodes[1] == approx(nodes[0], rel=1e-6)


def tight(state):
    """Nodes of the smallest grid with a free node on each side of the contact."""
    i, j = np.nonzero(state.pressure)
    centre = [n // 2 for n in state.contact.grid.nodes]
    reach = [int(np.abs(k - c).max()) for k, c in zip((i, j), centre, strict=True)]
    return tuple(2 * r + 3 for r in reach)


def test_adhesion_is_needed_for_a_pull_off_radius(contact):
    assert adhesive_nodes(solve(contact(), 1e-8)) == math.inf


@pytest.mark.parametrize(("detachment", "share"), [("crack-closure", 0.25), ("pohrt-popov", 1.5)])
def test_the_error_of_pull_off_is_a_share_of_a_node(pair, detachment, share):
    a_c = (9 * math.pi * 0.1 * R**2 / (8 * pair.contact_modulus)) ** (1 / 3)
    for spacing in ((1e-7, 5e-8), (1e-8, 2e-8)):
        surface = smooth(Grid((8, 8), spacing))
        coarse = Contact(
            pair, surface, adhesion=adhesion_of(work_of_adhesion=0.1, detachment=detachment)
        )
        expected = share * max(spacing) / a_c
        assert coarse.adhesion.expected_pull_off_error(coarse) == approx(expected, rel=1e-9)


@pytest.mark.parametrize("radius", [1e-6, 1e-3])
def test_the_range_of_the_attraction_is_to_be_resolved_on_asperities(pair, radius, monkeypatch):
    """Cells of half sqrt(r z0) at asperities of radius r, and never more than for smooth bodies."""
    z0 = 0.3e-9
    monkeypatch.setattr(law, "radius_of_asperities", lambda _: radius)
    largest = min(0.5 * math.sqrt(radius * z0), 0.3 * math.sqrt(pair.radius * z0))
    for share in (0.99, 1.01):
        grid = Grid(8, share * largest)
        contact = Contact(
            pair,
            smooth(grid),
            adhesion=Cohesive(0.1 * pair.contact_modulus * z0**2 / grid.spacing[0], z0),
        )
        state = SimpleNamespace(contact=contact)
        assert adhesive_spacing(state) == approx(largest, rel=1e-6)
        assert resolves_adhesion(state) is (share < 1)
