"""The compact fit, compared with known laws."""

import math
from dataclasses import replace

import numpy as np
import pytest

from restitution.laws.compact_fit import compact_fit
from restitution.laws.law import CompactFit
from restitution.laws.law_files import law_rows
from restitution.theory import ThorntonNing
from tolerance import approx

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6
SMOOTH = ThorntonNing(R, E_STAR, P_Y)


@pytest.fixture
def with_ratios(law):
    """Make a law with the given ratios W_u/W_l at the given velocities."""
    some = law()

    def make(V, ratio, **values):
        points = [
            replace(
                some.points[0],
                velocity=float(v),
                ratio=float(r),
                restitution=float(np.sqrt(np.clip(r, 0, 1))),
                resolved=True,
            )
            for v, r in zip(V, ratio, strict=True)
        ]
        return replace(some, points=tuple(points), **values)

    return make


def test_thornton_and_nings_law_and_its_elastic_range(with_ratios):
    V_y = float(SMOOTH.first_yield.velocity(MASS))
    V = V_y * np.geomspace(0.3, 300, 25)
    e = SMOOTH.restitution(V, MASS)
    fit = compact_fit(with_ratios(V, e**2))
    assert fit.adhesion == 0
    assert V[0] < fit.elastic_below <= V_y
    assert fit.worst < 0.01
    fine = V_y * np.geomspace(0.3, 300, 400)
    miss = fit.restitution(fine) - SMOOTH.restitution(fine, MASS)
    assert np.abs(miss).max() < 0.02
    assert (fit.lowest, fit.highest) == (V[0], V[-1])


def test_an_elastic_adhesive_pair_is_its_sticking_velocity(with_ratios):
    V = np.geomspace(0.5, 8, 15)
    fit = compact_fit(with_ratios(V, 1 - (1.2 / V) ** 2, work_of_adhesion=0.1, sticks_below=1.2))
    assert fit.adhesion == approx(1.2**2, rel=1e-6)
    assert len(fit.coefficients) == 1
    assert fit.coefficients[0] == approx(1, rel=1e-9)
    assert fit.adhesive_below == approx(12, rel=1e-6)
    assert fit.restitution(1.1) == 0
    assert fit.worst < 1e-9
    assert fit.between < 1e-9


def test_both(with_ratios):
    """Losses by yielding and adhesion add up, as in Thornton and Ning's model."""
    V_y = float(SMOOTH.first_yield.velocity(MASS))
    V = V_y * np.geomspace(1.2, 100, 20)
    e = SMOOTH.restitution(V, MASS)
    V_s = 1.5 * V_y
    fit = compact_fit(with_ratios(V, e**2 - (V_s / V) ** 2, work_of_adhesion=0.1, sticks_below=V_s))
    assert np.sqrt(fit.adhesion) == approx(V_s, rel=0.15)
    assert fit.worst < 0.005


def test_the_error_between_points_is_that_of_a_point_that_is_not_known(with_ratios):
    """The estimate cannot include a kink between two points, but it includes a single outlier."""
    V = np.geomspace(0.1, 10, 12)
    ratio = np.full(12, 0.5)
    ratio[6] = 0.8
    fit = compact_fit(with_ratios(V, ratio))
    assert fit.between > 0.1


@pytest.mark.parametrize("points", [1, 3])
def test_a_few_points_are_not_worth_a_fit(with_ratios, points):
    V = np.geomspace(1, 2, points)
    assert compact_fit(with_ratios(V, np.full(points, 0.5))) is None


def test_numbers_are_restitutions_whatever_the_fit(with_ratios):
    V = np.geomspace(0.1, 10, 12)
    fit = compact_fit(with_ratios(V, np.linspace(0.99, 0.01, 12)))
    e = fit.restitution(np.geomspace(0.1, 10, 200))
    assert np.all((e >= 0) & (e <= 1))


def test_the_fit_has_no_value_outside_of_the_resolved_points(with_ratios):
    """e = 1 at resolved points, 0.574 at others: the fit has values only for resolved ones."""
    V = np.geomspace(0.01, 10, 14)
    ratio = np.concatenate([np.full(3, 0.574**2), np.ones(4), np.linspace(0.9, 0.4, 7)])
    law = with_ratios(V, ratio)
    points = [replace(point, resolved=3 <= k < 13) for k, point in enumerate(law.points)]
    law = replace(law, points=tuple(points))
    fit = compact_fit(law)
    assert (fit.lowest, fit.highest) == (V[3], V[12]) == law.fitted_range
    assert fit.elastic_below == V[6]
    assert fit.restitution(V[3:7]).tolist() == [1.0] * 4
    assert np.isnan(fit.restitution(V)).tolist() == [True] * 3 + [False] * 10 + [True]
    assert np.isnan(fit.restitution([0.999 * V[3], 1.001 * V[12]])).all()
    rows = law_rows(replace(law, fit=fit))
    assert [math.isnan(row["compact_fit"]) for row in rows] == [True] * 3 + [False] * 10 + [True]


def form(**changes):
    """e² = 0.5 + 0.2 L − 0.04/V², with L = ln(V/2)/3, from 0.5 to 20 m/s."""
    values = {
        "coefficients": (0.5, 0.2),
        "centre": 2.0,
        "width": 3.0,
        "adhesion": 0.04,
        "sticks_below": None,
        "elastic_below": None,
        "adhesive_below": 2.0,
        "lowest": 0.5,
        "highest": 20.0,
        "worst": 0.0,
        "between": 0.0,
    }
    return CompactFit(**values | changes)


def test_the_formula():
    V = np.array([0.5, 1.0, 2.0, 20.0])
    expected = np.sqrt(0.5 + 0.2 * np.log(V / 2) / 3 - 0.04 / V**2)
    assert form().restitution(V) == approx(expected, rel=1e-12)
    assert form().restitution(2.0) == approx(0.7, rel=1e-12)


def test_at_and_below_its_limits_it_is_zero_or_one():
    V = [0.5, 1.0, 1.001, 3.0]
    free = form().restitution(V)
    assert form(sticks_below=1.0).restitution(V).tolist() == [0.0, 0.0, *free[2:]]
    assert form(elastic_below=1.0).restitution(V).tolist() == [1.0, 1.0, *free[2:]]


def test_its_ends_belong_to_it_up_to_the_tolerance_of_the_velocities():
    fit = form()
    inside = fit.restitution([0.5 * (1 - 1e-4), 20 * (1 + 1e-4)])
    assert np.isfinite(inside).all()
    assert np.isnan(fit.restitution([0.5 * (1 - 1.1e-4), 20 * (1 + 1.1e-4)])).all()


def test_a_polynomial_of_a_low_degree_is_found(with_ratios):
    V = np.geomspace(0.2, 20, 14)
    L = np.log(V / 2) / (0.5 * math.log(100))
    fit = compact_fit(with_ratios(V, 0.6 - 0.25 * L + 0.1 * L**2))
    assert fit.coefficients == approx((0.6, -0.25, 0.1), rel=1e-9)
    assert (fit.centre, fit.width) == (approx(2), approx(0.5 * math.log(100)))
    assert (fit.adhesion, fit.adhesive_below, fit.elastic_below) == (0.0, None, None)
    assert max(fit.worst, fit.between) < 1e-9


def test_four_resolved_points_are_enough_and_three_are_not(with_ratios):
    V = np.geomspace(1, 8, 4)
    assert compact_fit(with_ratios(V, [0.8, 0.7, 0.6, 0.5])) is not None
    assert compact_fit(with_ratios(V[:3], [0.8, 0.7, 0.6])) is None


def test_one_sticking_and_one_lossless_point_anchor_the_fit(with_ratios):
    """Points further away on that side take no part: here they would spoil it."""
    V = np.geomspace(0.1, 10, 12)
    ratio = 0.5 + 0.2 * np.log(V / V[4])
    ratio[:4] = 1.0
    lossless = compact_fit(with_ratios(V, ratio))
    assert lossless.elastic_below == V[3]
    assert lossless.centre == approx(math.sqrt(V[3] * V[-1]))
    ratio[:4] = -1.0
    sticky = compact_fit(
        with_ratios(V, ratio, work_of_adhesion=0.1, sticks_below=float(0.99 * V[4]))
    )
    assert sticky.centre == approx(math.sqrt(V[3] * V[-1]))
    assert sticky.elastic_below is None
    assert sticky.restitution(V[:4]).tolist() == [0.0] * 4


def test_with_adhesion_no_point_is_lossless(with_ratios):
    V = np.geomspace(0.1, 10, 12)
    ratio = np.concatenate([np.ones(4), np.linspace(0.9, 0.4, 8)])
    assert compact_fit(with_ratios(V, ratio)).elastic_below == V[3]
    assert compact_fit(with_ratios(V, ratio, work_of_adhesion=0.1)).elastic_below is None


def test_the_loss_that_counts_for_lossless_is_a_thousandth(with_ratios):
    V = np.geomspace(0.1, 10, 12)
    for loss, last in ((0.9e-3, 3), (1.1e-3, 2)):
        ratio = np.concatenate([np.ones(3), [1 - loss], np.linspace(0.9, 0.4, 8)])
        assert compact_fit(with_ratios(V, ratio)).elastic_below == V[last]


def test_the_degree_is_at_most_eight(with_ratios):
    V = np.geomspace(0.2, 20, 16)
    L = np.log(V / 2) / (0.5 * math.log(100))
    for degree in (8, 9):
        ratio = 0.5 + 0.4 * np.polynomial.chebyshev.Chebyshev.basis(degree)(L)
        fit = compact_fit(with_ratios(V, ratio))
        assert (fit.between < 1e-9) == (degree == 8)
        assert len(fit.coefficients) <= 9


def test_of_n_points_at_most_n_minus_two_coefficients_are_fitted(with_ratios):
    for n in (4, 5, 6):
        V = np.geomspace(1, 8, n)
        L = np.log(V / math.sqrt(8)) / (0.5 * math.log(8))
        fit = compact_fit(with_ratios(V, 0.5 + 0.3 * L ** (n - 3)))
        assert len(fit.coefficients) == n - 2
        assert fit.between < 1e-9


def test_a_gain_by_adhesion_is_not_fitted(with_ratios):
    """e² = 0.5 + 0.01/V² would need a negative loss."""
    V = np.geomspace(0.3, 10, 12)
    fit = compact_fit(with_ratios(V, 0.5 + 0.01 / V**2, work_of_adhesion=0.1))
    assert (fit.adhesion, fit.adhesive_below) == (0.0, None)


def test_a_loss_by_adhesion_is_fitted_only_to_adhesive_pairs(with_ratios):
    V = np.geomspace(0.3, 10, 12)
    assert compact_fit(with_ratios(V, 0.5 - 0.01 / V**2)).adhesion == 0.0
    fit = compact_fit(with_ratios(V, 0.5 - 0.01 / V**2, work_of_adhesion=0.1))
    assert fit.adhesion == approx(0.01, rel=1e-6)


def test_a_lower_degree_is_enough_if_its_error_is_below_a_thousandth(with_ratios):
    """A parabola of height c changes e = √½ by up to c/√2, at the middle by c/2√2."""
    V = np.geomspace(0.2, 20, 15)
    L = np.log(V / 2) / (0.5 * math.log(100))
    degrees = {
        c: len(compact_fit(with_ratios(V, 0.5 + c * (L**2 - 0.5))).coefficients) - 1
        for c in (1e-3, 1e-2)
    }
    assert degrees == {1e-3: 0, 1e-2: 2}


def test_the_worst_of_the_fit_includes_points_that_take_no_part(with_ratios):
    V = np.geomspace(0.1, 10, 12)
    ratio = np.concatenate([np.full(3, 0.99**2), np.linspace(0.9, 0.4, 9) ** 2])
    fit = compact_fit(with_ratios(V, ratio))
    miss = np.abs(fit.restitution(V) - np.sqrt(ratio))
    assert fit.worst == approx(miss.max(), rel=1e-9)
    assert fit.between >= fit.worst
