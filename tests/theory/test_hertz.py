import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.theory import hertz
from tolerance import approx

R, E_STAR = 250e-6, 112e9
indentations = st.floats(1e-12, 1e-5)
scales = st.floats(1e-3, 1e3)


def test_a_value_worked_out_by_hand():
    # E* = 3, R* = 4, δ = 1/4: a = 1, F = 4·2/8 = 1, W = 8/15·3·2/32 = 1/10, p₀ = 6/(4π)
    assert hertz.force(0.25, 4.0, 3.0) == approx(1.0, rel=1e-14)
    assert hertz.contact_radius(0.25, 4.0) == approx(1.0, rel=1e-14)
    assert hertz.contact_area(0.25, 4.0) == approx(np.pi, rel=1e-14)
    assert hertz.stored_energy(0.25, 4.0, 3.0) == approx(0.1, rel=1e-14)
    assert hertz.peak_pressure(0.25, 4.0, 3.0) == approx(1.5 / np.pi, rel=1e-14)


@given(indentations)
def test_force_and_indentation_are_inverse(d):
    F = hertz.force(d, R, E_STAR)
    assert_allclose(hertz.indentation_from_force(F, R, E_STAR), d, rtol=1e-14)


@settings(deadline=None)
@given(indentations)
def test_the_energy_is_the_integral_of_the_force(d):
    work, _ = quad(lambda s: hertz.force(s * d, R, E_STAR) * d, 0, 1)
    assert_allclose(hertz.stored_energy(d, R, E_STAR), work, rtol=1e-8)


@given(indentations)
def test_the_pressure_carries_the_force_and_ends_at_the_contact_radius(d):
    a = hertz.contact_radius(d, R)
    # with r = a sin t the integrand is smooth up to the edge
    t, weights = np.polynomial.legendre.leggauss(20)
    t, weights = np.pi / 4 * (t + 1), np.pi / 4 * weights
    p = hertz.pressure(a * np.sin(t), d, R, E_STAR)
    F = np.sum(weights * p * 2 * np.pi * a**2 * np.sin(t) * np.cos(t))
    assert_allclose(F, hertz.force(d, R, E_STAR), rtol=1e-12)
    assert hertz.pressure(1.0001 * a, d, R, E_STAR) == 0
    assert_allclose(
        hertz.pressure(0.0, d, R, E_STAR), hertz.peak_pressure(d, R, E_STAR), rtol=1e-14
    )


def test_the_peak_pressure_is_one_and_a_half_times_the_mean():
    mean = hertz.force(1e-7, R, E_STAR) / hertz.contact_area(1e-7, R)
    assert_allclose(hertz.peak_pressure(1e-7, R, E_STAR), 1.5 * mean, rtol=1e-14)


def test_pressure_profiles_at_several_depths():
    r, d = np.linspace(-1e-5, 1e-5, 7), np.array([[-1e-7], [0.0], [1e-7]])
    p = hertz.pressure(r, d, R, E_STAR)
    assert p.shape == (3, 7)
    assert not p[:2].any()
    assert_allclose(p, p[:, ::-1], rtol=1e-12)


@given(indentations, scales, scales)
def test_lengths_and_stresses_set_the_scales(d, length, stress):
    scaled = length * d, length * R, stress * E_STAR
    assert_allclose(hertz.force(*scaled), length**2 * stress * hertz.force(d, R, E_STAR))
    assert_allclose(
        hertz.stored_energy(*scaled), length**3 * stress * hertz.stored_energy(d, R, E_STAR)
    )
    assert_allclose(hertz.peak_pressure(*scaled), stress * hertz.peak_pressure(d, R, E_STAR))
