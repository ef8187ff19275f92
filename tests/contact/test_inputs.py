"""What checks find before anything is solved: each on both sides of its limit, and its values."""

import math
from dataclasses import asdict

import numpy as np
import pytest

from contact_keys import contact_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.checks.edge import edge_predicted
from restitution.contact.checks.inputs import doubtful, impossible
from restitution.contact.checks.resolution import predicted_radius
from restitution.contact.contact import Contact, smooth
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from restitution.theory import Hertz, Kendall
from tolerance import approx

UM = 1e-6
GRID = Grid((60, 80), (0.5 * UM, 0.4 * UM))  # 30 um x 32 um
X, Y = GRID.x[:, None], GRID.y[None, :]
DEEP = 1e-7  # m: the contact radius is 5 um, ten nodes
BEYOND = 1 + 1e-6


def on(pair, height, provenance=(), **values):
    return contact_of(pair, Surface(height, GRID, dict(provenance)), **values)


def codes(contact, indentation=DEEP):
    return [found.code for found in doubtful(contact, indentation)]


def found_by(contact, code, indentation=DEEP):
    (found,) = [each for each in doubtful(contact, indentation) if each.code == code]
    return found


# ---- what has no meaning


@pytest.mark.parametrize("swapped", [False, True])
def test_roughness_is_higher_than_the_smaller_particle(swapped):
    bodies = [Body(2 * UM, 210e9, 0.25), Body(1.0, 210e9, 0.25)]
    small = Pair(*bodies[::-1] if swapped else bodies)
    height = np.zeros(GRID.nodes)
    height[:, :40] = 1.0  # one above half of the nodes: the peak is 0.5 above the mean
    found = impossible(on(small, 4 * UM * BEYOND * height), 1e-9)
    assert found.code == "roughness-above-radius"
    assert found.radius == 2 * UM
    assert found.peak == approx(2 * UM, rel=1e-5)
    assert impossible(on(small, 4 * UM / BEYOND * height), 1e-9) is None


def test_a_contact_is_larger_than_the_particle(pair):
    contact = on(pair, np.zeros(GRID.nodes))
    assert impossible(contact, pair.radius / BEYOND) is None
    found = impossible(contact, 4 * pair.radius)
    assert found.code == "contact-beyond-radius"
    assert found.radius == approx(2 * pair.radius)
    assert (found.indentation, found.reduced_radius) == (4 * pair.radius, pair.radius)


def test_a_pixel_is_larger_than_the_contact(pair):
    scan = {"file": "scan.npy", "pixel_x_m": 6 * UM, "pixel_y_m": UM}
    assert impossible(on(pair, np.zeros(GRID.nodes), scan), DEEP).code == "pixel-above-contact"
    assert impossible(on(pair, np.zeros(GRID.nodes), scan), 2 * DEEP) is None


# ---- what speaks against it


def test_nothing_is_found_in_a_good_contact(pair):
    assert doubtful(on(pair, np.zeros(GRID.nodes)), DEEP) == []


def tilted(explained):
    """Heights whose variance a plane explains to this part; the rest alternates."""
    plane = X + 0 * Y
    rest = np.where(np.indices(GRID.nodes).sum(axis=0) % 2, 1.0, -1.0)
    plane, rest = (each / each.std() for each in (plane - plane.mean(), rest))
    return 1e-10 * (math.sqrt(explained) * plane + math.sqrt(1 - explained) * rest)


@pytest.mark.parametrize("key", ["levelling", "part_2_levelling"])
@pytest.mark.parametrize("how", ["none", "center"])
def test_half_of_the_variance_may_be_a_plane(pair, key, how):
    scan = {"file": "scan.npy", key: how}
    found = found_by(on(pair, tilted(0.51), scan), "tilted-scan")
    assert found.file == "scan.npy"
    assert found.explained == approx(0.51, rel=1e-2)
    assert codes(on(pair, tilted(0.49), scan)) == []


def test_only_a_scan_that_was_not_levelled_is_tilted(pair):
    for provenance in (
        {},
        {"file": "scan.npy"},
        {"file": "scan.npy", "levelling": "tilt"},
        {"file": "scan.npy", "levelling": "center, curvature"},
    ):
        assert codes(on(pair, tilted(0.9), provenance)) == []
    flat = on(pair, np.zeros(GRID.nodes), {"file": "scan.npy", "levelling": "none"})
    assert codes(flat) == []


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("side", [-1, 1])
def test_the_first_touch_is_near_an_edge(pair, axis, side):
    """Beyond 0.4 of the edge length from the middle."""

    def spike(part):
        height = np.zeros(GRID.nodes)
        node = [n // 2 for n in GRID.nodes]
        node[axis] += round(side * part * GRID.nodes[axis])
        height[tuple(node)] = 1e-6
        return on(pair, height)

    found = found_by(spike(0.45), "edge-predicted")
    assert found == edge_predicted(spike(0.45), DEEP, found.gap)
    assert "edge-predicted" not in codes(spike(0.35))


@pytest.mark.parametrize("corner", [(0, 9), (-1, 9), (9, 0), (9, -1)])
def test_any_edge_of_the_grid_may_close(pair, corner):
    """A node at the rim that is as high as the centre, which touches first."""
    height = np.zeros(GRID.nodes)
    centre = tuple(n // 2 for n in GRID.nodes)
    rim = on(pair, height).gap[corner]
    height[corner] = rim
    height[centre] = 1e-9
    found = found_by(on(pair, height), "edge-predicted")
    assert found.gap == approx(1e-9, rel=1e-6)


def predicted_from(contact):
    """The indentation from which contact at the edge is predicted, by bisection."""
    low, high = 1e-9, (0.499 * min(GRID.size)) ** 2 / contact.pair.radius
    for _ in range(50):
        middle = 0.5 * (low + high)
        reached = "edge-predicted" in codes(contact, middle)
        low, high = (low, middle) if reached else (middle, high)
    return high


def peaked(pair, gap, **values):
    """Smooth bodies, but for one node at the rim where the gap is this (m)."""
    rim = (0, GRID.nodes[1] // 2)
    height = np.zeros(GRID.nodes)
    height[rim] = Contact(pair, smooth(GRID)).gap[rim] - gap
    return on(pair, height, **values)


@pytest.mark.parametrize("gap", [1e-7, 3e-7])
def test_the_edge_closes_as_far_as_smooth_bodies_displace_it(pair, gap):
    """δ − 0.7 F/(πE*r) = the gap, less the share of the height of the roughness."""
    contact = peaked(pair, gap)
    depth = predicted_from(contact)
    share = 0.7 - contact.surface.height.std() / depth
    assert 0.5 < share < 0.698
    F = float(Hertz(pair.radius, pair.contact_modulus).force(depth))
    closed = depth - share * F / (math.pi * pair.contact_modulus * 0.5 * min(GRID.size))
    assert closed == approx(gap, rel=1e-6)


def test_a_force_that_yields_displaces_less(pair):
    contact = peaked(pair, 2e-7, yield_pressure=100e6)
    depth = predicted_from(contact)
    share = 0.7 - contact.surface.height.std() / depth
    F = math.pi * predicted_radius(pair, depth, 100e6) ** 2 * 100e6
    closed = depth - share * F / (math.pi * pair.contact_modulus * 0.5 * min(GRID.size))
    assert closed == approx(2e-7, rel=1e-6)
    assert depth < predicted_from(peaked(pair, 2e-7))


def test_adhesion_draws_the_edge_in(pair):
    """By the displacement at which a punch as wide as the contact parts."""
    w = 0.5
    contact = peaked(pair, 2e-7, work_of_adhesion=w)
    depth = predicted_from(contact)
    deeper = depth
    for _ in range(50):
        radius = math.sqrt(pair.radius * deeper)
        pulled = float(Kendall(pair.contact_modulus, w).pull_off_displacement(radius))
        deeper = depth + pulled
    assert pulled > 0.05 * depth
    share = 0.7 - contact.surface.height.std() / depth
    F = 4 * pair.contact_modulus * radius**3 / (3 * pair.radius)
    closed = deeper - share * F / (math.pi * pair.contact_modulus * 0.5 * min(GRID.size))
    assert closed == approx(2e-7, rel=1e-6)


def test_a_contact_beyond_the_grid_is_said_once(pair):
    depth = (0.5 * min(GRID.size)) ** 2 / pair.radius
    assert codes(on(pair, np.zeros(GRID.nodes)), depth * BEYOND) == ["contact-beyond-grid"]


@pytest.mark.parametrize(("slope", "steep"), [(0.499, False), (0.501, True)])
def test_half_is_a_steep_slope(pair, slope, steep):
    zigzag = np.where(np.arange(GRID.nodes[0]) % 2, slope * GRID.spacing[0], 0.0)
    contact = on(pair, zigzag[:, None] + 0 * Y)
    found = [each for each in doubtful(contact, DEEP) if each.code == "steep-surface"]
    assert bool(found) is steep
    if found:
        assert found[0].slope == approx(slope, rel=1e-9)
        assert found[0].limit == 0.5


@pytest.mark.parametrize(
    ("ratio", "unusual"), [(0.99e-5, True), (1.01e-5, False), (0.299, False), (0.301, True)]
)
def test_yield_pressures_of_materials(pair, ratio, unusual):
    contact = on(pair, np.zeros(GRID.nodes), yield_pressure=ratio * pair.contact_modulus)
    found = [each for each in doubtful(contact, DEEP) if each.code == "unusual-yield-pressure"]
    assert bool(found) is unusual
    if found:
        assert asdict(found[0]) == {"ratio": approx(ratio), "low": 1e-5, "high": 0.3}


@pytest.mark.parametrize(("stretch", "oblong"), [(0.989, True), (0.991, False), (1.011, True)])
@pytest.mark.parametrize("part", ["", "part_1_"])
def test_pixels_are_square_to_a_hundredth(pair, stretch, oblong, part):
    pixels = {f"{part}pixel_x_m": stretch * 0.4 * UM, f"{part}pixel_y_m": 0.4 * UM}
    file = {f"{part}file": "scan.npy"}
    contact = on(pair, np.zeros(GRID.nodes), {**pixels, **file})
    found = [each for each in doubtful(contact, DEEP) if each.code == "oblong-pixels"]
    assert bool(found) is oblong
    if found:
        values = {"file": "scan.npy", "x": approx(stretch * 0.4 * UM), "y": 0.4 * UM}
        assert asdict(found[0]) == values
    assert "oblong-pixels" not in codes(on(pair, np.zeros(GRID.nodes), pixels))


def test_every_part_of_a_composite_is_looked_at_and_nothing_else(pair):
    square = {"part_1_pixel_x_m": UM, "part_1_pixel_y_m": UM, "part_1_file": "a.npy"}
    oblong = {"part_2_pixel_x_m": UM, "part_2_pixel_y_m": 2 * UM, "part_2_file": "b.npy"}
    found = found_by(on(pair, np.zeros(GRID.nodes), {**square, **oblong}), "oblong-pixels")
    assert found.file == "b.npy"
    other = {"coarsest_pixel_x_m": UM, "coarsest_pixel_y_m": 2 * UM, "coarsest_file": "c.npy"}
    assert codes(on(pair, np.zeros(GRID.nodes), other)) == []


@pytest.mark.parametrize(("axis", "spacing"), [("x", 0.5 * UM), ("y", 0.4 * UM)])
def test_a_grid_is_coarser_than_its_scan(pair, axis, spacing):
    def with_pixel(pixel):
        pixels = dict(zip(("pixel_x_m", "pixel_y_m"), GRID.spacing, strict=True))
        return on(pair, np.zeros(GRID.nodes), {**pixels, f"pixel_{axis}_m": pixel})

    found = found_by(with_pixel(spacing / 1.002), "coarser-than-scan")
    assert asdict(found) == {"spacing": spacing, "pixel": spacing / 1.002, "axis": axis}
    assert "coarser-than-scan" not in codes(with_pixel(spacing / 1.0005))


def test_a_notice_is_repeated(pair):
    found = found_by(on(pair, np.zeros(GRID.nodes), {"notice": "half of it"}), "surface-notice")
    assert found.notice == "half of it"
