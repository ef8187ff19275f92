import math
from dataclasses import FrozenInstanceError, replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from restitution.contact.loading import solve, step
from restitution.contact.state import State
from tolerance import approx

P_Y = 750e6
DEPTH = 40e-9


@pytest.fixture(scope="module")
def state(rough_contact):
    return solve(rough_contact(yield_pressure=P_Y), DEPTH)


def test_the_integral_quantities_are_sums_over_the_whole_grid(state, dense):
    contact, p = state.contact, state.pressure
    hx, hy = contact.grid.spacing
    assert state.force == approx(p.sum() * hx * hy, rel=1e-12)
    assert state.contact_nodes == (p > 0).sum()
    assert state.contact_area == approx((p > 0).sum() * hx * hy, rel=1e-12)
    assert state.plastic_volume == approx(state.plastic_displacement.sum() * hx * hy, rel=1e-12)
    K = dense.influence(contact.grid, contact.pair.contact_modulus)
    energy = 0.5 * p.ravel() @ K @ p.ravel() * hx * hy
    assert state.stored_energy == approx(energy, rel=1e-10)
    assert state.loading_work == approx(energy + P_Y * state.plastic_volume, rel=1e-10)


def test_the_displacement_closes_the_gap_between_the_bounds(state):
    p, box = state.pressure[state.box], state.box
    sticking = (p > 0) & (p < P_Y)
    assert sticking.any()
    closed = state.box_displacement + state.contact.gap[box] + state.plastic_displacement[box]
    assert np.abs(closed - DEPTH)[sticking].max() <= 1e-8 * DEPTH
    assert np.abs(closed - DEPTH)[p >= P_Y].max() <= 1e-8 * DEPTH
    assert (closed >= DEPTH * (1 - 1e-8)).all()


def test_a_state_is_frozen(state):
    with pytest.raises(FrozenInstanceError):
        state.indentation = 0.0


def with_pressure(state, rows):
    """A state whose pressure is 1 Pa where `rows` shows an x."""
    mask = np.array([[mark == "x" for mark in row] for row in rows])
    box = slice(2, 2 + mask.shape[0]), slice(3, 3 + mask.shape[1])
    return replace(state, box_pressure=1.0 * mask, box=box)


@pytest.mark.parametrize(
    ("rows", "sizes"),
    [
        (["xx.", "x.x", ".xx"], [3, 3]),  # corners do not join
        (["xxx", "..x", "xxx"], [7]),
        (["x.x", "...", "x.x"], [1, 1, 1, 1]),
        (["x..xx", "xx.xx", "x...."], [4, 4]),
        (["x....", "..xxx", "..x.."], [4, 1]),
        (["..."], []),
    ],
)
def test_patches_are_joined_by_edges_and_sorted(state, rows, sizes):
    assert_array_equal(with_pressure(state, rows).patch_sizes(), sizes)


def test_the_patches_hold_every_node_in_contact(state):
    sizes = state.patch_sizes()
    assert sizes.sum() == state.contact_nodes
    assert (np.diff(sizes) <= 0).all()
    assert len(sizes) > 1


def test_bodies_apart_have_no_force_no_area_no_energy_and_no_patches(state):
    apart = step(state, 0.0)
    assert isinstance(apart, State)
    assert apart.force == apart.contact_area == apart.stored_energy == 0
    assert apart.patch_sizes().size == 0
    assert apart.loading_work == apart.plastic_work == state.plastic_work
    assert not math.isnan(apart.residual)
