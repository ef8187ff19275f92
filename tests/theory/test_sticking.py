import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.theory import jkr, sticking
from tolerance import approx

R, E_STAR, W, MASS = 250e-6, 112e9, 0.05, 2e-6
MATERIAL = (R, E_STAR, W)
V_S = sticking.sticking_velocity(*MATERIAL, MASS)


def test_the_sticking_velocity_carries_the_loss_of_one_cycle():
    assert_allclose(0.5 * MASS * V_S**2, jkr.hysteresis_loss(*MATERIAL), rtol=1e-14)


def test_the_exact_coefficient_rounds_to_the_published_one():
    coefficient = sticking.sticking_velocity(1.0, 1.0, 1.0, 1.0) ** 2
    assert round(float(coefficient), 2) == 14.18
    published = (14.18 / MASS) ** 0.5 * (W**5 * R**4 / E_STAR**2) ** (1 / 6)
    assert_allclose(V_S, published, rtol=2e-4)


@given(st.floats(1e-3, 1e4))
def test_the_loss_is_added(v):
    e = sticking.restitution(v * V_S, V_S)
    assert_allclose(e**2, max(0, 1 - 1 / v**2), rtol=1e-13, atol=1e-15)
    assert_allclose(jkr.restitution(v * V_S, *MATERIAL, MASS) ** 2, e**2, rtol=1e-12, atol=1e-14)


def test_sticking_ends_at_the_sticking_velocity():
    v = np.array([-1.0, 0.0, 1e-9, 0.5, 1.0, 1 + 1e-9, 1e9])
    e = sticking.restitution(v * V_S, V_S)
    assert_array_equal(e[:5], [1, 1, 0, 0, 0])
    assert e[5] == approx((2e-9) ** 0.5, rel=1e-6)
    assert e[6] == approx(1, abs=1e-15)


@given(*[st.floats(1e-3, 1e3)] * 4)
def test_the_powers_of_the_sticking_velocity(length, stress, adhesion, inertia):
    V = sticking.sticking_velocity(length * R, stress * E_STAR, adhesion * W, inertia * MASS)
    powers = adhesion ** (5 / 6) * length ** (2 / 3) * stress ** (-1 / 3) * inertia**-0.5
    assert_allclose(V / V_S, powers, rtol=1e-12)


def test_the_tabor_parameter_is_the_neck_over_the_range_of_the_forces():
    # R* = 8, w = E* = 1, z₀ = ½: (8/(1/8))^{1/3} = 4
    assert sticking.tabor_parameter(8.0, 1.0, 1.0, 0.5) == approx(4.0, rel=1e-14)
    z0 = 3e-10
    neck = -jkr.break_indentation(*MATERIAL) / (0.75 * np.pi ** (2 / 3))
    assert_allclose(sticking.tabor_parameter(*MATERIAL, z0), neck / z0, rtol=1e-13)
    # JKR's own pull-off indentation is of the order of the range where μ is of the order of one
    assert 0.5 < -jkr.pull_off_indentation(*MATERIAL) / neck < 1
