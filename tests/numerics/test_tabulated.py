"""A tabulated function, with its derivative and integral."""

import numpy as np
import pytest

from restitution.numerics.tabulated import Tabulated
from tolerance import approx

TABLE = Tabulated(2.0, 0.5, np.array([9.0, 4.0, 2.0, 1.5, 0.0]))


def test_values_and_slopes_belong_to_the_integral():
    x, d = np.linspace(1.7, 4.3, 23), 1e-6
    total, value, slope = TABLE(x)
    ahead = TABLE(x + d)
    np.testing.assert_allclose((ahead[0] - total) / d, value, rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose((ahead[1] - value) / d, slope, rtol=1e-4, atol=1e-4)
    assert (np.diff(value) < 0).all()


def test_the_table_is_met_at_its_points():
    np.testing.assert_allclose(TABLE(TABLE.points)[1], TABLE.values)
    assert TABLE.last == TABLE.points[-1]
    assert TABLE.whole == approx(float(TABLE(np.asarray(TABLE.last))[0]))
    assert TABLE(np.asarray(TABLE.first))[0] == 0


@pytest.mark.parametrize(("x", "value"), [(1.0, 1.0), (2.25, 1.5), (3.0, 3.0), (9.0, 5.0)])
def test_other_values_on_the_same_table(x, value):
    assert TABLE.linear(np.arange(1.0, 6.0), np.asarray(x)) == approx(value)
