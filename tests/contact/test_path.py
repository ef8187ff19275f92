from itertools import islice

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.path import loading_path, unloading_path
from restitution.errors import CaseError, DomainError
from restitution.numerics.quadrature import integrate_curve
from tolerance import approx

P_Y = 750e6
DEPTH = 40e-9


@pytest.fixture
def contact(rough_contact):
    return rough_contact(yield_pressure=P_Y)


def curve(states):
    return np.array([s.indentation for s in states]), np.array([s.force for s in states])


def test_each_state_of_a_path_is_the_solve_at_its_depth(contact):
    """The states are equal to the last digit: none depends on the solves before it."""
    depths = [10e-9, 30e-9, 20e-9, 40e-9]  # in any order
    path = list(loading_path(contact, depths))
    assert [s.indentation for s in path] == depths
    for state in path:
        alone = solve(contact, state.indentation)
        assert state.force == alone.force
        assert state.plastic_work == alone.plastic_work


def test_a_truncated_path_adds_to_the_work_it_has(rough_contact):
    contact = rough_contact(yield_pressure=P_Y, plasticity="truncated")
    first, second = loading_path(contact, [0.98 * DEPTH, DEPTH])
    alone = solve(contact, DEPTH)
    assert second.convolutions < 0.5 * alone.convolutions
    assert second.loading_work == approx(alone.loading_work, rel=3e-5)
    added = second.loading_work - first.loading_work
    assert first.force * 0.02 * DEPTH < added < second.force * 0.02 * DEPTH


def test_a_path_of_forces_meets_them(contact):
    top = solve(contact, DEPTH).force
    forces = [0.2 * top, 0.7 * top, top]
    path = list(loading_path(contact, forces=forces))
    assert [s.force for s in path] == approx(forces, rel=1e-8)
    assert path[-1].indentation == approx(DEPTH, rel=1e-6)


def test_a_path_is_streamed(contact):
    """Depths are solved on demand: the last one, which would raise an error, is not solved."""
    path = loading_path(contact, [10e-9, 20e-9, 1e-3])
    assert len(list(islice(path, 2))) == 2
    with pytest.raises(DomainError):
        next(path)
    assert list(loading_path(contact, [])) == []


@pytest.mark.parametrize("what", [{}, {"indentations": [1e-9], "forces": [1e-3]}])
def test_a_path_follows_depths_or_forces(contact, what):
    with pytest.raises(CaseError, match="takes exactly one of indentations, forces and velocities"):
        next(loading_path(contact, **what))


@pytest.mark.parametrize("p_y", [np.inf, 2e9, P_Y, 2e8])
@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_unloading_returns_the_stored_energy(rough_contact, p_y, plasticity):
    deepest = solve(rough_contact(yield_pressure=p_y, plasticity=plasticity), DEPTH)
    path = list(unloading_path(deepest))
    depths, forces = curve(path)
    assert -integrate_curve(depths, forces) == approx(deepest.stored_energy, rel=1e-3)
    assert len(path) == 17
    assert path[0] is deepest
    assert (np.diff(depths) < 0).all()
    assert (np.diff(forces) < 0).all()
    assert forces[-1] == 0
    assert depths[-1] == approx(deepest.separation_indentation, rel=1e-14)
    for state in path[1:]:
        assert state.plastic_work == approx(deepest.plastic_work, rel=1e-6)
        # the springs carry the displacement that has not recovered yet
        assert state.stored_energy < deepest.stored_energy


def test_loading_work_is_the_integral_of_the_force(contact):
    depths = DEPTH * (np.arange(1, 81) / 80) ** 2
    path = list(loading_path(contact, depths))
    d, F = curve(path)
    work = integrate_curve(np.append(0, d), np.append(0, F))
    assert path[-1].loading_work == approx(work, rel=2e-4)


def test_more_steps_come_closer(rough_contact):
    deepest = solve(rough_contact(yield_pressure=P_Y), DEPTH, residual=1e-11)
    errors = []
    for steps in (4, 16, 64):
        path = list(unloading_path(deepest, steps=steps, residual=1e-11))
        assert len(path) == steps + 1
        work = -integrate_curve(*curve(path))
        errors.append(abs(work / deepest.stored_energy - 1))
    assert errors[0] > errors[1] > errors[2]
    assert errors[2] < 2e-5


def test_steps_crowd_towards_separation(contact):
    deepest = solve(contact, DEPTH)
    depths, _ = curve(unloading_path(deepest, steps=4))
    part = (depths - depths[-1]) / (depths[0] - depths[-1])
    assert part == approx([1, 9 / 16, 4 / 16, 1 / 16, 0], abs=1e-12)


def test_an_elastic_path_returns_to_the_first_touch_with_nothing_left(pair, rough_contact):
    contact = Contact(pair, rough_contact().surface)
    deepest = solve(contact, DEPTH)
    path = list(unloading_path(deepest, steps=8))
    assert path[-1].indentation == 0
    loaded = [solve(contact, s.indentation).force for s in path[:-1]]
    assert [s.force for s in path[:-1]] == approx(loaded, rel=1e-6)
    assert_array_equal(path[-1].plastic_displacement, np.zeros(contact.grid.nodes))


def test_a_state_on_another_grid_does_not_start_a_contact(rough_contact):
    coarse, fine = (rough_contact((24, 20), (h, h)) for h in (0.6e-6, 0.5e-6))
    state = solve(coarse, 20e-9)
    with pytest.raises(CaseError, match="another grid"):
        solve(fine, 30e-9, start=state)
    assert solve(coarse, 30e-9, start=state).force > state.force
