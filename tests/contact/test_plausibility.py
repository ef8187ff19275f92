"""What is said against a contact before it is solved."""

import math

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, smooth
from restitution.contact.path import loading_path
from restitution.contact.plausibility import input_warnings, require_small
from restitution.contact.resolution import predicted_warnings
from restitution.errors import CaseError, DomainError

STEEL = Pair(*2 * [Body(500e-6, 210e9, 0.25)])
GRID = Grid((64, 64), (0.5e-6, 0.5e-6))
X, Y = GRID.x[:, None], GRID.y[None, :]
ROUGH = generate_surface(GRID, kind="gaussian", rms=2e-8, correlation_length=3e-6, seed=1).height


def measured(height, **provenance):
    provenance = {"source": "measured", "file": "scan.npy", "levelling": "none", **provenance}
    return Contact(STEEL, Surface(height, GRID, provenance), 750e6)


def test_a_good_contact_is_let_pass():
    assert input_warnings(Contact(STEEL, smooth(GRID), 750e6), 4e-7) == []
    assert input_warnings(Contact(STEEL, smooth(GRID)), 4e-7) == []
    assert input_warnings(measured(ROUGH), 4e-7) == []


def test_a_tilted_scan():
    line, edge = input_warnings(measured(ROUGH + 6e-2 * X), 1e-7)
    assert "off the centre; use roughness.detrend" in edge
    assert line.startswith("scan.npy: the scan is tilted (a plane explains ")
    assert 'set roughness.detrend = "tilt"' in line
    assert len(input_warnings(measured(ROUGH + 6e-2 * X, levelling="tilt"), 1e-7)) == 1


def test_contact_at_the_rim_is_foreseen_where_smooth_bodies_would_not_have_it():
    bump = 8e-7 * np.exp(-(((X + 14e-6) / 1e-6) ** 2) - (Y / 1e-6) ** 2)
    lines = input_warnings(Contact(STEEL, Surface(bump, GRID), 750e6), 1e-7)
    assert len(lines) == 1
    assert "foreseen to reach the edge of the grid" in lines[0]
    assert "first at x = -14 um, y = 0 um, off the centre" in lines[0]
    # a ridge that is lower than the centre, but not by enough
    ridge = 3.5e-7 * np.exp(-(((X - 15e-6) / 2e-6) ** 2)) + 0 * Y
    (line,) = input_warnings(Contact(STEEL, Surface(ridge, GRID), 750e6), 4e-7)
    assert "the gap there is 151.7 nm" in line
    assert input_warnings(Contact(STEEL, Surface(ridge, GRID), 750e6), 5e-8) == []


@pytest.mark.parametrize("yield_pressure", [math.inf, 750e6])
@pytest.mark.parametrize(("rms", "work_of_adhesion"), [(0.0, 0.0), (2e-8, 0.0), (0.0, 1.0)])
def test_what_reaches_the_edge_is_foreseen_before(yield_pressure, rms, work_of_adhesion):
    """The grid that holds a contact is found by trial: on all smaller ones it is foreseen."""
    for nodes in range(60, 26, -2):
        grid = Grid((nodes, nodes), (0.25e-6, 0.25e-6))
        surface = smooth(grid)
        if rms:
            shape = {"kind": "gaussian", "rms": rms, "correlation_length": 2e-6, "seed": 3}
            surface = generate_surface(grid, **shape)
        contact = Contact(STEEL, surface, yield_pressure, work_of_adhesion=work_of_adhesion)
        said = [*input_warnings(contact, 1e-7), *predicted_warnings(contact, 1e-7)]
        foreseen = any("foreseen to reach" in line for line in said)
        try:
            next(iter(loading_path(contact, [1e-7])))
        except DomainError:
            assert foreseen
            return
        if nodes == 60:
            assert not foreseen
    pytest.fail("no grid was too small")


def test_steep_surfaces():
    (line,) = input_warnings(Contact(STEEL, Surface(60 * ROUGH, GRID)), 4e-7)[-1:]
    assert "the rms slope of the surface is " in line


@pytest.mark.parametrize(("yield_pressure", "said"), [(750e3, "6.7e-06"), (750e9, "6.7")])
def test_a_yield_pressure_that_no_such_body_has(yield_pressure, said):
    lines = input_warnings(Contact(STEEL, smooth(GRID), yield_pressure), 1e-7)
    assert len(lines) == 1
    assert f"the yield pressure is {said} of the contact modulus" in lines[0]


def test_a_grid_coarser_than_the_scan():
    _, line = input_warnings(measured(ROUGH, pixel_x_m=0.5e-6, pixel_y_m=0.2e-6), 1e-7)
    assert "spacing 0.5 um is coarser than the scan's pixel 0.2 um along y" in line
    assert "shorter than 1 um are taken out" in line
    assert input_warnings(measured(ROUGH, pixel_x_m=0.7e-6, pixel_y_m=0.7e-6), 1e-7) == []


def test_oblong_pixels_may_be_a_scan_that_lost_lines():
    pixels = {"pixel_x_m": 5e-7, "pixel_y_m": 5.1e-7}
    (line,) = input_warnings(measured(ROUGH, **pixels), 4e-7)
    assert line.startswith("scan.npy: the pixels are 0.5 x 0.51 um, not square: if scan lines are")
    parts = {f"part_2_{key}": value for key, value in {**pixels, "file": "b.npy"}.items()}
    (line,) = input_warnings(measured(ROUGH, **parts), 4e-7)
    assert line.startswith("b.npy: the pixels are")
    assert input_warnings(measured(ROUGH, pixel_x_m=5e-7, pixel_y_m=5.02e-7), 4e-7) == []


def test_a_particle_smaller_than_its_roughness_is_refused():
    small = Pair(Body(1e-7, 210e9, 0.25), Body(math.inf, 210e9, 0.25))
    with pytest.raises(CaseError, match=r"^radius: the particle of 0.1 um is smaller than its"):
        require_small(Contact(small, Surface(10 * ROUGH, GRID)), 1e-9)
    require_small(Contact(small, Surface(0.1 * ROUGH, GRID)), 1e-9)


def test_a_contact_beyond_the_particle_is_refused():
    contact = Contact(STEEL, smooth(GRID))
    require_small(contact, 240e-6)
    with pytest.raises(CaseError, match=r"reach 255 um from the centre .* beyond R\* = 250 um"):
        require_small(contact, 260e-6)
