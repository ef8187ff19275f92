"""Integrals compared with closed forms, and the error estimate of the adaptive rule."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from restitution.numerics.quadrature import integrate_adaptively, integrate_curve
from tolerance import approx


def adaptive(f, a, b, tolerance):
    """Integral, error estimate and the evaluation points in order."""
    asked = []

    def watched(x):
        asked.append(x)
        return f(x)

    value, error = integrate_adaptively(watched, a, b, f(a), f(b), tolerance)
    return value, error, asked


def test_a_curve_has_a_direction():
    x = np.linspace(0.3, 2.0, 23)
    forwards = integrate_curve(x, np.exp(x))
    assert forwards == approx(math.exp(2.0) - math.exp(0.3), rel=1e-4)
    assert integrate_curve(x[::-1], np.exp(x[::-1])) == approx(-forwards, rel=1e-14)


@pytest.mark.parametrize("x", [[], [1.0]])
def test_a_curve_without_length_has_no_integral(x):
    assert integrate_curve(x, x) == 0


def test_two_points_make_a_trapezium_and_a_line_is_exact():
    assert integrate_curve([0.0, 2.0], [1.0, 4.0]) == approx(5.0, rel=1e-14)
    x = np.array([0.0, 0.1, 0.7, 0.8, 2.0])
    assert integrate_curve(x, 3 * x + 1) == approx(8.0, rel=1e-13)
    assert integrate_curve(list(x), list(3 * x + 1)) == approx(8.0, rel=1e-13)


def test_a_curve_converges_at_third_order_and_without_the_bias_of_the_trapezium():
    def error(n):
        x = np.linspace(0.0, 1.0, n + 1)
        return integrate_curve(x, x**2.5) - 2 / 7

    errors = [abs(error(n)) for n in (20, 40, 80)]
    assert errors[0] / errors[1] > 6
    assert errors[1] / errors[2] > 6
    x = np.linspace(0.0, 1.0, 21)
    trapezium = float(np.mean(x[1:] ** 2.5 + x[:-1] ** 2.5) / 2)
    assert errors[0] < 0.05 * (trapezium - 2 / 7)


def test_the_unloading_spacing_integrates_a_hertzian_force():
    """With (1 − t)² spacing the force is a cubic polynomial of the step number."""
    t = np.linspace(0, 1, 17)
    x = (1 - t) ** 2
    assert -integrate_curve(x, x**1.5) == approx(0.4, rel=2e-4)


def test_a_curve_does_not_overshoot_a_jump():
    x = np.linspace(0, 1, 11)
    f = (x > 0.45).astype(float)
    assert 0.5 <= integrate_curve(x, f) <= 0.6  # a cubic spline would oscillate


@settings(deadline=None, max_examples=50)
@given(st.lists(st.floats(-9, 9), min_size=4, max_size=4), st.floats(-3, 3), st.floats(0.1, 5))
def test_simpson_is_exact_for_cubics_on_its_first_five_points(c, a, length):
    b = a + length
    cubic = np.polynomial.Polynomial(c)
    value, error, asked = adaptive(cubic, a, b, 1e-9)
    scale = max(1.0, np.abs(cubic(np.linspace(a, b, 9))).max()) * length
    assert value == approx(cubic.integ()(b) - cubic.integ()(a), abs=1e-13 * scale)
    assert error <= 1e-13 * scale
    assert len(asked) == 3


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize(
    ("f", "exact"),
    [
        (math.exp, math.e - 1),
        (lambda x: math.sin(5 * x), (1 - math.cos(5)) / 5),
        (lambda x: 1 / (0.01 + x * x), 10 * math.atan(10)),
    ],
)
def test_the_error_of_a_smooth_integrand_is_below_its_estimate_and_the_tolerance(
    f, exact, tolerance
):
    value, error, _ = adaptive(f, 0.0, 1.0, tolerance)
    assert error <= tolerance
    assert abs(value - exact) <= error + 1e-14


ROUGH = {
    "hertz": (lambda x: x**1.5, 0.4),
    "kink at 0.3": (lambda x: max(x - 0.3, 0.0), 0.245),
    "kink at 0.9": (lambda x: max(x - 0.9, 0.0), 0.005),
    "two slopes": (lambda x: x + 5 * max(x - 0.7123, 0.0), 0.5 + 2.5 * 0.2877**2),
}


@pytest.mark.parametrize("name", ROUGH)
def test_a_kink_is_resolved_to_the_tolerance(name):
    f, exact = ROUGH[name]
    value, error, asked = adaptive(f, 0.0, 1.0, 1e-6)
    assert value == approx(exact, abs=1e-6)
    assert error <= 1e-6
    assert len(asked) < 80  # refined only where necessary


@pytest.mark.parametrize("name", ROUGH)
def test_the_estimate_is_honest_where_the_integrand_is_not_smooth(name):
    f, exact = ROUGH[name]
    for tolerance in 10.0 ** -np.arange(2, 9):
        value, error, _ = adaptive(f, 0.0, 1.0, tolerance)
        assert abs(value - exact) <= error


def test_points_are_asked_for_once_and_the_intervals_from_left_to_right():
    f, _ = ROUGH["two slopes"]
    _, _, asked = adaptive(f, 0.0, 1.0, 1e-9)
    assert len(asked) == len(set(asked))
    assert not {0.0, 1.0} & set(asked)  # the end values are arguments
    assert all(0 < x < 1 for x in asked)
    # The left half is finished before the right half begins: after the first bisection, no point
    # left of the middle follows one right of it.
    refined = asked[3:]
    beyond = next(k for k, x in enumerate(refined) if x > 0.5)
    assert all(x < 0.5 for x in refined[:beyond])
    assert all(x > 0.5 for x in refined[beyond:])


def test_a_hopeless_integrand_ends_with_a_large_estimate():
    rng = np.random.default_rng(0)
    _, error, asked = adaptive(lambda _: rng.normal(), 0.0, 1.0, 1e-12)
    assert error > 1e-12
    assert len(asked) <= 2**14


def test_the_tolerance_is_absolute_and_the_interval_may_be_anywhere():
    value, _, _ = adaptive(lambda x: 1e-18 * x**1.5, 0.0, 1e-7, 1e-33)
    assert value == approx(0.4e-18 * 1e-7**2.5, abs=1e-33)


def test_the_error_of_two_rules_is_taken_off():
    """After one bisection, extrapolation gives Boole's rule, exact up to the fifth power."""
    for power in range(6):
        value, _, asked = adaptive(lambda x, n=power: x**n, 0.0, 1.0, math.inf)
        assert value == approx(1 / (power + 1), rel=1e-14)
        assert len(asked) == 3


def test_the_error_is_the_difference_of_one_step_from_two():
    """∫x⁴ over [0, 1]: Simpson's rule gives 5/24, on two halves 77/384."""
    value, error, _ = adaptive(lambda x: x**4, 0.0, 1.0, 1.0)
    assert error == approx(5 / 24 - 77 / 384, rel=1e-12)
    assert value == approx(0.2, rel=1e-12)


def test_panels_begin_side_by_side():
    """Three panels of [1, 4] evaluate at 2, 3 and the middle of each panel."""
    asked = []

    def line(x):
        asked.append(x)
        return 2 * x

    value, error = integrate_adaptively(line, 1.0, 4.0, 2.0, 8.0, 1e-9, panels=3)
    assert value == approx(15.0, rel=1e-12)
    assert error < 1e-12
    assert {1.5, 2.0, 2.5, 3.0, 3.5} <= set(asked)
    assert min(asked) > 1.0
    assert max(asked) < 4.0
