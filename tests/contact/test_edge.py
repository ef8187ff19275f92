"""What a user is told when the contact reaches the edge of the grid."""

import re

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, smooth, solve
from restitution.contact.edge import needed_edges
from restitution.errors import DomainError
from tolerance import approx

STEEL = Pair(*2 * [Body(500e-6, 210e9, 0.25)])
GRID = Grid((32, 32), (1e-6, 1e-6))


def refusal(contact, indentation):
    with pytest.raises(DomainError) as refused:
        solve(contact, indentation)
    message = str(refused.value)
    assert re.match(r"the contact reaches the edge of the .* um grid at an indentation of", message)
    return message


def scan(height, **provenance):
    provenance = {"source": "measured", "levelling": "none", **provenance}
    return Contact(STEEL, Surface(height, GRID, provenance))


def test_the_grid_advised_holds_the_contact():
    for surface in (
        smooth(GRID),
        generate_surface(GRID, kind="gaussian", rms=1e-7, correlation_length=6e-6, seed=2),
    ):
        message = refusal(Contact(STEEL, surface, 750e6), 2e-6)
        edge = float(re.search(r"use a grid of about ([\d.]+) um \(more grid", message)[1])
        nodes = int(edge) + 1
        solve(Contact(STEEL, smooth(Grid((nodes, nodes), (1e-6, 1e-6))), 750e6), 2e-6)


def test_the_grid_advised_is_never_smaller_than_the_present_one():
    """An asperity in the corner touches at any depth."""
    height = np.zeros(GRID.nodes)
    height[0, 3] = 5e-6
    contact = Contact(STEEL, Surface(height, GRID))
    message = refusal(contact, 1e-9)
    assert "first at x = -16 um, y = -13 um, off the centre" in message
    assert min(needed_edges(contact, 1e-9)) > 32e-6
    narrow = Contact(STEEL, smooth(Grid((16, 64), (1e-6, 1e-6))))
    assert "use a grid of about 26.8 um x 64 um" in refusal(narrow, 2.5e-7)


def test_a_tilted_scan_is_to_be_levelled_first():
    tilted = np.repeat(1e-6 * np.linspace(0, 5, 32)[:, None], 32, axis=1)
    message = refusal(scan(tilted), 2e-7)
    assert "off the centre; use roughness.detrend = " in message
    assert 'use roughness.detrend = "tilt" or "curvature", a larger scan' in message
    assert "nodes" not in message
    assert 'use roughness.detrend = "curvature", a la' in refusal(
        scan(tilted, levelling="tilt"), 2e-7
    )
    assert "; use a larger scan" in refusal(scan(tilted, levelling="curvature"), 2e-7)


def test_more_of_a_scan_is_advised_only_where_there_is_more():
    part = scan(np.zeros(GRID.nodes), size_x_m=90e-6, size_y_m=90e-6)
    assert "a grid of about 53.7 um (the scan has 90 x 90)" in refusal(part, 1e-6)
    assert "a larger scan" in refusal(part, 4e-6)


def test_the_level_of_the_heights_does_not_matter():
    """Depths count from first touch, wherever the mean of the heights is."""
    surface = generate_surface(GRID, kind="gaussian", rms=2e-7, correlation_length=5e-6, seed=2)
    raised = Surface(surface.height + 1e-6, GRID)
    edges = [needed_edges(Contact(STEEL, each), 1e-6) for each in (surface, raised)]
    assert edges[0] == approx(edges[1], rel=1e-12)
