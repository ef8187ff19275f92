"""The error of the pull-off force: steps, and the range that the JKR limit neglects."""

import math

import pytest

from restitution import Body, Contact, Grid, Pair, smooth, solve
from restitution.contact.checks.model_error import pull_off_error
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.jkr.limit import JKRLimit
from tolerance import approx

SPHERE = Body(radius=5e-6, youngs_modulus=70e9, poissons_ratio=0.2)


@pytest.mark.parametrize(("z0", "least", "most"), [(0.3e-9, 0.15, 0.33), (3e-12, 0.02, 0.03)])
def test_a_hard_sphere_pulls_more_than_in_the_jkr_limit(z0, least, most):
    """Pull-off is 1.5 πwR in the limit of JKR and 2 πwR of rigid spheres: a third more."""
    contact = Contact(
        Pair(SPHERE, SPHERE),
        smooth(Grid(64, 6e-9)),
        adhesion=JKRLimit(0.05, equilibrium_separation=z0),
    )
    assert least < pull_off_error(solve(contact, 1e-9), 1.0) < most


def test_an_attraction_of_finite_range_leaves_the_steps():
    contact = Contact(Pair(SPHERE, SPHERE), smooth(Grid(64, 6e-9)), adhesion=Cohesive(0.05))
    state = solve(contact, 1e-9)
    assert pull_off_error(state, 3e-7) == approx(0.02 * 3e-7)
    assert math.isnan(pull_off_error(state, math.nan))


def test_without_adhesion_there_is_none():
    contact = Contact(Pair(SPHERE, SPHERE), smooth(Grid(64, 20e-9)))
    assert pull_off_error(solve(contact, 1e-9), 0.0) == 0
