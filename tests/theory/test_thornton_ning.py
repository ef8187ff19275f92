import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.theory import FirstYield, Hertz, ThorntonNing

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
LAW, ONSET = ThorntonNing(R, E_STAR, P_Y), FirstYield(R, E_STAR, P_Y)
HERTZ = Hertz(R, E_STAR)
D_Y = ONSET.indentation
F_Y = ONSET.force
V_Y = ONSET.velocity(MASS)
depths = st.floats(1e-3, 1e4)  # δ/δ_y
plastic_depths = st.floats(1.0, 1e4)
fractions = st.floats(0.0, 1.0)
positives = st.floats(1e-3, 1e3)


def test_first_loading_is_hertz_up_to_yield_and_its_tangent_beyond():
    x = np.array([0.1, 0.5, 1.0])
    assert_allclose(LAW.loading_force(x * D_Y), HERTZ.force(x * D_Y))
    x = np.array([1.0, 2.0, 16.0])
    assert_allclose(LAW.loading_force(x * D_Y), F_Y * (1.5 * x - 0.5), rtol=1e-14)
    h = 1e-6
    above = LAW.loading_force(D_Y * (1 + h))
    below = LAW.loading_force(D_Y * (1 - h))
    slope = 1.5 * F_Y / D_Y
    assert_allclose([(above - F_Y) / (h * D_Y), (F_Y - below) / (h * D_Y)], slope, rtol=1e-6)


@given(depths)
def test_force_and_indentation_are_inverse(x):
    assert_allclose(LAW.indentation(LAW.loading_force(x * D_Y)), x * D_Y, rtol=1e-13)


@settings(deadline=None)
@given(st.floats(1.01, 100.0))
def test_the_plastic_line_is_the_hertz_pressure_cut_at_the_yield_pressure(x):
    d = x * D_Y
    a, plateau = (R * d) ** 0.5, (R * (d - D_Y)) ** 0.5  # p reaches p_y at a² − r² = a_y²
    rim, _ = quad(lambda r: HERTZ.pressure(r, d) * 2 * np.pi * r, plateau, a)
    cut = np.pi * plateau**2 * P_Y + rim
    assert_allclose(LAW.loading_force(d), cut, rtol=1e-7)


@given(depths)
def test_the_force_is_the_slope_of_the_loading_work(x):
    h = 1e-4 * x
    work = LAW.loading_work(np.array([x - h, x + h]) * D_Y)
    F = LAW.loading_force(x * D_Y)
    assert_allclose((work[1] - work[0]) / (2 * h * D_Y), F, rtol=1e-6)


@given(plastic_depths)
def test_unloading_starts_at_the_loading_force_and_ends_at_zero(x):
    d = x * D_Y
    d_p = LAW.residual_indentation(d)
    assert 0 <= d_p < d
    F = LAW.loading_force(d)
    assert_allclose(LAW.unloading_force(d, d), F, rtol=1e-12)
    assert LAW.unloading_force(d_p, d) == 0
    assert LAW.unloading_force(0.5 * d_p, d) == 0
    assert LAW.unloading_force(d_p + 1e-6 * d, d) > 0
    # beyond the previous maximum the contact yields further
    assert LAW.unloading_force(2 * d, d) == LAW.loading_force(2 * d)


@given(plastic_depths)
def test_the_unloading_radius_is_the_published_one(x):
    F = LAW.loading_force(x * D_Y)
    published = 4 * E_STAR / (3 * F) * ((2 * F + F_Y) / (2 * np.pi * P_Y)) ** 1.5
    assert_allclose(LAW.unloading_radius(x * D_Y), published, rtol=1e-12)
    # unloading starts with the same contact area: a² = R_p (δ − δ_p) = R* δ
    R_p, d_p = LAW.unloading_radius(x * D_Y), LAW.residual_indentation(x * D_Y)
    assert_allclose(R_p * (x * D_Y - d_p), R * x * D_Y, rtol=1e-12)


@settings(deadline=None)
@given(plastic_depths)
def test_the_unloading_work_is_the_integral_of_the_unloading_force(x):
    d = x * D_Y
    d_p = LAW.residual_indentation(d)
    span = d - d_p
    work, _ = quad(lambda s: LAW.unloading_force(d_p + s * span, d) * span, 0, 1)
    assert_allclose(LAW.unloading_work(d), work, rtol=1e-7)


@given(st.floats(1e-3, 1.0))
def test_nothing_is_lost_below_yield(x):
    d = x * D_Y
    V = LAW.impact_velocity(d, MASS)
    assert LAW.residual_indentation(d) == 0
    assert LAW.unloading_radius(d) == R
    assert LAW.unloading_work(d) == LAW.loading_work(d)
    assert LAW.restitution_at_indentation(d) == 1
    assert_allclose(LAW.restitution(V, MASS), 1, rtol=1e-15)
    assert_allclose(LAW.unloading_force(0.5 * d, d), LAW.loading_force(0.5 * d), rtol=1e-14)


def test_yield_is_where_restitution_leaves_one():
    x = np.array([1 - 1e-9, 1.0, 1 + 1e-9, 1.0001])
    for e in (
        LAW.restitution_at_indentation(x * D_Y),
        LAW.restitution(x * V_Y, MASS),
    ):
        assert np.all(e <= 1)
        assert_allclose(e[:3], 1, rtol=1e-15)
        assert e[3] < 1


@given(depths)
def test_restitution_by_works_by_depth_and_by_velocity_agree(x):
    d = x * D_Y
    by_works = (LAW.unloading_work(d) / LAW.loading_work(d)) ** 0.5
    by_depth = LAW.restitution_at_indentation(d)
    V = LAW.impact_velocity(d, MASS)
    assert_allclose(by_depth, by_works, rtol=1e-14)
    assert_allclose(LAW.restitution(V, MASS), by_depth, rtol=1e-14)


@given(depths)
def test_velocity_and_depth_are_inverse(x):
    V = LAW.impact_velocity(x * D_Y, MASS)
    assert_allclose(LAW.indentation_from_velocity(V, MASS), x * D_Y, rtol=1e-13)


def test_the_yield_velocity_reaches_the_yield_indentation():
    assert_allclose(LAW.impact_velocity(D_Y, MASS), V_Y, rtol=1e-14)


@pytest.mark.parametrize(
    ("x", "e", "decimals"),
    [
        (1.5, 0.9590, 4),
        (2, 0.9068, 4),
        (6, 0.699, 3),
        (8, 0.6509, 4),
        (16, 0.5476, 4),
        (32, 0.4606, 4),
        (36, 0.447, 3),
    ],
)
def test_restitution_at_tabulated_depths(x, e, decimals):
    computed = LAW.restitution_at_indentation(x * D_Y)
    assert round(float(computed), decimals) == e


def test_fast_impacts_follow_the_minus_quarter_power():
    # e = 1.185 (V_y/V)^¼ (Thornton & Ning 1998, for V > 10 V_y)
    v = np.array([10.0, 100.0, 1e4])
    e = LAW.restitution(v * V_Y, MASS)
    asymptote = (6 * 3**0.5 / 5) ** 0.5 * (5 / 24) ** 0.125
    assert round(asymptote, 3) == 1.185
    error = np.abs(e / v**-0.25 / asymptote - 1)
    assert error[0] < 0.02
    assert_allclose(error[:-1] / error[1:], [10, 100], rtol=0.05)  # first order in V_y/V


@given(depths, depths)
def test_deeper_and_faster_means_less_returned(x, y):
    shallow, deep = np.sort([x, y])
    for e in (
        LAW.restitution_at_indentation(np.array([shallow, deep]) * D_Y),
        LAW.restitution(np.array([shallow, deep]) * V_Y, MASS),
    ):
        assert e[1] <= e[0] * (1 + 1e-15)
        assert np.all((e > 0) & (e <= 1))


@given(depths, fractions, positives, positives)
def test_only_the_ratio_to_the_yield_depth_matters(x, fraction, length, stress):
    other = ThorntonNing(length * R, stress * E_STAR, stress * P_Y)
    assert_allclose(
        other.restitution_at_indentation(x * length * D_Y),
        LAW.restitution_at_indentation(x * D_Y),
        rtol=1e-12,
    )
    assert_allclose(
        other.unloading_force(fraction * x * length * D_Y, x * length * D_Y),
        length**2 * stress * LAW.unloading_force(fraction * x * D_Y, x * D_Y),
        rtol=1e-9,
        atol=1e-12 * length**2 * stress * float(F_Y),
    )


@given(st.floats(1e-3, 1e3), st.floats(1e-4, 1e-1))
def test_restitution_depends_on_velocity_and_yield_pressure_through_their_ratio(v, yield_strain):
    other = ThorntonNing(R, E_STAR, yield_strain * E_STAR)
    V_y = other.first_yield.velocity(MASS)
    assert_allclose(
        other.restitution(v * V_y, MASS),
        LAW.restitution(v * V_Y, MASS),
        rtol=1e-12,
    )
