"""The fast path (nested grids, windows, boxes, single precision inside) against the plain one."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from contact_keys import contact_of
from restitution import Body, Grid, Pair, solve, step
from restitution.contact import equilibrium
from restitution.contact.influence import half_space, inverse_half_space
from restitution.contact.jkr import area as adhesion
from restitution.numerics.convolution.operators import FreeConvolution
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.surfaces import generate_surface
from tolerance import approx

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
DEPTH = 200e-9


def rough(seed, **options):
    """A rough contact on so many nodes that coarser grids and windows come in."""
    grid = Grid((200, 184), (0.12e-6, 0.13e-6))
    rms = (20e-9, 60e-9)[seed % 2]
    surface = generate_surface(grid, kind="gaussian", rms=rms, correlation_length=1e-6, seed=seed)
    return contact_of(Pair(STEEL, STEEL), surface, **options)


def plain_pressure(contact, depth):
    """Every node of the grid, from nothing, in double precision throughout."""
    arguments = contact.grid.nodes, contact.grid.spacing, contact.pair.contact_modulus
    b = depth - contact.gap
    found = minimise_quadratic(
        BoundedQuadratic(half_space(*arguments), b, 0.0, contact.hardness),
        start=np.zeros_like(b),
        precondition=inverse_half_space(*arguments),
        tolerance=1e-9 * depth,
        max_iterations=1000,
    )
    assert found.converged
    return found.point


@pytest.mark.parametrize("p_y", [np.inf, 2e9, 750e6])
@pytest.mark.parametrize("seed", range(4))
def test_elastic_and_plastic(seed, p_y):
    contact = rough(seed, yield_pressure=p_y)
    state = solve(contact, DEPTH)
    plain = plain_pressure(contact, DEPTH)
    assert_allclose(state.pressure, plain, atol=1e-5 * plain.max())
    assert state.force == approx(plain.sum() * contact.grid.cell_area, rel=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_adhesive(seed, monkeypatch):
    """Loaded, then drawn back past where nodes let go: the same ones."""
    contact = rough(seed, work_of_adhesion=0.5, yield_pressure=2e9, approach="hertzian")

    def pulled():
        deepest = solve(contact, DEPTH)
        return deepest, step(replace(deepest, is_first_loading=False), 0.8 * DEPTH)

    fast = pulled()
    nx, ny = contact.grid.nodes
    for module in (adhesion, equilibrium):
        monkeypatch.setattr(module, "candidate_box", lambda *_: (slice(0, nx), slice(0, ny)))
    monkeypatch.setattr(FreeConvolution, "single_precision", FreeConvolution.__call__)
    plain = pulled()
    assert fast[1].contact_nodes < fast[0].contact_nodes
    for state, expected in zip(fast, plain, strict=True):
        assert np.array_equal(state.pressure != 0, expected.pressure != 0)
        assert state.force == approx(expected.force, rel=1e-7)
        assert state.stored_energy == approx(expected.stored_energy, rel=1e-7)
