import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.theory import JKR, AdhesiveThorntonNing, FirstYield, ThorntonNing
from tolerance import approx

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
SHARP = (R, E_STAR, P_Y)
V_Y = FirstYield(*SHARP).velocity(MASS)


def adhesion(ratio):
    """Work of adhesion for V_s/V_y = `ratio`; V_s grows as w^{5/6}."""
    return (ratio * V_Y / JKR(R, E_STAR, 1.0).sticking_velocity(MASS)) ** 1.2


def restitution(v, ratio):
    """Coefficient of restitution at given V/V_y and V_s/V_y."""
    return AdhesiveThorntonNing(R, E_STAR, P_Y, adhesion(ratio)).restitution(v * V_Y, MASS)


@given(st.floats(1.0 + 1e-9, 1e3), st.floats(1e-4, 0.999))
def test_the_losses_are_added_beyond_yield(v, ratio):
    e_p = ThorntonNing(*SHARP).restitution(v * V_Y, MASS)
    assert_allclose(restitution(v, ratio) ** 2, e_p**2 - (ratio / v) ** 2, rtol=1e-11, atol=1e-14)


@given(st.floats(1e-3, 1.0 - 1e-9), st.floats(1e-4, 10.0))
def test_below_yield_it_is_elastic_and_adhesive(v, ratio):
    w = adhesion(ratio)
    e = JKR(R, E_STAR, w).restitution(v * V_Y, MASS)
    assert_allclose(restitution(v, ratio) ** 2, e**2, rtol=1e-11, atol=1e-13)
    if v < 0.999 * ratio:
        assert restitution(v, ratio) == 0


@pytest.mark.parametrize("ratio", [0.01, 0.1, 0.5, 0.99])
def test_restitution_rises_from_sticking_to_a_peak_beyond_yield_and_falls(ratio):
    v = np.concatenate([np.linspace(ratio, 1, 100), np.geomspace(1.0001, 1e3, 400)])
    e = restitution(v, ratio)
    assert e[0] == approx(0, abs=1e-6)
    peak = np.argmax(e)
    assert v[peak] > 1
    assert np.all(np.diff(e[: peak + 1]) > 0)
    assert np.all(np.diff(e[peak:]) < 0)
    at_yield = restitution(np.array([1 - 1e-9, 1 + 1e-9]), ratio)
    assert_allclose(at_yield[1], at_yield[0], rtol=1e-6)


def test_without_adhesion_it_is_thornton_and_ning():
    v = np.array([0.5, 1.0, 2.0, 10.0])
    expected = ThorntonNing(*SHARP).restitution(v * V_Y, MASS)
    assert_allclose(restitution(v, 1e-9), expected, rtol=1e-14)


def test_a_pair_that_sticks_beyond_yield_has_no_answer_there():
    v = np.array([-1.0, 0.0, 0.5, 1 - 1e-9, 1 + 1e-9, 2.0, 1e3])
    assert_array_equal(restitution(v, 1.01), [1, 1, 0, 0, np.nan, np.nan, np.nan])
    assert np.all(np.isfinite(restitution(v, 0.99)))


def test_ammonium_fluorescein_is_such_a_pair():
    R, density, E, nu, w, p_y = 2.45e-6, 1350.0, 1.2e9, 0.3, 0.2, 35.3e6
    E_star = 1 / ((1 - nu**2) / E + (1 - nu**2) / 182e9)
    mass = 4 / 3 * np.pi * R**3 * density
    V_s = JKR(R, E_star, w).sticking_velocity(mass)
    V_y = FirstYield(R, E_star, p_y).velocity(mass)
    assert round(float(V_s), 3) == 0.567
    assert round(float(V_y), 3) == 0.183
    V = np.array([0.1, 0.183, 0.184, V_s, 1.6, 10.0])
    e = AdhesiveThorntonNing(R, E_star, p_y, w).restitution(V, mass)
    assert_array_equal(e, [0, 0, np.nan, np.nan, np.nan, np.nan])
    assert JKR(R, E_star, w).tabor_parameter(3e-10) > 5  # JKR is valid, additivity is not
    # an array of works of adhesion may lie on both sides of the limit
    e = AdhesiveThorntonNing(R, E_star, p_y, np.array([1e-3, 0.2])).restitution(1.0, mass)
    assert_array_equal(np.isnan(e), [False, True])
