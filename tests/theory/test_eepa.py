import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.errors import CaseError
from restitution.theory import EEPA, Luding, WaltonBraun
from tolerance import approx

K1, K2, K_ADH, F0, N, MASS = 1e7, 4e7, 2e7, -1e-4, 1.5, 2e-6
depths = st.floats(1e-8, 1e-3)
exponents = st.floats(1.0, 3.0)
stiffer = st.floats(1.0, 1e2).map(lambda ratio: ratio * K1)
adhesive = st.floats(0.0, 1e9)
attractions = st.floats(-1e-2, 0.0)


def test_a_value_worked_out_by_hand():
    # n = 1, k₁ = 1, k₂ = k_adh = 2, f₀ = −½, d = 2: δ_p = 1, δ_min = ½, F_c = 1.5
    law = EEPA(1.0, 2.0, 2.0, -0.5, 1.0)
    assert law.residual_indentation(2.0) == approx(1.0, rel=1e-15)
    assert law.pull_off_force(2.0) == approx(1.5, rel=1e-14)
    # W_l = −1 + 2 = 1, W_u = −1 + 1 − ½ = −½: it sticks
    assert law.loading_work(2.0) == approx(1.0, rel=1e-14)
    assert law.unloading_work(2.0) == approx(-0.5, rel=1e-14)
    assert law.indentation_from_velocity(2**0.5, 1.0) == approx(2.0)
    assert law.restitution(2**0.5, 1.0) == 0


@given(depths, stiffer, adhesive, attractions, exponents)
def test_the_branches_join(d, k2, k_adh, f0, n):
    law = EEPA(K1, k2, k_adh, f0, n)
    loading = law.loading_force(d)
    scale = k2 * d**n - f0
    assert_allclose(law.unloading_force(d, d), loading, rtol=0, atol=1e-12 * scale)
    d_p = law.residual_indentation(d)
    assert_allclose(law.unloading_force(d_p, d), f0 * (d_p > 0), atol=1e-12 * scale)
    assert law.unloading_force(0.0, d) == 0
    assert law.unloading_force(2 * d, d) == law.loading_force(2 * d)
    path = law.unloading_force(np.linspace(0, d, 501)[1:], d)
    F_c = law.pull_off_force(d)
    assert np.min(path) >= -F_c * (1 + 1e-12)


@settings(deadline=None)
@given(depths, stiffer, adhesive, attractions, exponents)
def test_the_works_are_the_integrals_of_the_forces(d, k2, k_adh, f0, n):
    law = EEPA(K1, k2, k_adh, f0, n)
    scale = k2 * d ** (n + 1) - f0 * d
    W_l, _ = quad(lambda s: law.loading_force(s * d) * d, 0, 1)
    assert_allclose(law.loading_work(d), W_l, atol=1e-8 * scale)
    kink = ((k2 - K1) / (k2 + k_adh)) ** (1 / n)
    W_u = sum(
        quad(lambda s: law.unloading_force(s * d, d) * d, low, high)[0]
        for low, high in ((0, kink), (kink, 1))
    )
    assert_allclose(law.unloading_work(d), W_u, atol=1e-8 * scale)


@given(st.floats(1e-4, 1e2), attractions, exponents)
def test_the_largest_indentation_takes_up_the_impact(V, f0, n):
    law = EEPA(K1, K2, K_ADH, f0, n)
    d = law.indentation_from_velocity(V, MASS)
    work = law.loading_work(d)
    assert_allclose(work, 0.5 * MASS * V**2, rtol=1e-11, atol=1e-13 * -f0 * d)


@given(st.floats(1e-3, 1e2), stiffer, adhesive, attractions, exponents)
def test_restitution_is_the_root_of_the_ratio_of_the_works(V, k2, k_adh, f0, n):
    law = EEPA(K1, k2, k_adh, f0, n)
    d = law.indentation_from_velocity(V, MASS)
    W_u = law.unloading_work(d)
    e = law.restitution(V, MASS)
    assert_allclose(e**2, min(max(W_u / (0.5 * MASS * V**2), 0), 1), rtol=1e-12)


@given(st.floats(1e-3, 1e2), stiffer, exponents)
def test_without_adhesion_restitution_is_a_number_of_the_springs(V, k2, n):
    q = 1 - K1 / k2
    p = q ** (1 / n)
    integral = (1 - p ** (n + 1)) / (n + 1) - q * (1 - p)  # ∫(tⁿ − pⁿ) dt from p to 1
    e = EEPA(K1, k2, 0.0, 0.0, n).restitution(V, MASS)
    assert_allclose(e**2, integral * (n + 1) * k2 / K1, rtol=1e-9, atol=1e-12 * k2 / K1)


def test_linear_springs_are_walton_and_braun_and_luding_at_the_limit():
    V = np.array([0.01, 1.0])
    e = EEPA(K1, K2, 0.0, 0.0, 1.0).restitution(V, MASS)
    assert_allclose(e, WaltonBraun(K1, K2, 0.0).restitution(V, MASS), rtol=1e-12)
    d = 1e-6
    R_star = 0.5 * d * (1 - K1 / K2) / 0.01  # at d the limit of plasticity depth 0.01 is reached
    sticky = Luding(R_star, K1, K2, K_ADH, 0.01).unloading_work(d)
    assert_allclose(EEPA(K1, K2, K_ADH, 0.0, 1.0).unloading_work(d), sticky, rtol=1e-12)


def test_equal_springs_are_elastic_whatever_the_constant_force():
    e = EEPA(K1, K1, K_ADH, F0, N).restitution(np.array([1e-3, 1.0]), MASS)
    assert_allclose(e, 1, rtol=1e-9)


def test_the_constant_force_makes_slow_impacts_stick():
    V = np.geomspace(1e-4, 10, 50)
    e = EEPA(K1, K2, 0.0, F0, N).restitution(V, MASS)
    assert e[0] == 0
    assert np.all(np.diff(e) >= 0)
    assert e[-1] == approx(EEPA(K1, K2, 0.0, 0.0, N).restitution(1.0, MASS), rel=1e-3)


@pytest.mark.parametrize(
    ("name", "springs"),
    [
        ("unloading_stiffness", (K1, 0.9 * K1, K_ADH, F0, N)),
        ("adhesive_stiffness", (K1, K2, -1.0, F0, N)),
        ("constant_force", (K1, K2, K_ADH, 1e-4, N)),
        ("exponent", (K1, K2, K_ADH, F0, 0.9)),
    ],
)
def test_a_spring_outside_the_model_is_refused_by_name(name, springs):
    with pytest.raises(CaseError, match=rf"^{name}: .* is not a finite number from"):
        EEPA(*springs)
