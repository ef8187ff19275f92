import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad

from restitution.errors import CaseError
from restitution.theory import Luding, WaltonBraun
from tolerance import approx

R, K1, K2, K_C, PHI, MASS = 250e-6, 1e5, 5e5, 2e5, 0.05, 2e-6
STICKY, DRY = Luding(R, K1, K2, K_C, PHI), Luding(R, K1, K2, 0.0, PHI)
LIMIT = STICKY.limit_indentation
V_LIMIT = LIMIT * (K1 / MASS) ** 0.5
depths = st.floats(1e-3, 1e2).map(lambda x: x * LIMIT)
stiffnesses = st.floats(0.0, 1e7)


def test_a_value_worked_out_by_hand():
    # k₁ = 1, k̂₂ = 2, φ_f = 1, R* = ½: δ* = 2, δ₀* = 1. At δ = 1: k₂ = 1.5, δ₀ = ⅓, W_l = ½
    law = Luding(0.5, 1.0, 2.0, 1.5, 1.0)
    assert law.limit_indentation == approx(2.0, rel=1e-15)
    assert law.residual_indentation(1.0) == approx(1 / 3, rel=1e-15)
    # k_c = 1.5: δ_min = 1/6, F_c = ¼, W_u = ½·1.5·4/9 − ½·¼·⅓ = 7/24
    assert law.pull_off_force(1.0) == approx(0.25, rel=1e-14)
    assert law.unloading_work(1.0) == approx(7 / 24, rel=1e-14)
    assert law.restitution(1.0, 1.0) ** 2 == approx(7 / 12, rel=1e-14)


def test_the_limit_scales_with_the_reduced_diameter_of_the_pair():
    # Luding's eq. 7: δ* = k̂₂/(k̂₂ − k₁) φ_f 2a₁a₂/(a₁ + a₂)
    a1, a2 = 200e-6, 700e-6
    published = K2 / (K2 - K1) * PHI * 2 * a1 * a2 / (a1 + a2)
    ours = Luding(1 / (1 / a1 + 1 / a2), K1, K2, K_C, PHI).limit_indentation
    assert_allclose(ours, published, rtol=1e-14)


def test_loading_follows_the_plastic_branch_up_to_the_limit_and_the_elastic_one_beyond():
    d = np.array([0.1, 0.5, 1.0]) * LIMIT
    assert_allclose(STICKY.loading_force(d), K1 * d, rtol=1e-14)
    d = np.array([1.0, 1.5, 10.0]) * LIMIT
    line = K2 * (d - PHI * 2 * R)
    assert_allclose(STICKY.loading_force(d), line, rtol=1e-14)


@given(depths, stiffnesses)
def test_unloading_starts_at_the_loading_force_and_ends_at_zero(d, k_c):
    law = Luding(R, K1, K2, k_c, PHI)
    d0 = STICKY.residual_indentation(d)
    F = STICKY.loading_force(d)
    assert_allclose(law.unloading_force(d, d), F, rtol=1e-12)
    assert_allclose(law.unloading_force(d0, d), 0, atol=1e-12 * F)
    assert law.unloading_force(0.0, d) == 0
    assert law.unloading_force(2 * d, d) == STICKY.loading_force(2 * d)


@given(st.floats(1.0, 1e2).map(lambda x: x * LIMIT), st.floats(0.0, 1.0))
def test_beyond_the_limit_loading_and_unloading_are_one_line(d, fraction):
    between = LIMIT + fraction * (d - LIMIT)
    assert_allclose(STICKY.unloading_force(between, d), STICKY.loading_force(between))
    assert STICKY.residual_indentation(d) == approx(PHI * 2 * R, rel=1e-14)


@given(depths, stiffnesses)
def test_the_pull_off_force_is_the_deepest_point_of_unloading(d, k_c):
    law = Luding(R, K1, K2, k_c, PHI)
    path = law.unloading_force(np.linspace(0, d, 2001), d)
    F_c = law.pull_off_force(d)
    assert np.min(path) >= -F_c * (1 + 1e-12)
    assert_allclose(np.min(path), -F_c, atol=(K2 + k_c) * d / 2000)
    if d < LIMIT:  # Luding (2008): F_min = −k_c (k₂ − k₁)/(k₂ + k_c) δ_max
        k2 = K1 + (K2 - K1) * d / LIMIT
        assert_allclose(F_c, k_c * (k2 - K1) / (k2 + k_c) * d, rtol=1e-12)


@settings(deadline=None)
@given(depths, stiffnesses)
def test_the_works_are_the_integrals_of_the_forces(d, k_c):
    law = Luding(R, K1, K2, k_c, PHI)
    limit = LIMIT if d > LIMIT else d / 2
    W_l = sum(quad(law.loading_force, low, high)[0] for low, high in ((0, limit), (limit, d)))
    assert_allclose(STICKY.loading_work(d), W_l, rtol=1e-9)
    d0 = STICKY.residual_indentation(d)
    k2 = K1 + (K2 - K1) * min(d / LIMIT, 1)
    d_min = k2 / (k2 + k_c) * d0
    W_u = sum(
        quad(law.unloading_force, low, high, args=(d,))[0] for low, high in ((0, d_min), (d_min, d))
    )
    assert_allclose(law.unloading_work(d), W_u, rtol=1e-8, atol=1e-9 * W_l)


@given(st.floats(1e-3, 1e2), stiffnesses)
def test_restitution_is_the_root_of_the_ratio_of_the_works(v, k_c):
    law, V = Luding(R, K1, K2, k_c, PHI), v * V_LIMIT
    d = STICKY.indentation_from_velocity(V, MASS)
    W_l, W_u = STICKY.loading_work(d), law.unloading_work(d)
    assert_allclose(W_l, 0.5 * MASS * V**2, rtol=1e-12)
    e = law.restitution(V, MASS)
    assert_allclose(e**2, max(W_u, 0) / W_l, rtol=1e-11, atol=1e-13)


def test_without_adhesion_restitution_is_least_at_the_limit():
    v = np.array([1e-6, 0.3, 0.999, 1.0, 1.001, 3.0, 1e6])
    e = DRY.restitution(v * V_LIMIT, MASS)
    assert e[0] == approx(1, abs=1e-5)
    assert e[3] == approx((K1 / K2) ** 0.5, rel=1e-12)
    assert np.argmin(e) == 3
    assert e[-1] == approx(1, abs=1e-5)
    k2 = K1 + (K2 - K1) * v[:3]
    assert_allclose(e[:3], (K1 / k2) ** 0.5, rtol=1e-12)


def test_up_to_the_limit_it_is_walton_and_brauns_variable_law():
    # k₂ = k₁ + (k̂₂ − k₁) δ/δ* is k₁ + S F_max with S = (k̂₂ − k₁)/(k₁δ*)
    V = np.array([0.1, 0.5, 1.0]) * V_LIMIT
    hardening = (K2 - K1) / (K1 * LIMIT)
    expected = WaltonBraun(K1, K1, hardening).restitution(V, MASS)
    assert_allclose(DRY.restitution(V, MASS), expected, rtol=1e-13)


def test_strong_adhesion_sticks_at_depths_where_much_is_plastic():
    # sticks if ½k₂(d − δ₀)² < ½k_cδ_minδ₀, that is k₁² < k_c (k₂ − k₁)²/(k₂ + k_c)
    law = Luding(R, K1, K2, 1e7, PHI)
    v = np.array([1e-3, 0.1, 0.5, 1.0])
    e = law.restitution(v * V_LIMIT, MASS)
    assert e[0] > 0.99
    assert e[1] > 0
    assert_array_equal(e[2:], 0)
    assert law.restitution(100 * V_LIMIT, MASS) > 0.9


def test_equal_springs_are_elastic_at_any_depth():
    elastic = Luding(R, K1, K1, 1e6, PHI)
    assert elastic.limit_indentation == np.inf
    d = np.array([1e-9, 1e-3])
    assert_allclose(elastic.loading_force(d), K1 * d, rtol=1e-15)
    assert_allclose(elastic.restitution([0.1, 1e3], MASS), 1, rtol=1e-15)


def test_a_limit_below_the_plastic_spring_is_refused():
    with pytest.raises(CaseError, match=r"^limit_stiffness: 90000 is not a finite number from 1"):
        Luding(R, K1, 0.9 * K1, K_C, PHI)
    with pytest.raises(CaseError, match=r"^adhesive_stiffness: -1 "):
        Luding(R, K1, K2, -1.0, PHI)
