"""The way back to separation: where it ends, and what is said when it does not."""

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, smooth, solve
from restitution.contact import separation
from restitution.errors import NotConvergedError

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)


@pytest.fixture(scope="module")
def pressed():
    grid = Grid((31, 31), (0.15e-6, 0.15e-6))
    contact = Contact(Pair(STEEL, STEEL), smooth(grid), work_of_adhesion=0.09, approach="hertzian")
    return solve(contact, 3e-9)


def test_the_way_back_ends_without_contact(pressed):
    path = list(separation.separate(pressed))
    assert path[0] is pressed
    assert path[-1].contact_nodes == 0
    assert all(state.contact_nodes for state in path[:-1])
    assert all(np.diff([state.indentation for state in path]) < 0)


def test_bodies_that_do_not_part_are_said_so(pressed, monkeypatch):
    monkeypatch.setattr(separation, "_MOST_STEPS", 3)
    with pytest.raises(NotConvergedError, match="have not separated after 3 steps") as refusal:
        list(separation.separate(pressed))
    assert "check work_of_adhesion, 0.09 J/m2" in str(refusal.value)


def test_a_smaller_error_takes_more_steps(pressed):
    steps = [
        separation.separation_of(list(separation.separate(pressed, tolerance=tolerance))).steps
        for tolerance in (0.05, 0.002)
    ]
    assert steps[1] > steps[0]
