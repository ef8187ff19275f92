"""The periodic problem with a given mean: its bracket, its tolerances and its solutions."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq

from restitution.contact.influence import (
    foundation_compliance,
    inverse_half_space,
    sprung_half_space,
)
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from restitution.numerics.quadratic.prescribed_mean import (
    MeanTarget,
    _Bracket,
    minimise_at_mean,
)
from tolerance import approx


def system(shape, level):
    cells = 2.0**level, 2.0**level
    return sprung_half_space(shape, cells, 1.0), inverse_half_space(shape, cells, 1.0)


def target_of(n, mean):
    return MeanTarget(mean, 1e-6, foundation_compliance((n, n), (1.0, 1.0), 1.0), 1e-8)


def test_the_bracket_takes_secants_and_halves_where_they_leave_it():
    bracket = _Bracket(2.0, 1.0)
    assert bracket.following(10.0, -1.0, 0.0) == 12.0
    assert bracket.slope == 2.0
    # The slope of the secant, 1/2, is below the least; the step would end at 9, below 10.
    assert bracket.following(12.0, 3.0, 0.0) == 11.0
    assert bracket.slope == 1.0
    # 11 is still low; a step with the least slope would end at 16, above 12.
    assert bracket.following(11.0, -5.0, 0.0) == 11.5
    assert bracket.following(11.6, 0.1, 0.0) == approx(11.5)


def test_the_bracket_knows_how_uncertain_its_values_are():
    bracket = _Bracket(1.0, 0.1)
    bracket.following(10.0, -1.0, 0.5)
    bracket.following(12.0, 1.0, 0.25)
    assert (bracket._low, bracket._high) == (9.5, 12.25)
    bracket.following(12.1, 0.5, 1.0)
    bracket.following(9.6, -0.5, 0.5)
    assert (bracket._low, bracket._high) == (9.5, 12.25)


def test_the_bracket_doubles_until_a_value_is_positive_and_stays_above_zero():
    assert _Bracket(1.0, 0.1).following(3.0, 0.0, 0.0) == 6.0
    assert _Bracket(1.0, 0.1).following(3.0, 5.0, 0.0) == 1.5


def test_two_values_that_fall_do_not_change_the_slope():
    bracket = _Bracket(2.0, 0.1)
    bracket.following(10.0, -1.0, 0.0)
    bracket.following(11.0, -1.5, 0.0)
    assert bracket.slope == 2.0
    bracket.following(12.0, -0.5, 0.0)
    assert bracket.slope == 1.0


def test_the_tolerance_is_the_smaller_of_two():
    target = MeanTarget(mean=2.0, precision=1e-3, compliance=3.0, residual=1e-4)
    assert target.tolerance(7.0, 10.0) == approx(1e-4 * 1.0)
    assert target.tolerance(5.0, 10.0) == approx(1e-4 * 1.0)
    assert target.tolerance(7.0, 0.01) == approx(0.5 * 1e-3 * 2.0 * 0.01)


def waves(n, seed=0):
    rng, x = np.random.default_rng(seed), np.arange(n) / n
    h = np.zeros((n, n))
    for _ in range(10):
        a, b = rng.integers(-5, 6, 2)
        h += np.cos(2 * np.pi * (a * x[:, None] + b * x + rng.random()))
    return h - h.min()


def of(multiplier, h, upper):
    """The mean of the plain solution for a given multiplier."""
    K, inverse = system(h.shape, 0)
    found = minimise_quadratic(
        BoundedQuadratic(K, multiplier - h, 0.0, upper),
        start=np.zeros_like(h),
        precondition=inverse,
        tolerance=1e-11,
        max_iterations=500,
    )
    return float(found.point.mean())


@pytest.mark.parametrize(("share", "upper"), [(0.1, math.inf), (1.0, math.inf), (0.3, 2.0)])
@pytest.mark.parametrize("n", [24, 160])
def test_the_multiplier_is_that_of_plain_solutions(n, share, upper):
    h = waves(n)
    found = minimise_at_mean(system, h, upper, target_of(n, share), max_iterations=500)
    assert found.minimum.converged
    assert found.minimum.point.mean() == approx(share, rel=1e-6)
    assert found.minimum.point.max() <= upper
    assert of(found.multiplier, h, upper) == approx(share, rel=3e-6)
    above, below = (of(found.multiplier * factor, h, upper) for factor in (1.01, 0.99))
    slope = 0.02 * found.multiplier / (above - below)
    assert found.slope == approx(slope, rel=0.2)
    if n == 24:
        exact = brentq(lambda D: of(D, h, upper) - share, 0.5 * found.multiplier, 50, rtol=1e-9)
        assert found.multiplier == approx(exact, rel=1e-6)
        assert found.products > 0


def test_a_search_that_ends_too_early_says_so():
    found = minimise_at_mean(system, waves(24), math.inf, target_of(24, 0.5), max_iterations=2)
    assert not found.minimum.converged


def test_coarser_grids_and_secants_save_products():
    """Sums over five surfaces, and 3 % more."""
    products = 0
    for seed in range(5):
        found = minimise_at_mean(
            system, waves(160, seed), math.inf, target_of(160, 0.3), max_iterations=500
        )
        assert found.minimum.converged
        products += found.products
    assert products <= 156
