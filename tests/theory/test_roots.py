"""Roots of increasing functions: accuracy and number of steps."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.theory._roots import increasing_root
from tolerance import approx


@pytest.fixture
def counted():
    """A function that counts how often it is called."""

    def make(function):
        def call(x):
            call.times += 1
            return function(x)

        call.times = 0
        return call

    return make


@pytest.mark.parametrize("power", [0.5, 1.0, 1.5, 2.5, 9.0])
def test_powers_are_found_to_the_last_digits_in_few_steps(counted, power):
    exact = np.geomspace(1e-9, 0.9, 50)
    excess = counted(lambda x: x**power - exact**power)
    np.testing.assert_allclose(increasing_root(excess, 0.0, 1.0), exact, rtol=1e-14)
    assert excess.times < 75  # bisection takes 83 for the smallest root


def test_smooth_functions_near_their_bracket_take_about_ten_steps(counted):
    c = np.linspace(0.1, 2, 20)
    excess = counted(lambda s: s - c * (1 + 1.75 * np.exp(-4.4 * s**2)))
    found = increasing_root(excess, c, 2.75 * c)
    np.testing.assert_allclose(found, c * (1 + 1.75 * np.exp(-4.4 * found**2)), rtol=1e-14)
    assert excess.times < 20


def test_what_is_outside_of_the_bracket_is_its_end_and_nan_stays_nan():
    target = np.array([-1.0, 0.0, 0.5, 1.0, 2.0, np.nan])
    found = increasing_root(lambda x: x - target, 0.0, 1.0)
    np.testing.assert_array_equal(found, [0, 0, 0.5, 1, 1, np.nan])
    assert np.isnan(increasing_root(lambda x: x - 0.5, np.nan, 1.0))


@given(st.floats(1e-12, 1 - 1e-12), st.floats(0.05, 20), st.floats(-1, 1))
def test_kinks_and_steps_do_not_stop_it(root, slope, jump):
    def excess(x):
        return np.where(x < root, x - root, slope * (x - root) + abs(jump))

    # The root of a step function is where its sign changes, between two adjacent numbers.
    assert increasing_root(excess, 0.0, 1.0) == approx(root, rel=1e-13, abs=1e-15)
