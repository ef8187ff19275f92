import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import lognorm, norm

from restitution.surfaces.johnson import possible, translation
from tolerance import approx

# Expectations use the density on fine steps of z: steps of equal probability miss the tails.
Z = np.linspace(-9, 9, 200_001)
WEIGHT = norm.pdf(Z) * (Z[1] - Z[0])


def moments(apply):
    x = apply(Z)
    assert np.all(np.diff(x) >= 0)  # the map is increasing
    mean = WEIGHT @ x
    variance = WEIGHT @ (x - mean) ** 2
    return (
        mean,
        variance,
        WEIGHT @ (x - mean) ** 3 / variance**1.5,
        WEIGHT @ (x - mean) ** 4 / variance**2,
    )


@pytest.mark.parametrize(
    ("skewness", "kurtosis"),
    [(0, 3), (0.3, 3.2), (-1, 5), (1, 4), (-1.5, 4), (0, 2), (0, 1.8), (0, 6), (1, 2.2)],
)
def test_moments_are_those_asked_for(skewness, kurtosis):
    found = moments(translation(skewness, kurtosis))
    assert found == approx((0, 1, skewness, kurtosis), abs=2e-3)


@settings(deadline=None, max_examples=40)
@given(st.floats(-1.8, 1.8), st.floats(0.25, 4.0))
def test_any_possible_pair_is_met(skewness, above):
    kurtosis = skewness**2 + 1 + above
    apply = translation(skewness, kurtosis)
    assert apply is not None
    mean, variance, skew, kurt = moments(apply)
    assert (mean, variance) == approx((0, 1), abs=2e-3)
    assert skew == approx(skewness, abs=5e-3)
    assert kurt == approx(kurtosis, rel=2e-2)


def test_on_their_line_it_is_the_lognormal_distribution():
    sigma = 0.25
    skewness, excess = (float(v) for v in lognorm.stats(sigma, moments="sk"))
    found = translation(skewness, 3 + excess)(Z)
    x = np.exp(sigma * Z)
    mean, deviation = math.exp(sigma**2 / 2), lognorm.std(sigma)
    assert found[20_000:-20_000] == approx(((x - mean) / deviation)[20_000:-20_000], abs=0.05)


@pytest.mark.parametrize("pair", [(0, 1.0), (2, 5.0), (math.nan, 3), (0, math.nan), (0, math.inf)])
def test_impossible_pairs(pair):
    assert not possible(*pair)
    assert translation(*pair) is None
