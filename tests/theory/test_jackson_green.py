import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.theory import Hertz, JacksonGreen, yield_coefficient
from restitution.theory.jackson_green import TRANSITION
from tolerance import approx

R, E_STAR, NU = 250e-6, 112e9, 0.32
Y = 0.002 * E_STAR
LAW, HERTZ = JacksonGreen(R, E_STAR, Y, NU), Hertz(R, E_STAR)
W_C = LAW.first_yield.indentation
P_C = LAW.first_yield.force


@pytest.mark.parametrize("nu", [0.0, 0.1, 0.25, 0.32, 0.4, 0.5])
def test_the_yield_coefficient_is_where_von_mises_first_yields_below_a_hertz_contact(nu):
    # stresses on the axis at depth za, over p₀ (Johnson 1985, eq. 3.45)
    z = np.linspace(0.05, 3, 10_001)
    axial = -1 / (1 + z**2)
    radial = -(1 + nu) * (1 - z * np.arctan(1 / z)) + 0.5 / (1 + z**2)
    exact = 1 / np.max(np.abs(axial - radial))
    assert_allclose(yield_coefficient(nu), exact, rtol=5e-3)


def test_the_critical_point_lies_on_the_hertz_curves():
    assert_allclose(HERTZ.peak_pressure(W_C), yield_coefficient(NU) * Y, rtol=1e-14)
    assert_allclose(HERTZ.force(W_C), P_C, rtol=1e-14)
    published = 4 / 3 * (R / E_STAR) ** 2 * (0.5 * np.pi * yield_coefficient(NU) * Y) ** 3
    assert_allclose(P_C, published, rtol=1e-14)


def test_the_fit_is_hertz_up_to_its_transition():
    w = np.array([0.1, 1.0, 1.5, 1.899999]) * W_C
    assert_allclose(LAW.loading_force(w), HERTZ.force(w), rtol=1e-13)
    assert_allclose(LAW.contact_area(w), HERTZ.contact_area(w), rtol=1e-14)
    assert_allclose(LAW.contact_radius(w), HERTZ.contact_radius(w), rtol=1e-14)


@pytest.mark.parametrize("x", [2.0, 10.0, 110.0])
def test_the_plastic_branch_as_printed(x):
    C = 1.295 * math.exp(0.736 * NU)
    B = 0.14 * math.exp(23 * Y / E_STAR)
    a = math.sqrt(R * x * W_C) * (x / 1.9) ** (B / 2)
    H_G = 2.84 * Y * (1 - math.exp(-0.82 * (a / R) ** -0.7))
    P = math.exp(-0.25 * x ** (5 / 12)) * x**1.5
    P += 4 * H_G / (C * Y) * (1 - math.exp(-(x ** (5 / 9)) / 25)) * x
    assert_allclose(LAW.contact_radius(x * W_C), a, rtol=1e-12)
    assert_allclose(LAW.hardness(a), H_G, rtol=1e-12)
    assert_allclose(LAW.loading_force(x * W_C), P * P_C, rtol=1e-12)


@pytest.mark.parametrize(
    ("nu", "step", "tolerance"),
    [(0.0, 0.075, 1e-3), (0.25, 0.015, 1e-3), (0.32, 0.0, 1e-3), (0.5, -0.034, 1e-3)],
)
def test_the_step_between_the_branches_is_the_documented_one(nu, step, tolerance):
    law = JacksonGreen(R, E_STAR, Y, nu)
    w = TRANSITION * law.first_yield.indentation
    below, above = law.loading_force(w * np.array([1 - 1e-9, 1 + 1e-9]))
    assert above / below - 1 == approx(step, abs=tolerance)
    area = law.contact_area(w * np.array([1 - 1e-9, 1 + 1e-9]))
    assert_allclose(area[1], area[0], rtol=1e-8)


def test_yielding_carries_less_than_hertz_on_a_larger_contact():
    w = np.geomspace(2, 110, 50) * W_C
    assert np.all(LAW.loading_force(w) < HERTZ.force(w))
    assert np.all(LAW.contact_area(w) > HERTZ.contact_area(w))
    assert np.all(np.diff(LAW.loading_force(w)) > 0)


def test_the_mean_pressure_rises_towards_the_hardness():
    w = np.geomspace(2, 2000, 50) * W_C
    a = LAW.contact_radius(w)
    mean = LAW.loading_force(w) / LAW.contact_area(w)
    ratio = mean / LAW.hardness(a)
    assert ratio[0] < 0.6
    assert 0.9 < np.max(ratio) < 1.02


def test_hardness_falls_from_that_of_a_flat_punch_as_the_contact_grows():
    H = LAW.hardness(np.array([1e-4, 0.1, 0.2, 0.4]) * R) / Y
    assert H[0] == approx(2.84, abs=1e-6)
    assert np.all(np.diff(H) < 0)


@given(st.floats(1e-2, 100.0), st.floats(1e-3, 1e3), st.floats(1e-3, 1e3))
def test_lengths_and_stresses_set_the_scales(x, length, stress):
    other = JacksonGreen(length * R, stress * E_STAR, stress * Y, NU)
    assert_allclose(
        other.loading_force(x * length * W_C),
        length**2 * stress * LAW.loading_force(x * W_C),
        rtol=1e-10 if abs(x - TRANSITION) > 1e-9 else 0.01,
    )
