import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from restitution.theory import hertz, yielding
from restitution.theory import thornton_ning as tn

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
MATERIAL = (R, E_STAR, P_Y)
D_Y = yielding.yield_indentation(*MATERIAL)
F_Y = yielding.yield_force(*MATERIAL)
V_Y = yielding.yield_velocity(*MATERIAL, MASS)
depths = st.floats(1e-3, 1e4)  # δ/δ_y
plastic_depths = st.floats(1.0, 1e4)
fractions = st.floats(0.0, 1.0)
positives = st.floats(1e-3, 1e3)


def test_first_loading_is_hertz_up_to_yield_and_its_tangent_beyond():
    x = np.array([0.1, 0.5, 1.0])
    assert_allclose(tn.loading_force(x * D_Y, *MATERIAL), hertz.force(x * D_Y, R, E_STAR))
    x = np.array([1.0, 2.0, 16.0])
    assert_allclose(tn.loading_force(x * D_Y, *MATERIAL), F_Y * (1.5 * x - 0.5), rtol=1e-14)
    h = 1e-6
    above = tn.loading_force(D_Y * (1 + h), *MATERIAL)
    below = tn.loading_force(D_Y * (1 - h), *MATERIAL)
    slope = 1.5 * F_Y / D_Y
    assert_allclose([(above - F_Y) / (h * D_Y), (F_Y - below) / (h * D_Y)], slope, rtol=1e-6)


@settings(deadline=None)
@given(st.floats(1.01, 100.0))
def test_the_plastic_line_is_the_hertz_pressure_cut_at_the_yield_pressure(x):
    d = x * D_Y
    a, plateau = (R * d) ** 0.5, (R * (d - D_Y)) ** 0.5  # p reaches p_y at a² − r² = a_y²
    rim, _ = quad(lambda r: hertz.pressure(r, d, R, E_STAR) * 2 * np.pi * r, plateau, a)
    cut = np.pi * plateau**2 * P_Y + rim
    assert_allclose(tn.loading_force(d, *MATERIAL), cut, rtol=1e-7)


@given(depths)
def test_the_force_is_the_slope_of_the_loading_work(x):
    h = 1e-4 * x
    work = tn.loading_work(np.array([x - h, x + h]) * D_Y, *MATERIAL)
    F = tn.loading_force(x * D_Y, *MATERIAL)
    assert_allclose((work[1] - work[0]) / (2 * h * D_Y), F, rtol=1e-6)


@given(plastic_depths)
def test_unloading_starts_at_the_loading_force_and_ends_at_zero(x):
    d = x * D_Y
    d_p = tn.residual_indentation(d, *MATERIAL)
    assert 0 <= d_p < d
    F = tn.loading_force(d, *MATERIAL)
    assert_allclose(tn.unloading_force(d, d, *MATERIAL), F, rtol=1e-12)
    assert tn.unloading_force(d_p, d, *MATERIAL) == 0
    assert tn.unloading_force(0.5 * d_p, d, *MATERIAL) == 0
    assert tn.unloading_force(d_p + 1e-6 * d, d, *MATERIAL) > 0
    # pressed further than before, the contact yields on
    assert tn.unloading_force(2 * d, d, *MATERIAL) == tn.loading_force(2 * d, *MATERIAL)


@given(plastic_depths)
def test_the_unloading_radius_is_the_published_one(x):
    F = tn.loading_force(x * D_Y, *MATERIAL)
    published = 4 * E_STAR / (3 * F) * ((2 * F + F_Y) / (2 * np.pi * P_Y)) ** 1.5
    assert_allclose(tn.unloading_radius(x * D_Y, *MATERIAL), published, rtol=1e-12)
    # unloading keeps the contact it starts from: a² = R_p (δ − δ_p) = R* δ
    R_p, d_p = tn.unloading_radius(x * D_Y, *MATERIAL), tn.residual_indentation(x * D_Y, *MATERIAL)
    assert_allclose(R_p * (x * D_Y - d_p), R * x * D_Y, rtol=1e-12)


@settings(deadline=None)
@given(plastic_depths)
def test_the_unloading_work_is_the_integral_of_the_unloading_force(x):
    d = x * D_Y
    d_p = tn.residual_indentation(d, *MATERIAL)
    span = d - d_p
    work, _ = quad(lambda s: tn.unloading_force(d_p + s * span, d, *MATERIAL) * span, 0, 1)
    assert_allclose(tn.unloading_work(d, *MATERIAL), work, rtol=1e-7)


@given(st.floats(1e-3, 1.0))
def test_nothing_is_lost_below_yield(x):
    d = x * D_Y
    V = tn.impact_velocity(d, *MATERIAL, MASS)
    assert tn.residual_indentation(d, *MATERIAL) == 0
    assert tn.unloading_radius(d, *MATERIAL) == R
    assert tn.unloading_work(d, *MATERIAL) == tn.loading_work(d, *MATERIAL)
    assert tn.restitution_at_indentation(d, *MATERIAL) == 1
    assert_allclose(tn.restitution(V, *MATERIAL, MASS), 1, rtol=1e-15)
    assert_allclose(
        tn.unloading_force(0.5 * d, d, *MATERIAL), tn.loading_force(0.5 * d, *MATERIAL), rtol=1e-14
    )


def test_yield_is_where_restitution_leaves_one():
    x = np.array([1 - 1e-9, 1.0, 1 + 1e-9, 1.0001])
    for e in (
        tn.restitution_at_indentation(x * D_Y, *MATERIAL),
        tn.restitution(x * V_Y, *MATERIAL, MASS),
    ):
        assert np.all(e <= 1)
        assert_allclose(e[:3], 1, rtol=1e-15)
        assert e[3] < 1


@given(depths)
def test_restitution_by_works_by_depth_and_by_velocity_agree(x):
    d = x * D_Y
    by_works = (tn.unloading_work(d, *MATERIAL) / tn.loading_work(d, *MATERIAL)) ** 0.5
    by_depth = tn.restitution_at_indentation(d, *MATERIAL)
    V = tn.impact_velocity(d, *MATERIAL, MASS)
    assert_allclose(by_depth, by_works, rtol=1e-14)
    assert_allclose(tn.restitution(V, *MATERIAL, MASS), by_depth, rtol=1e-14)


@given(depths)
def test_velocity_and_depth_are_inverse(x):
    V = tn.impact_velocity(x * D_Y, *MATERIAL, MASS)
    assert_allclose(tn.indentation_from_velocity(V, *MATERIAL, MASS), x * D_Y, rtol=1e-13)


def test_the_yield_velocity_reaches_the_yield_indentation():
    assert_allclose(tn.impact_velocity(D_Y, *MATERIAL, MASS), V_Y, rtol=1e-14)


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
    computed = tn.restitution_at_indentation(x * D_Y, *MATERIAL)
    assert round(float(computed), decimals) == e


def test_fast_impacts_follow_the_minus_quarter_power():
    # e = 1.185 (V_y/V)^¼ (Thornton & Ning 1998, for V > 10 V_y)
    v = np.array([10.0, 100.0, 1e4])
    e = tn.restitution(v * V_Y, *MATERIAL, MASS)
    asymptote = (6 * 3**0.5 / 5) ** 0.5 * (5 / 24) ** 0.125
    assert round(asymptote, 3) == 1.185
    error = np.abs(e / v**-0.25 / asymptote - 1)
    assert error[0] < 0.02
    assert_allclose(error[:-1] / error[1:], [10, 100], rtol=0.05)  # first order in V_y/V


@given(depths, depths)
def test_deeper_and_faster_means_less_returned(x, y):
    shallow, deep = np.sort([x, y])
    for e in (
        tn.restitution_at_indentation(np.array([shallow, deep]) * D_Y, *MATERIAL),
        tn.restitution(np.array([shallow, deep]) * V_Y, *MATERIAL, MASS),
    ):
        assert e[1] <= e[0] * (1 + 1e-15)
        assert np.all((e > 0) & (e <= 1))


@given(depths, fractions, positives, positives)
def test_only_the_ratio_to_the_yield_depth_matters(x, fraction, length, stress):
    other = length * R, stress * E_STAR, stress * P_Y
    assert_allclose(
        tn.restitution_at_indentation(x * length * D_Y, *other),
        tn.restitution_at_indentation(x * D_Y, *MATERIAL),
        rtol=1e-12,
    )
    assert_allclose(
        tn.unloading_force(fraction * x * length * D_Y, x * length * D_Y, *other),
        length**2 * stress * tn.unloading_force(fraction * x * D_Y, x * D_Y, *MATERIAL),
        rtol=1e-9,
        atol=1e-12 * length**2 * stress * float(F_Y),
    )


@given(st.floats(1e-3, 1e3), st.floats(1e-4, 1e-1))
def test_restitution_depends_on_velocity_and_yield_pressure_through_their_ratio(v, yield_strain):
    material = R, E_STAR, yield_strain * E_STAR
    V_y = yielding.yield_velocity(*material, MASS)
    assert_allclose(
        tn.restitution(v * V_y, *material, MASS),
        tn.restitution(v * V_Y, *MATERIAL, MASS),
        rtol=1e-12,
    )
