"""Values and advice of the error raised if the contact reaches the edge of the grid."""

import pickle
import re

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, generate_surface, smooth, solve
from restitution.contact.checks.edge import EdgeReachedError, edge_reached, needed_edges
from restitution.contact.plasticity.bound import ConstantBound
from tolerance import approx

STEEL = Pair(*2 * [Body(500e-6, 210e9, 0.25)])
GRID = Grid((32, 32), (1e-6, 1e-6))


def refusal(contact, indentation):
    with pytest.raises(EdgeReachedError) as refused:
        solve(contact, indentation)
    message = str(refused.value)
    assert re.match(r"the contact reaches the edge of the .* um grid at an indentation of", message)
    return refused.value


def scan(height, **provenance):
    provenance = {"source": "measured", "levelling": "none", **provenance}
    return Contact(STEEL, Surface(height, GRID, provenance))


def test_the_grid_advised_holds_the_contact():
    for surface in (
        smooth(GRID),
        generate_surface(GRID, kind="gaussian", rms=1e-7, correlation_length=6e-6, seed=2),
    ):
        message = str(refusal(Contact(STEEL, surface, plasticity=ConstantBound(750e6)), 2e-6))
        edge = float(re.search(r"use a grid of about ([\d.]+) um or stop", message)[1])
        nodes = int(edge) + 1
        solve(
            Contact(
                STEEL,
                smooth(Grid((nodes, nodes), (1e-6, 1e-6))),
                plasticity=ConstantBound(750e6),
            ),
            2e-6,
        )


def test_the_grid_advised_is_never_smaller_than_the_present_one():
    """An asperity in the corner touches at any depth."""
    height = np.zeros(GRID.nodes)
    height[0, 3] = 5e-6
    contact = Contact(STEEL, Surface(height, GRID))
    found = refusal(contact, 1e-9).finding
    assert found.first_touch == approx((-16e-6, -13e-6), rel=1e-12)
    assert found.off_centre
    assert found.needed == needed_edges(contact, 1e-9)
    assert min(found.needed) > 32e-6
    narrow = Contact(STEEL, smooth(Grid((16, 64), (1e-6, 1e-6))))
    assert "use a grid of about 26.8 um x 64 um or" in str(refusal(narrow, 2.5e-7))


def test_of_a_scan_it_says_how_it_was_levelled_and_how_large_it_is():
    found = refusal(scan(np.zeros(GRID.nodes), size_x_m=90e-6, size_y_m=80e-6), 1e-6).finding
    assert found.levelling == "none"
    assert found.scan == (90e-6, 80e-6)
    found = refusal(scan(np.zeros(GRID.nodes), levelling="tilt"), 1e-6).finding
    assert found.levelling == "tilt"
    assert found.scan == GRID.size
    assert refusal(Contact(STEEL, smooth(GRID)), 1e-6).finding.scan is None


def test_the_refusal_can_go_to_another_process():
    error = refusal(Contact(STEEL, smooth(GRID)), 1e-6)
    again = pickle.loads(pickle.dumps(error))
    assert str(again) == str(error)
    assert again.finding == error.finding


def test_the_level_of_the_heights_does_not_matter():
    """Depths are measured from first touch, whatever the mean height."""
    surface = generate_surface(GRID, kind="gaussian", rms=2e-7, correlation_length=5e-6, seed=2)
    raised = Surface(surface.height + 1e-6, GRID)
    edges = [needed_edges(Contact(STEEL, each), 1e-6) for each in (surface, raised)]
    assert edges[0] == approx(edges[1], rel=1e-12)


@pytest.mark.parametrize(("node", "off"), [((32, 32), False), ((32, 40), False), ((32, 56), True)])
def test_a_first_touch_off_the_centre_is_said(node, off):
    """24 of 64 cells from the middle is off-centre; 8 cells is not."""
    grid = Grid((64, 64), (1e-6, 1e-6))
    height = np.zeros(grid.nodes)
    height[node] = 1e-5
    contact = Contact(STEEL, Surface(height, grid))
    assert edge_reached(contact, 1e-7).off_centre is off
