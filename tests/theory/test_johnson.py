import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.theory import hertz, johnson, thornton_ning, yielding
from tolerance import approx

R, E_STAR, MASS = 250e-6, 112e9, 2e-6
Y = 0.002 * E_STAR
MATERIAL = (R, E_STAR, Y, MASS)
V_Y = yielding.yield_velocity(R, E_STAR, 1.6 * Y, MASS)
DERIVED = math.sqrt(3 * math.pi**1.25 * 4**0.75 / 10) * 3**0.625


def test_the_formula_as_printed():
    V = 100 * V_Y
    e = 3.8 * (Y / E_STAR) ** 0.5 * (0.5 * MASS * V**2 / (Y * R**3)) ** -0.125
    assert_allclose(johnson.restitution(V, *MATERIAL), e, rtol=1e-13)


def test_the_printed_coefficient_rounds_up_the_one_derived():
    # plastic loading at p_d = 3Y with δ = a²/2R*, elastic unloading of that contact
    a = 0.05 * R
    p_d = 3 * Y
    F = math.pi * a**2 * p_d
    W = math.pi * p_d * a**4 / (4 * R)
    R_p = 4 * E_STAR * a**3 / (3 * F)  # Hertz's sphere with this contact at this force
    W_u = hertz.stored_energy(a**2 / R_p, R_p, E_STAR)
    assert_allclose(W_u, 0.3 * F**2 / (E_STAR * a), rtol=1e-13)
    V = (2 * W / MASS) ** 0.5
    e = johnson.restitution(V, *MATERIAL)
    assert_allclose((W_u / W) ** 0.5 / e, DERIVED / johnson.COEFFICIENT, rtol=1e-12)
    assert round(DERIVED, 2) == 3.74


@given(st.floats(30.0, 1e4), st.floats(1.0, 1e3))
def test_fast_impacts_follow_the_minus_quarter_power(v, ratio):
    e = johnson.restitution(np.array([1, ratio]) * v * V_Y, *MATERIAL)
    assert_allclose(e[1] / e[0], ratio**-0.25, rtol=1e-12)


def test_it_is_thornton_and_ning_where_the_contact_spreads_twice_as_far():
    # a² = 2R*δ here and R*δ there: at equal pressure e differs by 2^{3/8}
    V = 1e8 * V_Y
    other = thornton_ning.restitution(V, R, E_STAR, 3 * Y, MASS)
    e = johnson.restitution(V, *MATERIAL) * DERIVED / johnson.COEFFICIENT
    assert_allclose(e / other, 2**0.375, rtol=1e-6)


def test_it_is_held_at_one_below_its_range():
    unity = V_Y * johnson.COEFFICIENT**4 / (math.pi**5 / 60 * 1.6**5) ** 0.5
    assert unity / V_Y == approx(28.5, abs=0.05)
    v = np.array([-1.0, 0.0, 1e-9, 0.999, 1.0])
    assert np.all(johnson.restitution(v * unity, *MATERIAL) == approx(1, rel=1e-12))
    assert johnson.restitution(1.01 * unity, *MATERIAL) < 1


@pytest.mark.parametrize("yield_strain", [1e-4, 1e-3, 1e-2])
def test_its_range_begins_at_one_restitution_and_one_velocity_ratio(yield_strain):
    strength = yield_strain * E_STAR
    a = 30 * strength * R / E_STAR
    W = math.pi * 3 * strength * a**4 / (4 * R)
    V = (2 * W / MASS) ** 0.5
    e = johnson.restitution(V, R, E_STAR, strength, MASS)
    assert e == approx(0.62, abs=0.01)
    V_y = yielding.yield_velocity(R, E_STAR, 1.6 * strength, MASS)
    assert V / V_y == approx(190, rel=0.01)
