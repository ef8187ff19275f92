import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad

from restitution.errors import CaseError
from restitution.theory import hertz, jackson_green, thornton_ning, yielding
from restitution.theory import jackson_green_marghitu as jgm

R, E_STAR, NU, MASS = 250e-6, 112e9, 0.32, 2e-6
Y = 0.002 * E_STAR
MATERIAL = (R, E_STAR, Y, NU)
V_C = jgm.critical_velocity(*MATERIAL, MASS)


def restitution(v):
    """e at V/V_c."""
    return jgm.restitution(np.asarray(v) * V_C, *MATERIAL, MASS)


def test_the_critical_velocity_carries_the_energy_at_first_yield():
    w_c = jackson_green.critical_indentation(*MATERIAL)
    assert_allclose(0.5 * MASS * V_C**2, hertz.stored_energy(w_c, R, E_STAR), rtol=1e-13)
    C = jackson_green.yield_coefficient(NU)
    assert_allclose(V_C, yielding.yield_velocity(R, E_STAR, C * Y, MASS), rtol=1e-13)


@pytest.mark.parametrize("v", [2.0, 10.0, 59.0])
def test_the_first_branch_as_printed(v):
    e = 1 - 0.1 * math.log(v) * ((v - 1) / 59) ** 0.156
    assert_allclose(restitution(v), e, rtol=1e-13)


@pytest.mark.parametrize("v", [61.0, 200.0, 999.0])
def test_the_second_branch_as_printed(v):
    e = 1 - 0.1 * math.log(60) - 0.11 * math.log(v / 60) * (v - 60) ** (2.36 * Y / E_STAR)
    assert_allclose(restitution(v), e, rtol=1e-13)


def test_the_branches_join():
    for joint in (1.0, 60.0):
        below, above = restitution(np.array([1 - 1e-9, 1 + 1e-9]) * joint)
        assert above == pytest.approx(below, abs=1e-8)


@pytest.mark.parametrize("yield_strain", [0.001, 0.002, 0.007])
@pytest.mark.parametrize("x", [2.0, 4.0, 10.0, 30.0, 100.0, 300.0])
def test_the_fit_is_that_of_the_static_finite_elements(yield_strain, x):
    # unloading: Hertz from the residual depth of Jackson, Chusoipin & Green (2005)
    material = R, E_STAR, yield_strain * E_STAR, NU
    w = x * jackson_green.critical_indentation(*material)
    F = jackson_green.loading_force(w, *material)
    W_l, _ = quad(
        lambda s: jackson_green.loading_force(s * w, *material) * w, 0, 1, points=[1.9 / x]
    )
    residual = 1.02 * (1 - ((x + 5.9) / 6.9) ** -0.54) * w
    W_u = 0.4 * F * (w - residual)
    e = jgm.restitution((2 * W_l / MASS) ** 0.5, *material, MASS)
    assert e == pytest.approx((W_u / W_l) ** 0.5, abs=0.02)


def test_where_fully_plastic_it_is_near_thornton_and_ning_at_the_hardness():
    v = np.array([60.0, 100.0, 300.0])
    other = thornton_ning.restitution(v * V_C, R, E_STAR, 2.8 * Y, MASS)
    assert_allclose(restitution(v), other, rtol=0.05)


@given(st.floats(1e-3, 999.0), st.floats(1e-3, 999.0))
def test_faster_means_less_returned(x, y):
    e = restitution(np.sort([x, y]))
    assert e[1] <= e[0] * (1 + 1e-15)


def test_there_is_no_answer_beyond_the_fit():
    assert_array_equal(restitution([-1.0, 0.0, 0.999]), 1)
    assert_array_equal(np.isnan(restitution([999.9, 1000.1, 1e6])), [False, True, True])
    strong = R, E_STAR, 0.1 * E_STAR, NU
    V_c = jgm.critical_velocity(*strong, MASS)
    assert_array_equal(np.isnan(jgm.restitution(np.array([60, 900]) * V_c, *strong, MASS)), [0, 1])


def test_an_unstable_solid_is_refused():
    with pytest.raises(CaseError, match=r"^poisson_ratio: "):
        jgm.restitution(1.0, R, E_STAR, Y, 0.6, MASS)
