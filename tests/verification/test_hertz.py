"""Smooth elastic spheres against Hertz."""

import numpy as np
import pytest

from restitution import Contact, Grid, collide, smooth, solve
from restitution.theory import Hertz
from tolerance import approx


def test_the_seed_case(pair, grid):
    depth = (10e-6) ** 2 / pair.radius  # a = 10 um
    state = solve(Contact(pair, smooth(grid)), depth)
    assert state.force == approx(Hertz(pair.radius, pair.contact_modulus).force(depth), rel=1e-4)
    assert state.stored_energy == approx(
        Hertz(pair.radius, pair.contact_modulus).stored_energy(depth), rel=1e-4
    )
    assert state.residual <= 1e-8
    assert state.convolutions <= 90
    assert collide(state).restitution == 1.0


def test_the_pressure_is_a_hemisphere(pair, grid):
    depth = (10e-6) ** 2 / pair.radius
    state = solve(Contact(pair, smooth(grid)), depth)
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    expected = Hertz(pair.radius, pair.contact_modulus).pressure(r, depth)
    inside = r < 9e-6
    assert state.pressure[inside] == approx(expected[inside], rel=2e-3)
    assert not state.pressure[r > 10e-6 + 0.25e-6].any()


def test_the_force_converges_at_second_order_in_the_spacing(pair):
    """The edge of the contact falls between nodes at random, so the order is that of a fit."""
    depth = (10e-6) ** 2 / pair.radius
    exact = Hertz(pair.radius, pair.contact_modulus).force(depth)
    spacings = 10e-6 / np.array([4.3, 6.1, 8.7, 12.2, 17.3, 24.4, 34.5, 48.8, 69.1])
    errors = []
    for h in spacings:
        n = int(2.4 * 10e-6 / h) + 3
        state = solve(Contact(pair, smooth(Grid((n, n), (h, h)))), depth)
        errors.append(abs(state.force / exact - 1))
    order = np.polyfit(np.log(spacings), np.log(errors), 1)[0]
    assert 1.5 < order < 2.5
    assert errors[-1] < 5e-5


@pytest.mark.parametrize(("hx", "hy"), [(0.25e-6, 0.5e-6), (0.6e-6, 0.2e-6)])
def test_rectangular_cells(pair, hx, hy):
    depth = (10e-6) ** 2 / pair.radius
    grid = Grid((int(24e-6 / hx), int(24e-6 / hy)), (hx, hy))
    state = solve(Contact(pair, smooth(grid)), depth)
    assert state.force == approx(Hertz(pair.radius, pair.contact_modulus).force(depth), rel=5e-4)
