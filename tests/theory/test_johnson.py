import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.theory import FirstYield, Hertz, Johnson, ThorntonNing
from restitution.theory.johnson import COEFFICIENT
from tolerance import approx

R, E_STAR, MASS = 250e-6, 112e9, 2e-6
Y = 0.002 * E_STAR
LAW = Johnson(R, E_STAR, Y)
V_Y = FirstYield(R, E_STAR, 1.6 * Y).velocity(MASS)
DERIVED = math.sqrt(3 * math.pi**1.25 * 4**0.75 / 10) * 3**0.625


def test_the_formula_as_printed():
    V = 100 * V_Y
    e = 3.8 * (Y / E_STAR) ** 0.5 * (0.5 * MASS * V**2 / (Y * R**3)) ** -0.125
    assert_allclose(LAW.restitution(V, MASS), e, rtol=1e-13)


def test_the_printed_coefficient_rounds_up_the_one_derived():
    # plastic loading at p_d = 3Y with δ = a²/2R*, elastic unloading of that contact
    a = 0.05 * R
    p_d = 3 * Y
    F = math.pi * a**2 * p_d
    W = math.pi * p_d * a**4 / (4 * R)
    R_p = 4 * E_STAR * a**3 / (3 * F)  # radius of the Hertz sphere with this contact at this force
    W_u = Hertz(R_p, E_STAR).stored_energy(a**2 / R_p)
    assert_allclose(W_u, 0.3 * F**2 / (E_STAR * a), rtol=1e-13)
    V = (2 * W / MASS) ** 0.5
    e = LAW.restitution(V, MASS)
    assert_allclose((W_u / W) ** 0.5 / e, DERIVED / COEFFICIENT, rtol=1e-12)
    assert round(DERIVED, 2) == 3.74


@given(st.floats(30.0, 1e4), st.floats(1.0, 1e3))
def test_fast_impacts_follow_the_minus_quarter_power(v, ratio):
    e = LAW.restitution(np.array([1, ratio]) * v * V_Y, MASS)
    assert_allclose(e[1] / e[0], ratio**-0.25, rtol=1e-12)


def test_it_is_thornton_and_ning_where_the_contact_spreads_twice_as_far():
    # a² = 2R*δ here and R*δ there: at equal pressure e differs by 2^{3/8}
    V = 1e8 * V_Y
    other = ThorntonNing(R, E_STAR, 3 * Y).restitution(V, MASS)
    e = LAW.restitution(V, MASS) * DERIVED / COEFFICIENT
    assert_allclose(e / other, 2**0.375, rtol=1e-6)


@given(st.floats(0.01, 1.0))
def test_velocity_and_restitution_are_inverse(e):
    V = LAW.velocity_at_restitution(e, MASS)
    assert_allclose(LAW.restitution(V, MASS), e, rtol=1e-13)


def test_the_contact_is_as_wide_as_the_sphere_where_the_work_is_that_of_full_flow():
    V = LAW.velocity_at_full_radius(MASS)
    assert_allclose(0.5 * MASS * V**2, math.pi * 3 * Y * R**4 / (4 * R), rtol=1e-13)


def test_it_is_held_at_one_below_its_range():
    unity = V_Y * COEFFICIENT**4 / (math.pi**5 / 60 * 1.6**5) ** 0.5
    assert unity / V_Y == approx(28.5, abs=0.05)
    v = np.array([-1.0, 0.0, 1e-9, 0.999, 1.0])
    assert np.all(LAW.restitution(v * unity, MASS) == approx(1, rel=1e-12))
    assert LAW.restitution(1.01 * unity, MASS) < 1


@pytest.mark.parametrize("yield_strain", [1e-4, 1e-3, 1e-2])
def test_its_range_begins_at_one_restitution_and_one_velocity_ratio(yield_strain):
    strength = yield_strain * E_STAR
    a = 30 * strength * R / E_STAR
    W = math.pi * 3 * strength * a**4 / (4 * R)
    V = (2 * W / MASS) ** 0.5
    e = Johnson(R, E_STAR, strength).restitution(V, MASS)
    assert e == approx(0.62, abs=0.01)
    V_y = FirstYield(R, E_STAR, 1.6 * strength).velocity(MASS)
    assert V / V_y == approx(190, rel=0.01)
