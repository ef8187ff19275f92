import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.theory import Hertz
from tolerance import approx

R, E_STAR = 250e-6, 112e9
LAW = Hertz(R, E_STAR)
indentations = st.floats(1e-12, 1e-5)
scales = st.floats(1e-3, 1e3)


def test_a_value_worked_out_by_hand():
    # E* = 3, R* = 4, δ = 1/4: a = 1, F = 4·2/8 = 1, W = 8/15·3·2/32 = 1/10, p₀ = 6/(4π)
    law = Hertz(4.0, 3.0)
    assert law.force(0.25) == approx(1.0, rel=1e-14)
    assert law.contact_radius(0.25) == approx(1.0, rel=1e-14)
    assert law.contact_area(0.25) == approx(np.pi, rel=1e-14)
    assert law.stored_energy(0.25) == approx(0.1, rel=1e-14)
    assert law.peak_pressure(0.25) == approx(1.5 / np.pi, rel=1e-14)


@given(indentations)
def test_force_and_indentation_are_inverse(d):
    F = LAW.force(d)
    assert_allclose(LAW.indentation(F), d, rtol=1e-14)
    assert_allclose(LAW.force_at_contact_radius(LAW.contact_radius(d)), F, rtol=1e-14)


@settings(deadline=None)
@given(indentations)
def test_the_energy_is_the_integral_of_the_force(d):
    work, _ = quad(lambda s: LAW.force(s * d) * d, 0, 1)
    assert_allclose(LAW.stored_energy(d), work, rtol=1e-8)
    assert_allclose(LAW.indentation_from_energy(LAW.stored_energy(d)), d, rtol=1e-14)
    V = LAW.impact_velocity(d, 2e-6)
    assert_allclose(0.5 * 2e-6 * V**2, LAW.stored_energy(d), rtol=1e-14)


@given(indentations)
def test_the_pressure_carries_the_force_and_ends_at_the_contact_radius(d):
    a = LAW.contact_radius(d)
    # with r = a sin t the integrand is smooth up to the edge
    t, weights = np.polynomial.legendre.leggauss(20)
    t, weights = np.pi / 4 * (t + 1), np.pi / 4 * weights
    p = LAW.pressure(a * np.sin(t), d)
    F = np.sum(weights * p * 2 * np.pi * a**2 * np.sin(t) * np.cos(t))
    assert_allclose(F, LAW.force(d), rtol=1e-12)
    assert LAW.pressure(1.0001 * a, d) == 0
    assert_allclose(LAW.pressure(0.0, d), LAW.peak_pressure(d), rtol=1e-14)


def test_an_impact_lasts_as_long_as_its_motion():
    m, V = 2e-7, 0.3
    deepest = LAW.indentation_from_energy(0.5 * m * V**2)
    # With δ = δ_max (1 − s²), the integrand of ∫ dδ/v is finite at the deepest point.
    inward = quad(
        lambda s: 2 * s * deepest / np.sqrt(V**2 - 2 * LAW.stored_energy(deepest * (1 - s**2)) / m),
        0,
        1,
    )[0]
    assert LAW.duration(V, m) == approx(2 * inward, rel=1e-3)


def test_the_peak_pressure_is_one_and_a_half_times_the_mean():
    mean = LAW.force(1e-7) / LAW.contact_area(1e-7)
    assert_allclose(LAW.peak_pressure(1e-7), 1.5 * mean, rtol=1e-14)


def test_pressure_profiles_at_several_depths():
    r, d = np.linspace(-1e-5, 1e-5, 7), np.array([[-1e-7], [0.0], [1e-7]])
    p = LAW.pressure(r, d)
    assert p.shape == (3, 7)
    assert not p[:2].any()
    assert_allclose(p, p[:, ::-1], rtol=1e-12)


@given(indentations, scales, scales)
def test_lengths_and_stresses_set_the_scales(d, length, stress):
    scaled = Hertz(length * R, stress * E_STAR)
    assert_allclose(scaled.force(length * d), length**2 * stress * LAW.force(d))
    assert_allclose(scaled.stored_energy(length * d), length**3 * stress * LAW.stored_energy(d))
    assert_allclose(scaled.peak_pressure(length * d), stress * LAW.peak_pressure(d))
