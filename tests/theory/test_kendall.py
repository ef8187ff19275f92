import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.theory import JKR, Hertz, Kendall
from tolerance import approx

R, E_STAR, W = 250e-6, 112e9, 0.05
HERTZ, PUNCH = Hertz(R, E_STAR), Kendall(E_STAR, W)
radii = st.floats(1e-9, 1e-4)


def test_a_value_worked_out_by_hand():
    # E* = 2, w = 1/π, a = 4: F = (16·64)^½ = 32, displacement 32/(2·2·4) = 2
    assert Kendall(2.0, 1 / np.pi).pull_off_force(4.0) == approx(32.0, rel=1e-14)
    assert Kendall(2.0, 1 / np.pi).pull_off_displacement(4.0) == approx(2.0, rel=1e-14)


@given(radii)
def test_the_crack_at_the_rim_releases_the_work_of_adhesion(a):
    F = PUNCH.pull_off_force(a)
    d = PUNCH.pull_off_displacement(a)
    assert_allclose(F, 2 * E_STAR * a * d, rtol=1e-13)
    # U = F²/(4E*a) at constant load: G = ½F² dC/dA with the compliance C = 1/(2E*a)
    h = 1e-4 * a
    compliance = 1 / (2 * E_STAR * np.array([a - h, a + h]))
    area = np.pi * np.array([a - h, a + h]) ** 2
    released = 0.5 * F**2 * -np.diff(compliance) / np.diff(area)
    assert_allclose(released, W, rtol=1e-6)
    # half of the work is dissipated
    assert_allclose(0.5 * F * d, 2 * W * np.pi * a**2, rtol=1e-13)


@given(radii)
def test_jkr_is_hertz_less_a_punch_of_the_same_contact(a):
    d_H = a**2 / R
    F = HERTZ.force(d_H) - PUNCH.pull_off_force(a)
    d = d_H - PUNCH.pull_off_displacement(a)
    scale = HERTZ.force(d_H)
    assert_allclose(JKR(R, E_STAR, W).force_at_contact_radius(a), F, rtol=1e-12, atol=1e-14 * scale)
    assert_allclose(
        JKR(R, E_STAR, W).indentation_at_contact_radius(a), d, rtol=1e-12, atol=1e-14 * d_H
    )


@given(radii, st.floats(1e-3, 1e3))
def test_the_tension_grows_less_than_the_area(a, scale):
    F = PUNCH.pull_off_force(np.array([a, scale * a]))
    assert_allclose(F[1] / F[0], scale**1.5, rtol=1e-12)
