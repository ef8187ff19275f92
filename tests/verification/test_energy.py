"""The energies of a single solve against the work along the path, on rough surfaces."""

import numpy as np
import pytest

from restitution import (
    Contact,
    Grid,
    collide,
    generate_surface,
    loading_path,
    solve,
    step,
    unloading_path,
)
from restitution.case.models import plasticity_of
from restitution.contact.plasticity.bound import ConstantBound
from restitution.numerics.quadrature import integrate_curve
from tolerance import approx

P_Y = 750e6
DEPTH = 400e-9


@pytest.fixture(scope="module")
def contact(pair):
    grid = Grid((160, 128), (0.25e-6, 0.3e-6))
    surface = generate_surface(
        grid, kind="exponential", rms=0.05e-6, correlation_length=2e-6, seed=3
    )
    return Contact(pair, surface, plasticity=ConstantBound(P_Y))


@pytest.fixture(scope="module")
def state(contact):
    return solve(contact, DEPTH, residual=1e-10)


def test_loading_work_is_stored_energy_plus_yield_pressure_times_plastic_volume(contact, state):
    # F grows about as δ^1.5 or faster from first touch: points crowded towards it as t².
    depths = DEPTH * (np.arange(1, 251) / 250) ** 2
    forces = [s.force for s in loading_path(contact, depths)]
    work = integrate_curve(np.append(0.0, depths), np.append(0.0, forces))
    assert state.stored_energy + P_Y * state.plastic_volume == approx(work, rel=1e-4)
    assert state.plastic_work == approx(P_Y * state.plastic_volume, rel=1e-12)
    assert 0.2 < state.plastic_work / state.loading_work < 0.98  # both parts matter here


def test_one_solve_is_a_hundred_steps(contact, state):
    depths = np.linspace(0, DEPTH, 101)[1:]
    stepped = solve(contact, depths[0], residual=1e-10)
    for depth in depths[1:]:
        stepped = step(stepped, depth, residual=1e-10)
    assert stepped.force == approx(state.force, rel=1e-6)
    assert stepped.stored_energy == approx(state.stored_energy, rel=1e-6)
    assert stepped.plastic_work == approx(state.plastic_work, rel=1e-6)
    assert collide(stepped).restitution == approx(collide(state).restitution, rel=1e-6)


@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_stepped_unloading_returns_the_stored_energy(pair, contact, plasticity):
    deepest = solve(
        Contact(pair, contact.surface, plasticity=plasticity_of(plasticity, P_Y)),
        DEPTH,
    )
    path = list(unloading_path(deepest))
    work = -integrate_curve([s.indentation for s in path], [s.force for s in path])
    assert work == approx(deepest.stored_energy, rel=1e-3)
    assert path[-1].force == 0
    assert path[-2].force > 0
    # Nothing yields on the way back.
    assert path[-2].plastic_work == approx(deepest.plastic_work, rel=1e-6)


def test_unloading_and_reloading_meet_the_loading_curve(contact, state):
    back = step(state, 0.9 * DEPTH)
    again = step(back, DEPTH)
    assert again.force == approx(state.force, rel=1e-6)
    deeper = step(again, 1.1 * DEPTH)
    assert deeper.force == approx(solve(contact, 1.1 * DEPTH).force, rel=1e-6)


def test_vanishing_yield_pressure_gives_the_bearing_area(pair, contact):
    """Nothing resists: the area is where the bodies overlap, and all of it yields."""
    soft = Contact(pair, contact.surface, plasticity=ConstantBound(1e3))
    state = solve(soft, DEPTH)
    overlapping = np.count_nonzero(soft.gap < DEPTH)
    assert state.contact_nodes == approx(overlapping, rel=2e-3)
    assert state.force == approx(1e3 * overlapping * soft.grid.cell_area, rel=2e-3)
