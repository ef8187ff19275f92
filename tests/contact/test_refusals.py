"""Errors of a solve: invalid depths, contact at the edge of the grid, no convergence."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from restitution.contact import equilibrium
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact, smooth
from restitution.contact.loading import solve, step
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface

UM, NM = 1e-6, 1e-9
DEPTH = 40 * NM


@pytest.mark.parametrize("depth", [0.0, -1e-9, math.nan, math.inf])
def test_a_depth_that_is_none_is_refused(rough_contact, depth):
    with pytest.raises(CaseError, match=r"^indentation: .*not a positive depth"):
        solve(rough_contact(), depth)


def advised_edges(message):
    """The edge lengths (um) that an error message recommends."""
    (found,) = re.findall(r"grid of about ([\d.]+) um(?: x ([\d.]+) um)?", message)
    return [float(edge) for edge in found if edge]


def test_a_contact_that_reaches_the_rim_is_refused_with_numbers(pair):
    contact = Contact(pair, smooth(Grid((20, 16), (0.5 * UM, 0.5 * UM))))
    fits = solve(contact, 30 * NM)  # radius 2.7 of 3.5 um
    with pytest.raises(DomainError) as refusal:
        solve(contact, 80 * NM)
    message = str(refusal.value)
    assert "edge of the 10 um x 8 um grid" in message
    assert "indentation of 80 nm" in message
    assert min(advised_edges(message)) > 9  # um, the diameter that touches
    with pytest.raises(DomainError, match="reaches the edge"):
        step(fits, 80 * NM)


@pytest.mark.parametrize("corner", [(0, 3), (-1, 3), (3, 0), (3, -1)])
def test_any_edge_is_the_rim(pair, corner):
    grid = Grid((8, 7), (UM, UM))
    z = np.zeros(grid.nodes)
    z[corner] = 1 * UM
    with pytest.raises(DomainError):
        solve(Contact(pair, Surface(z, grid)), 1 * NM)
    # only pressure at the edge of the grid is an error, whatever the depth
    state = solve(Contact(pair, smooth(grid)), 1 * NM)
    require_inside_grid(state)
    with pytest.raises(DomainError):
        require_inside_grid(replace(state, box=(slice(0, 8), slice(0, 7)), box_pressure=z))


@pytest.mark.parametrize("nodes", [(1, 1), (1, 30), (30, 1), (2, 30)])
def test_a_grid_that_is_all_rim_is_refused(pair, nodes):
    with pytest.raises(DomainError):
        solve(Contact(pair, smooth(Grid(nodes, (UM, UM)))), 1 * NM)


def test_the_advice_of_a_rim_asperity_is_not_a_smaller_grid(pair):
    grid = Grid((64, 64), (0.25 * UM, 0.25 * UM))
    z = np.zeros(grid.nodes)
    z[0, 30] = 1 * UM
    with pytest.raises(DomainError) as refusal:
        solve(Contact(pair, Surface(z, grid)), 1 * NM)
    assert min(advised_edges(str(refusal.value))) > 16


def test_a_solve_that_does_not_converge_says_how_far_it_came(rough_contact, monkeypatch):
    monkeypatch.setattr(equilibrium, "MAX_ITERATIONS", 2)
    with pytest.raises(NotConvergedError) as failure:
        solve(rough_contact(), DEPTH)
    message = str(failure.value)
    assert "indentation of 40 nm" in message
    assert "tolerance: 1e-08) after 2 iterations" in message
    assert "stopped at a residual of " in message
    monkeypatch.undo()
    solve(rough_contact(), DEPTH)


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("depth", [math.nan, math.inf])
def test_a_step_to_nowhere_is_refused(rough_contact, depth):
    state = solve(rough_contact(), DEPTH)
    with pytest.raises(CaseError):
        step(state, depth)
