"""Means over nested contours of an array."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from restitution.numerics.contours import contour_means
from tolerance import approx

EITHER = pytest.mark.parametrize("means", [contour_means, contour_means.__wrapped__])


def means_of(means, values, periodic=False):
    out = np.empty(np.shape(values))
    means(np.asarray(values, float), periodic, out)
    return out


def own(*values):
    """S/n^1.5 with n = exp(−Σ w ln w) and w = v/S."""
    shares = np.array(values) / sum(values)
    return sum(values) * np.exp(1.5 * np.sum(shares * np.log(shares)))


@EITHER
def test_one_peak_has_its_own_mean(means):
    out = means_of(means, [[0, 1, 3, 2, 0, -1]])
    assert_allclose(out, np.where([[0, 1, 1, 1, 0, 0]], own(1, 3, 2), 0))
    assert own(2.0, 2.0, 2.0, 2.0) == approx(1.0)  # four equal nodes count as four


@EITHER
def test_two_peaks_share_the_contours_below_their_saddle(means):
    out = means_of(means, [[0, 4, 1, 2, 0]])
    whole, first, second = own(4, 1, 2), own(4, 1), own(2)
    assert out[0, 1] == approx(first + (whole - first) / 4)
    assert out[0, 2] == approx(whole)
    assert out[0, 3] == approx(second + (whole - second) / 2)


@EITHER
def test_a_period_has_no_edges(means):
    joined = own(2, 1)
    assert_allclose(means_of(means, [[2, 0, 1]], periodic=True), [[joined, 0, joined]])
    assert_allclose(means_of(means, [[2, 0, 1]]), [[2, 0, 1]])
    column = np.array([[2.0], [0], [1]])
    assert_allclose(means_of(means, column, periodic=True)[:, 0], [joined, 0, joined])
