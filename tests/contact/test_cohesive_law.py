"""The law of the gap: its derivatives, and how it goes on beyond the largest pressure."""

import math

import numpy as np
import pytest

from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive.bounded_law import BoundedLaw
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.contact import Contact, smooth
from restitution.numerics.grid import Grid
from tolerance import approx

W, Z0 = 0.05, 0.3e-9
BODY = Body(1e-6, 2e11, 0.3)
LAW = Cohesive(W, Z0)
CONTACT = Contact(Pair(BODY, BODY), smooth(Grid(8, 1e-9)), adhesion=LAW)


@pytest.fixture(params=[math.inf, 2e9], ids=["elastic", "yields"])
def bounded(request):
    """A law at four nodes, and displacements that put two of them beyond its limit."""
    law = BoundedLaw(CONTACT, np.full(4, Z0), request.param)
    return law, law.least * np.array([0.9, 0.99, 1.01, 1.4]) - law.base


def test_the_pressure_at_the_limit_is_the_bound_or_the_modulus(bounded):
    law, _ = bounded
    largest = 2e9 if law.yields else CONTACT.pair.contact_modulus
    assert float(LAW.traction(law.least)) == approx(-largest)


def test_slope_and_curvature_are_derivatives_of_the_energy(bounded):
    law, u = bounded
    step = 1e-5 * Z0
    (low, low_slope, _), (high, high_slope, _) = law(u - step), law(u + step)
    _, slope, curvature = law(u)
    assert slope == approx((high - low) / (2 * step), rel=1e-5)
    assert curvature == approx((high_slope - low_slope) / (2 * step), rel=1e-5)


def test_what_goes_beyond_the_limit_is_plastic_or_the_energy_of_the_continuation(bounded):
    law, u = bounded
    gap = law.base + u
    assert law.beyond(u) == approx(np.array([0.1, 0.01, 0, 0]) * law.least, rel=1e-9)
    rest = law(u)[0] - LAW.energy(np.maximum(gap, law.least))
    assert rest[:2] == approx(law.continuation(u)[:2], rel=1e-9)
    assert law.continuation(u)[2:].tolist() == [0, 0]


def test_the_stiffness_is_the_slope_of_the_traction():
    gap, step = Z0 * np.array([0.9, 1.0, 1.3, 2.0]), 1e-5 * Z0
    low, high = (LAW.traction(gap + sign * step) for sign in (-1, 1))
    assert LAW.stiffness(gap) == approx((high - low) / (2 * step), rel=1e-6)


def test_the_largest_softening_is_that_of_all_wider_gaps():
    for smallest in Z0 * np.array([0.8, 1.3, 1.6, 3.0]):
        gaps = smallest * np.linspace(1, 5, 20001)
        softest = -LAW.stiffness(gaps).min()
        assert LAW.largest_softening(smallest) == approx(softest)
