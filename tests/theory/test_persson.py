import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from restitution.errors import CaseError
from restitution.theory import Persson
from tolerance import approx

FLAT = Persson(0.1, 112e9)
pressures = st.floats(0, 1e12)


def test_values_worked_out_by_hand():
    # √2 p/(E* h′) = ½ and 1: erf(½) = 0.520499878, erf(1) = 0.842700793
    unit = 0.1 * 112e9 / math.sqrt(2)
    assert FLAT.relative_area(0.5 * unit) == approx(0.5204998778, rel=1e-9)
    assert FLAT.relative_area([unit, 1e3 * unit]) == approx(np.array([0.8427007929, 1]), rel=1e-9)


def test_area_is_proportional_to_low_pressures():
    area = FLAT.relative_area(1e-6 * 0.1 * 112e9)
    assert area == approx(1e-6 * math.sqrt(8 / math.pi), rel=1e-9)


@given(pressures, pressures)
def test_area_grows_with_pressure_up_to_one(p, more):
    less, greater = FLAT.relative_area(p), FLAT.relative_area(p + more)
    assert 0 <= less <= greater <= 1


def test_fields_and_pressures_broadcast():
    found = Persson([[0.1], [0.2]], 112e9).relative_area([0.0, 1e9])
    assert found.shape == (2, 2)
    assert (found[:, 0] == 0).all()
    assert found[0, 1] == FLAT.relative_area(1e9)
    assert FLAT.relative_area(-1.0) == 0


def test_slopes_that_are_not_positive_are_refused():
    with pytest.raises(CaseError, match="rms_slope"):
        Persson(0.0, 112e9)


def test_the_density_of_the_pressure_sums_to_area_and_force():
    slope, p = 0.1 * 112e9, 2e9
    local = np.linspace(0, 12 * slope, 200_001)
    density = FLAT.pressure_density(local, p)
    assert density[0] == 0
    assert np.trapezoid(density, local) == approx(float(FLAT.relative_area(p)), rel=1e-8)
    assert np.trapezoid(local * density, local) == approx(p, rel=1e-8)
