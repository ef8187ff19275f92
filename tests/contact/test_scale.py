"""Restitution depends only on ratios of lengths and of pressures."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.collision import collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.loading import solve
from restitution.contact.prescribed.force import solve_at_force
from tolerance import approx


def scaled(rough_contact, length, stiffness, p_y, plasticity="equilibrium"):
    """The same contact with every length and every pressure multiplied."""
    sphere = Body(500e-6 * length, 210e9 * stiffness, 0.25, density=7850.0)
    return rough_contact(
        spacing=(0.5e-6 * length, 0.6e-6 * length),
        rms=10e-9 * length,
        pair=Pair(sphere, sphere),
        yield_pressure=p_y * stiffness,
        plasticity=plasticity,
    )


@settings(deadline=None, max_examples=15)
@given(
    st.floats(-4, 9), st.floats(-9, 3), st.sampled_from([2e8, 750e6, 2e9]), st.floats(10e-9, 60e-9)
)
def test_lengths_and_pressures_scale_out(rough_contact, s, t, p_y, depth):
    """The spacings are 50 pm to 500 m, the moduli 100 Pa to 100 TPa."""
    length, stiffness = 10.0**s, 10.0**t
    a = solve(scaled(rough_contact, 1, 1, p_y), depth, residual=1e-11)
    b = solve(scaled(rough_contact, length, stiffness, p_y), depth * length, residual=1e-11)
    assert collide(b).restitution == approx(collide(a).restitution, rel=1e-8)
    assert b.force == approx(a.force * stiffness * length**2, rel=1e-8)
    assert b.loading_work == approx(a.loading_work * stiffness * length**3, rel=1e-8)
    assert b.contact_nodes == a.contact_nodes
    assert_allclose(b.pressure / stiffness, a.pressure, atol=1e-7 * p_y)
    # m* scales with the volume, so the velocity scales with sqrt(pressure/density)
    assert collide(b).impact_velocity == approx(
        collide(a).impact_velocity * math.sqrt(stiffness), rel=1e-8
    )


@pytest.mark.parametrize(("length", "stiffness"), [(1e-3, 1e-6), (1e6, 1e3)])
def test_a_truncated_contact_has_no_scale_either(rough_contact, length, stiffness):
    a = solve(scaled(rough_contact, 1, 1, 750e6, "truncated"), 30e-9, residual=1e-10)
    b = solve(
        scaled(rough_contact, length, stiffness, 750e6, "truncated"), 30e-9 * length, residual=1e-10
    )
    assert collide(b).restitution == approx(collide(a).restitution, rel=1e-6)


@pytest.mark.parametrize(("length", "stiffness"), [(1e-3, 1e-6), (1e6, 1e3)])
def test_the_depth_under_a_force_scales_as_a_length(rough_contact, length, stiffness):
    a = solve_at_force(scaled(rough_contact, 1, 1, 750e6), 5e-3)
    b = solve_at_force(
        scaled(rough_contact, length, stiffness, 750e6), 5e-3 * stiffness * length**2
    )
    assert b.indentation == approx(a.indentation * length, rel=1e-7)
