import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.errors import CaseError
from restitution.theory import WaltonBraun
from tolerance import approx

K1, K2, S, MASS = 1e6, 2.5e6, 2e3, 2e-6
LAW = WaltonBraun(K1, K2, S)
depths = st.floats(1e-9, 1e-3)
velocities = st.floats(1e-3, 1e2)


def test_a_value_worked_out_by_hand():
    # k₁ = 1, k_u = 2, S = 1, m* = 1: V = 2 reaches δ = 2, F = 2, k₂ = 4: e = ½, δ₀ = 1.5
    law = WaltonBraun(1.0, 2.0, 1.0)
    assert law.restitution(2.0, 1.0) == approx(0.5, rel=1e-15)
    assert law.residual_indentation(2.0) == approx(1.5, rel=1e-15)
    assert law.unloading_force(1.75, 2.0) == approx(1.0, rel=1e-15)


@given(velocities)
def test_the_constant_law_does_not_depend_on_velocity(V):
    assert_allclose(WaltonBraun(K1, K2, 0.0).restitution(V, MASS), (K1 / K2) ** 0.5, rtol=1e-15)


@given(velocities)
def test_the_variable_law_is_the_published_one(V):
    # e = [ω₀/(S V + ω₀)]^½, ω₀ = (2k₁/m)^½ of two equal spheres of mass m = 2m* (1986)
    omega = (2 * K1 / (2 * MASS)) ** 0.5
    e = WaltonBraun(K1, K1, S).restitution(V, MASS)
    assert_allclose(e, (omega / (S * V + omega)) ** 0.5, rtol=1e-14)


def test_equal_springs_without_hardening_are_elastic():
    law = WaltonBraun(K1, K1, 0.0)
    assert law.restitution(3.0, MASS) == 1
    assert law.residual_indentation(1e-6) == 0
    assert_allclose(law.unloading_force(4e-7, 1e-6), 0.4, rtol=1e-15)


@given(depths)
def test_unloading_starts_at_the_loading_force_and_ends_at_zero(d):
    d0 = LAW.residual_indentation(d)
    assert 0 < d0 < d
    assert_allclose(LAW.unloading_force(d, d), LAW.loading_force(d), rtol=1e-12)
    assert LAW.unloading_force(d0, d) == 0
    assert LAW.unloading_force(0.5 * d0, d) == 0
    assert LAW.unloading_force(2 * d, d) == LAW.loading_force(2 * d)


@settings(deadline=None)
@given(velocities)
def test_restitution_is_the_root_of_the_ratio_of_the_works(V):
    d = V * (MASS / K1) ** 0.5
    W_l, _ = quad(lambda s: LAW.loading_force(s * d) * d, 0, 1)
    d0 = LAW.residual_indentation(d) / d
    W_u, _ = quad(lambda s: LAW.unloading_force(s * d, d) * d, d0, 1)
    assert_allclose(0.5 * MASS * V**2, W_l, rtol=1e-12)
    assert_allclose(LAW.restitution(V, MASS), (W_u / W_l) ** 0.5, rtol=1e-9)


def test_springs_that_would_give_back_more_than_they_take_are_refused():
    with pytest.raises(
        CaseError, match=r"^unloading_stiffness: 900000 is not a finite number from"
    ):
        WaltonBraun(K1, 0.9 * K1, 0.0)
    with pytest.raises(CaseError, match=r"^hardening: -1 "):
        WaltonBraun(K1, K2, -1.0)
