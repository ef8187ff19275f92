from itertools import pairwise

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.theory import JKR, Hertz
from tolerance import approx

R, E_STAR, W, MASS = 250e-6, 112e9, 0.05, 2e-6
LAW, HERTZ = JKR(R, E_STAR, W), Hertz(R, E_STAR)
F_C = LAW.pull_off_force
A_B = LAW.break_radius
D_B = LAW.break_indentation
W_S = LAW.hysteresis_loss
V_S = LAW.sticking_velocity(MASS)
depths = st.floats(-1.0, 1e6)  # δ/|δ_b|
stable = st.floats(1.0, 1e3)  # a/a_b
both_branches = st.floats(1e-3, 1e3)
scales = st.floats(1e-3, 1e3)
GAUSS = np.polynomial.legendre.leggauss(40)


def integral(function, lower, upper):
    points, weights = GAUSS
    half = (upper - lower) / 2
    return half * np.sum(weights * function(lower + half * (points + 1)))


def test_values_worked_out_by_hand():
    # E* = 3, R* = 2, w = 6/π: a_b = (6·4/24)^{1/3} = 1, F_c = 18, U = 3/4
    law = JKR(2.0, 3.0, 6 / np.pi)
    assert law.break_radius == approx(1.0, rel=1e-14)
    assert law.pull_off_force == approx(18.0, rel=1e-14)
    # s = 2: a = 4, δ = (16 − 8)/2 = 4, F = (64 − 48)·18/9 = 32
    assert law.contact_radius(4.0) == approx(4.0, rel=1e-14)
    assert law.force(4.0) == approx(32.0, rel=1e-14)
    assert law.force_at_contact_radius(4.0) == approx(32.0, rel=1e-13)
    assert law.indentation_at_contact_radius(4.0) == approx(4.0, rel=1e-13)
    # U_T = ¾·16·(512/15 − 128/3 + 8) = −6.4, U_el = U_T + ¾·8·16, at the break ¾·16/5
    total = law.total_energy_at_contact_radius(4.0)
    assert total == approx(-6.4, rel=1e-12)
    stored = law.stored_energy_at_contact_radius(4.0)
    assert stored == approx(89.6, rel=1e-13)
    assert law.unloading_work(4.0) == approx(-8.8, rel=1e-12)


def test_the_four_points_of_the_curve():
    assert_allclose(A_B, (np.pi * W * R**2 / (8 * E_STAR)) ** (1 / 3), rtol=1e-14)
    a_c = LAW.pull_off_radius
    assert_allclose(a_c, (9 * np.pi * W * R**2 / (8 * E_STAR)) ** (1 / 3), rtol=1e-14)
    a_0 = LAW.zero_load_radius
    assert_allclose(a_0, (9 * np.pi * W * R**2 / (2 * E_STAR)) ** (1 / 3), rtol=1e-14)
    assert_allclose(D_B, -0.75 * (np.pi**2 * W**2 * R / E_STAR**2) ** (1 / 3), rtol=1e-13)
    assert_allclose(F_C, 1.5 * np.pi * W * R, rtol=1e-14)

    def force(a):
        return LAW.force_at_contact_radius(a)

    def indentation(a):
        return LAW.indentation_at_contact_radius(a)

    assert_allclose([force(a_c), force(A_B)], [-F_C, -5 / 9 * F_C], rtol=1e-13)
    assert_allclose(force(a_0), 0, atol=1e-13 * F_C)
    assert_allclose(indentation(A_B), D_B, rtol=1e-13)
    assert_allclose(indentation(a_c), LAW.pull_off_indentation, rtol=1e-13)
    assert_allclose(LAW.break_force, force(A_B), rtol=1e-13)
    assert_allclose(LAW.jump_in_force, LAW.force(0.0), rtol=1e-13)
    assert_allclose(LAW.force(0.0), -8 / 9 * F_C, rtol=1e-13)
    # F has its minimum at a_c, δ at a_b
    near = np.linspace(0.9, 1.1, 201)
    assert np.argmin(force(near * a_c)) == 100
    assert np.argmin(indentation(near * A_B)) == 100


def test_the_branch_ends_at_the_break():
    assert LAW.contact_radius(D_B) == A_B
    assert_allclose(LAW.force(D_B), -5 / 9 * F_C, rtol=1e-14)
    assert LAW.unloading_work(D_B) == approx(0, abs=1e-14 * float(W_S))
    below = np.nextafter(D_B, -1)
    for function in (LAW.force, LAW.contact_radius, LAW.loading_work, LAW.unloading_work):
        assert function(below) == 0
    # s − 1 → (x/2)^½ where δ = (1 − x)δ_b: δ_b is a turning point of δ(a)
    x = np.array([1e-6, 1e-8, 1e-10])
    a = LAW.contact_radius(D_B * (1 - x))
    assert_allclose(((a / A_B) ** 0.5 - 1) / (x / 2) ** 0.5, 1, rtol=1e-3)


@given(depths)
def test_depth_and_contact_radius_are_inverse(x):
    d = x * -D_B
    a = LAW.contact_radius(d)
    assert a >= A_B
    # at the break δ is quadratic in the change of a
    assert_allclose(LAW.indentation_at_contact_radius(a), d, rtol=1e-13, atol=1e-14 * -float(D_B))


@given(stable)
def test_force_by_depth_and_by_contact_radius_agree_on_the_stable_branch(x):
    a = x * A_B
    d = np.maximum(LAW.indentation_at_contact_radius(a), D_B)
    # close to the break the error of a is the square root of the rounding error of δ
    assert_allclose(LAW.contact_radius(d), a, rtol=1e-13 if x > 1.01 else 1e-7)
    assert_allclose(
        LAW.force(d),
        LAW.force_at_contact_radius(a),
        rtol=1e-12 if x > 1.01 else 1e-7,
        atol=1e-12 * float(F_C),
    )


@given(both_branches)
def test_the_total_energy_changes_by_the_work_of_the_force(x):
    # dU_T/da = F dδ/da, on both branches: a polynomial in s, so the rule is exact
    s0, s1 = x**0.5, 1.1 * x**0.5

    def power(s):
        a, slope = A_B * s**2, A_B**2 / R * (4 * s**3 - 4)  # dδ/ds
        return LAW.force_at_contact_radius(a) * slope

    U = LAW.total_energy_at_contact_radius(A_B * np.array([s0, s1]) ** 2)
    assert_allclose(
        integral(power, s0, s1), U[1] - U[0], rtol=1e-11, atol=1e-13 * np.max(np.abs(U))
    )


@given(st.floats(1e-3, 1e2))
def test_the_elastic_energy_releases_the_work_of_adhesion_at_fixed_grips(x):
    # In equilibrium ∂U_el/∂(πa²) = w at constant δ. Hertz loading to a, then unloading at fixed a
    # by a²/R* − δ with stiffness 2E*a: U_el = E* (a⁵/5R*² − 2a³δ/3R* + aδ²) for any a and δ
    a = x * A_B
    d = LAW.indentation_at_contact_radius(a)
    stored = E_STAR * np.polynomial.Polynomial([0, d**2, 0, -2 * d / (3 * R), 0, 1 / (5 * R**2)])
    U_el = LAW.stored_energy_at_contact_radius(a)
    assert_allclose(stored(a), U_el, rtol=1e-9)
    assert_allclose(stored.deriv()(a) / (2 * np.pi * a), W, rtol=1e-7)


@given(st.floats(0.0, 1e3))
def test_the_works_are_the_integrals_of_the_force(x):
    d = x * -D_B

    def work(lower):
        span = d - lower

        def power(t):  # δ = lower + span t² makes the square root at the break smooth
            return LAW.force(lower + span * t**2) * 2 * t * span

        ends = [0.0, *np.geomspace(1e-2, 1, 9)]
        return sum(integral(power, *piece) for piece in pairwise(ends))

    atol = 1e-9 * float(W_S)
    assert_allclose(LAW.loading_work(d), work(0.0), rtol=1e-9, atol=atol)
    assert_allclose(LAW.unloading_work(d), work(D_B), rtol=1e-9, atol=atol)


@given(st.floats(1e-6, 1e3))
def test_one_cycle_loses_the_same_at_any_depth(x):
    d = x * -D_B
    W_l = LAW.loading_work(d)
    W_u = LAW.unloading_work(d)
    assert_allclose(W_l - W_u, W_S, rtol=1e-12, atol=1e-13 * np.abs(W_l))


def test_the_loss_is_what_the_jump_in_and_the_break_shed():
    def total(d):
        return LAW.total_energy_at_contact_radius(LAW.contact_radius(d))

    assert_allclose(W_S, total(D_B) - total(0.0), rtol=1e-12)
    assert_allclose(W_S, -LAW.unloading_work(0.0), rtol=1e-13)
    assert total(0.0) < 0 < total(D_B)


def test_the_loss_rounds_to_the_published_coefficient():
    assert round(float(JKR(1.0, 1.0, 1.0).hysteresis_loss), 2) == 7.09
    unit = (W**5 * R**4 / E_STAR**2) ** (1 / 3)
    exact = 8 / 5 * (2 + 3 * 4 ** (4 / 3)) * (np.pi / 8) ** (5 / 3)
    assert_allclose(W_S, exact * unit, rtol=1e-13)


@given(st.floats(1e-9, 1e-5))
def test_without_adhesion_it_is_hertz(d):
    weak = JKR(R, E_STAR, 1e-22)
    assert_allclose(weak.force(d), HERTZ.force(d), rtol=1e-8)
    assert_allclose(weak.contact_radius(d), HERTZ.contact_radius(d), rtol=1e-8)
    W_H = HERTZ.stored_energy(d)
    for work in (weak.loading_work, weak.unloading_work):
        assert_allclose(work(d), W_H, rtol=1e-8)
    assert_allclose(weak.restitution_at_indentation(d), 1, rtol=1e-8)


def test_hertz_is_approached_as_the_root_of_the_work_of_adhesion():
    d = 1e-7
    F_H = HERTZ.force(d)
    w = np.array([1e-6, 1e-8, 1e-10])
    # δ_H(a) − δ = (2πwa/E*)^½ and Kendall's tension, to first order in w^½
    a = HERTZ.contact_radius(d)
    drawn = (2 * np.pi * w * a / E_STAR) ** 0.5
    first = 2 * E_STAR * a * drawn - (8 * np.pi * E_STAR * w * a**3) ** 0.5
    assert_allclose(first, 0, atol=1e-12 * F_H)  # they cancel, so the force differs only in order w
    order = np.diff(np.log(np.abs(JKR(R, E_STAR, w).force(d) / F_H - 1))) / np.diff(np.log(w))
    assert_allclose(order, 1, atol=0.01)


def test_the_seed_papers_normalised_curve():
    # Ghanbarzadeh et al. (2019), eqs 9–13, in ā = a/a_c, d̄ = δ/|δ_c|, F̄ = F/F_c
    a = np.linspace(0.1, 5, 50)
    length = LAW.pull_off_radius
    depth = (3 * np.pi**2 * W**2 * R / (64 * E_STAR**2)) ** (1 / 3)
    assert_allclose(-LAW.pull_off_indentation, depth, rtol=1e-13)
    d = LAW.indentation_at_contact_radius(a * length) / depth
    F = LAW.force_at_contact_radius(a * length) / F_C
    assert_allclose(d, 3 * a**2 - 4 * a**0.5, rtol=1e-11, atol=1e-12)
    assert_allclose(F, a**3 - 2 * a**1.5, rtol=1e-11, atol=1e-12)
    # eq. 14 is a fit to these: error up to 3 % of F_c for d̄ ≤ 3, larger beyond
    d = np.linspace(-1, 3, 50)
    fit = 0.12 * (d + 1) ** (5 / 3) - 1
    assert_allclose(LAW.force(d * depth) / F_C, fit, atol=0.03)


@given(depths, scales, scales, scales)
def test_all_materials_share_one_curve(x, length, stress, adhesion):
    other = JKR(length * R, stress * E_STAR, adhesion * W)
    d, d_other = x * -D_B, x * -other.break_indentation
    a_other = other.break_radius
    # at the break the error of a is the square root of the rounding error of δ
    rtol = 1e-11 if x > -0.999 else 1e-6
    assert_allclose(
        other.contact_radius(np.maximum(d_other, other.break_indentation)) / a_other,
        LAW.contact_radius(np.maximum(d, D_B)) / A_B,
        rtol=rtol,
    )
    assert_allclose(
        other.force(d_other) / other.pull_off_force,
        LAW.force(d) / F_C,
        rtol=rtol,
        atol=1e-12,
    )
    for work, work_other in (
        (LAW.loading_work, other.loading_work),
        (LAW.unloading_work, other.unloading_work),
    ):
        assert_allclose(
            work_other(d_other) / other.hysteresis_loss, work(d) / W_S, rtol=1e-9, atol=1e-12
        )


@given(depths, depths)
def test_the_stable_branch_grows_with_depth(x, y):
    shallow, deep = np.sort([x, y]) * -D_B
    a = LAW.contact_radius(np.array([shallow, deep]))
    assert a[0] <= a[1] * (1 + 1e-15)


@given(st.floats(1e-3, 1e5))
def test_restitution_by_works_by_depth_and_by_velocity_agree(x):
    d = x * -D_B
    W_l, W_u = LAW.loading_work(d), LAW.unloading_work(d)
    V = LAW.impact_velocity(d, MASS)
    by_depth = LAW.restitution_at_indentation(d)
    if W_u <= 0:
        assert by_depth == 0
        assert np.isnan(V) == (W_l < 0)
    else:
        assert_allclose(by_depth**2, W_u / W_l, rtol=1e-12, atol=1e-12)
        assert_allclose(0.5 * MASS * V**2, W_l, rtol=1e-14)
        e = LAW.restitution(V, MASS)
        assert_allclose(e**2, by_depth**2, rtol=1e-12, atol=1e-12)


def test_impacts_that_adhesion_alone_draws_deeper_have_no_velocity():
    # W_l = 0 at 2.2585 |δ_b|, the depth of an impact at zero velocity; W_u = 0 at 2.8381 |δ_b|
    V = LAW.impact_velocity(np.array([2.258, 2.259]) * -D_B, MASS)
    assert np.isnan(V[0])
    assert 0 < V[1] < 0.1 * (2 * W_S / MASS) ** 0.5
    e = LAW.restitution_at_indentation(np.array([0.1, 2.258, 2.838, 2.839]) * -D_B)
    assert not e[:3].any()
    assert 0 < e[3] < 0.05


def test_a_standing_pair_and_a_slow_one():
    V = np.array([-1.0, 0.0, 1e-300, 1e-9])
    assert_allclose(LAW.restitution(V, MASS), [1, 1, 0, 0], atol=0)


def test_the_sticking_velocity_carries_the_loss_of_one_cycle():
    assert_allclose(0.5 * MASS * V_S**2, LAW.hysteresis_loss, rtol=1e-14)


def test_the_exact_coefficient_of_sticking_rounds_to_the_published_one():
    coefficient = JKR(1.0, 1.0, 1.0).sticking_velocity(1.0) ** 2
    assert round(float(coefficient), 2) == 14.18
    published = (14.18 / MASS) ** 0.5 * (W**5 * R**4 / E_STAR**2) ** (1 / 6)
    assert_allclose(V_S, published, rtol=2e-4)


@given(st.floats(1e-3, 1e4))
def test_the_loss_is_added(v):
    e = LAW.restitution(v * V_S, MASS)
    assert_allclose(e**2, max(0, 1 - 1 / v**2), rtol=1e-13, atol=1e-15)


def test_sticking_ends_at_the_sticking_velocity():
    v = np.array([-1.0, 0.0, 1e-9, 0.5, 1.0, 1 + 1e-9, 1e9])
    e = LAW.restitution(v * V_S, MASS)
    assert_array_equal(e[:5], [1, 1, 0, 0, 0])
    assert e[5] == approx((2e-9) ** 0.5, rel=1e-6)
    assert e[6] == approx(1, abs=1e-15)


@given(*[st.floats(1e-3, 1e3)] * 4)
def test_the_powers_of_the_sticking_velocity(length, stress, adhesion, inertia):
    V = JKR(length * R, stress * E_STAR, adhesion * W).sticking_velocity(inertia * MASS)
    powers = adhesion ** (5 / 6) * length ** (2 / 3) * stress ** (-1 / 3) * inertia**-0.5
    assert_allclose(V / V_S, powers, rtol=1e-12)


def test_the_tabor_parameter_is_the_neck_over_the_range_of_the_forces():
    # R* = 8, w = E* = 1, z₀ = ½: (8/(1/8))^{1/3} = 4
    assert JKR(8.0, 1.0, 1.0).tabor_parameter(0.5) == approx(4.0, rel=1e-14)
    z0 = 3e-10
    neck = -LAW.break_indentation / (0.75 * np.pi ** (2 / 3))
    assert_allclose(LAW.tabor_parameter(z0), neck / z0, rtol=1e-13)
    # at μ ≈ 1 the pull-off indentation of JKR is about the range of the forces
    assert 0.5 < -LAW.pull_off_indentation / neck < 1
