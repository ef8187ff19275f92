"""Unloading guided by the states of another unloading of the same bodies."""

from dataclasses import replace

import numpy as np
import pytest

from restitution.collision import collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive.guide import Guide
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.bound import ConstantBound
from restitution.numerics.grid import Grid
from restitution.surfaces import generate_surface
from tolerance import approx


@pytest.fixture(scope="module")
def unloaded():
    """A yielding rough contact, loaded to two depths, and the unloading from the shallower."""
    body = Body(radius=5e-6, youngs_modulus=70e9, poissons_ratio=0.17)
    surface = generate_surface(
        Grid(96, 4e-9), kind="gaussian", rms=1e-9, correlation_length=60e-9, seed=1
    )
    contact = Contact(
        Pair(body, body), surface, plasticity=ConstantBound(2e9), adhesion=Cohesive(0.05)
    )
    shallow = solve(contact, 3e-9)
    deep = solve(contact, 4e-9, start=shallow)
    return deep, list(unloading_path(shallow))


def test_a_guide_saves_work_and_changes_nothing(unloaded):
    deep, known = unloaded
    alone = list(unloading_path(deep))
    guided = list(unloading_path(deep, known=known))
    a, b = (collide(deep, path) for path in (alone, guided))
    assert b.unloading_work == approx(a.unloading_work, rel=5e-4)
    assert b.pull_off_force == approx(a.pull_off_force, rel=2e-3)
    pressed = [[s.convolutions for s in path[1:] if s.force > 0] for path in (alone, guided)]
    assert sum(pressed[1]) < 0.9 * sum(pressed[0])
    stops = {state.indentation for state in known}
    assert len([state for state in guided if state.indentation in stops]) > 3


def test_the_change_along_a_guide_is_that_between_its_states(unloaded):
    _, known = unloaded
    guide = Guide(known)
    a, b = known[1], known[3]
    change = guide.change(a.indentation, b.indentation, a.box)
    assert np.allclose(change, b.box_pressure - a.box_pressure, rtol=1e-12, atol=0)
    middle = 0.5 * (known[2].indentation + known[3].indentation)
    half = guide.change(a.indentation, middle, a.box)
    expected = 0.5 * (known[2].box_pressure + known[3].box_pressure) - a.box_pressure
    assert np.allclose(half, expected, rtol=1e-9, atol=1e-9 * abs(expected).max())


def test_a_guide_that_jumps_or_ends_predicts_nothing(unloaded):
    deep, known = unloaded
    guide = Guide(known)
    a, b = known[1], known[2]
    assert guide.change(1.1 * known[0].indentation, b.indentation, b.box) is None
    jumped = Guide([*known[:2], replace(b, jumps=b.jumps + 1), *known[3:]])
    assert jumped.change(a.indentation, b.indentation, b.box) is None
    assert Guide.of([deep], deep).path
    assert not Guide.of([], deep).path


def test_a_step_ends_at_a_state_of_the_guide_that_is_near(unloaded):
    _, known = unloaded
    guide = Guide(known)
    begin, goal = known[0].indentation, known[1].indentation
    assert guide.stop(begin, begin + 1.05 * (goal - begin)) == goal
    assert guide.stop(begin, begin + 0.2 * (goal - begin)) == begin + 0.2 * (goal - begin)
