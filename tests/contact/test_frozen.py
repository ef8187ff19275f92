"""Surfaces, contacts and states are immutable."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from contact_keys import contact_of
from restitution import Contact, Grid, Surface, smooth, solve, step, unloading_path
from restitution.contact.plasticity.bound import ConstantBound

GRID = Grid((24, 24), (0.5e-6, 0.5e-6))
DEPTH = 40e-9
MODELS = {
    "elastic": {},
    "equilibrium": {"yield_pressure": 750e6},
    "expanding-cavity": {"yield_strength": 300e6},
    "truncated": {"yield_pressure": 750e6, "plasticity": "truncated"},
    "adhesive": {"yield_pressure": 750e6, "work_of_adhesion": 0.5},
}


def arrays_of(state):
    named = (state.box_pressure, state.box_displacement, state.plastic_displacement, state.bound)
    return [values for values in named if isinstance(values, np.ndarray)]


def test_a_surface_is_not_changed_through_the_array_it_was_given():
    height = np.zeros(GRID.nodes)
    surface = Surface(height, GRID)
    height[3, 4] = 1e-6  # the caller can still write to it
    assert not surface.height.any()
    with pytest.raises(ValueError, match="read-only"):
        surface.height[3, 4] = 1e-6


def test_a_surface_is_not_changed_through_its_provenance():
    provenance = {"source": "smooth"}
    surface = Surface(np.zeros(GRID.nodes), GRID, provenance)
    provenance["source"] = "measured"
    assert surface.provenance == {"source": "smooth"}


def test_a_surface_made_from_another_shares_its_heights():
    surface = smooth(GRID)
    assert replace(surface, provenance={}).height is surface.height


def test_what_a_contact_keeps_is_read_only(rough_contact):
    contact = rough_contact()
    for values in (contact.gap, contact.elongation, contact.surface.height):
        with pytest.raises(ValueError, match="read-only"):
            values += 1.0


@pytest.mark.parametrize("model", MODELS)
def test_the_arrays_of_a_state_are_read_only(pair, model):
    deepest = solve(contact_of(pair, smooth(GRID), **MODELS[model]), DEPTH)
    states = [deepest, *unloading_path(deepest, steps=2)]
    if model != "truncated":
        states.append(step(deepest, 1.1 * DEPTH))
    for state in states:
        for values in arrays_of(state):
            with pytest.raises(ValueError, match="read-only"):
                values[...] = 1.0


@pytest.mark.parametrize("model", MODELS)
def test_a_solve_does_not_change_the_state_it_starts_from(pair, model):
    contact = contact_of(pair, smooth(GRID), **MODELS[model])
    start = solve(contact, 0.5 * DEPTH)
    before = [values.copy() for values in arrays_of(start)]
    solve(contact, DEPTH, start=start)
    step(start, 0.4 * DEPTH)
    for values, same in zip(arrays_of(start), before, strict=True):
        assert_array_equal(values, same)


def test_a_state_is_not_changed_through_an_array_it_was_given(pair):
    state = solve(Contact(pair, smooth(GRID)), DEPTH)
    pressure = 2 * state.box_pressure
    other = replace(state, box_pressure=pressure)
    pressure[...] = 0.0
    assert other.force > 1.9 * state.force


def test_surfaces_and_states_are_equal_by_identity(pair):
    surface = smooth(GRID)
    assert surface == surface
    assert surface != smooth(GRID)
    state = solve(Contact(pair, surface), DEPTH)
    assert state == state
    assert state != replace(state)
    assert len({surface, smooth(GRID), state, replace(state)}) == 4


def test_contacts_are_equal_by_value_on_one_surface(pair):
    surface = smooth(GRID)
    contact, same = (
        Contact(pair, surface, plasticity=ConstantBound(750e6)),
        Contact(pair, surface, plasticity=ConstantBound(750e6)),
    )
    assert contact == same
    assert hash(contact) == hash(same)
    assert contact != Contact(pair, surface, plasticity=ConstantBound(751e6))
    assert contact != Contact(pair, smooth(GRID), plasticity=ConstantBound(750e6))
