"""Between the points of a law, and what is said of the error there."""

import numpy as np
import pytest
from scipy.optimize import brentq

from restitution.dem.interpolation import RatioCurve
from restitution.theory import thornton_ning

R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6


def test_an_elastic_adhesive_pair_is_exact_between_any_two_velocities():
    """e² = 1 − (V_s/V)², steep where it begins: five velocities over more than a decade."""
    V = np.array([0.05, 0.2, 0.5, 1.0, 2.0])
    curve = RatioCurve(V, 1 - (0.107 / V) ** 2, adhesive=True)
    for v in (0.06, 0.115, 0.15, 0.3, 1.7):
        assert curve.at(v) == pytest.approx(1 - (0.107 / v) ** 2, abs=1e-9)
        assert curve.error(v) < 1e-9
    assert curve.begins() == pytest.approx(0.107, rel=1e-6)


def test_adhesion_and_yield_together():
    V = np.geomspace(0.02, 3, 12)

    def exact(v):
        e = thornton_ning.restitution(v, R, E_STAR, P_Y, MASS)
        return e**2 - (0.05 / v) ** 2

    curve = RatioCurve(V, exact(V), adhesive=True)
    assert curve.begins() == pytest.approx(brentq(exact, 0.02, 1), rel=0.01)
    for v in np.geomspace(0.021, 2.9, 40):
        assert abs(curve.at(v) - exact(v)) <= curve.error(v) + 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_the_error_holds_for_curves_that_scatter_as_rough_ones_do(seed):
    """Every second point of a wavy curve; what lies between is inside the error, nearly always."""
    rng = np.random.default_rng(seed)
    L = np.linspace(0, 4, 25)
    waves = sum(rng.normal(0, 0.03) * np.sin(k * L + rng.uniform(0, 6)) for k in range(1, 7))
    ratio = 0.5 + waves
    curve = RatioCurve(np.exp(L[::2]), ratio[::2], adhesive=False)
    inside = [
        abs(curve.at(v) - r) <= curve.error(v)
        for v, r in zip(np.exp(L[1::2]), ratio[1::2], strict=True)
    ]
    assert np.mean(inside) >= 0.75


def test_of_two_points_the_error_is_their_difference_and_of_one_there_is_none():
    curve = RatioCurve(np.array([0.1, 1.0]), np.array([0.9, 0.5]), adhesive=False)
    assert curve.error(0.3) == pytest.approx(0.4)
    assert curve.at(0.316227766) == pytest.approx(0.7)
    alone = RatioCurve(np.array([0.1]), np.array([0.9]), adhesive=True)
    assert (alone.at(0.1), alone.error(0.1)) == (0.9, 0.0)


@pytest.mark.parametrize(
    ("ratios", "begins"),
    [([0.1, 0.5, 0.9], None), ([-0.5, -0.2, -0.1], None), ([0.0, 0.5, 0.9], 1.0)],
)
def test_where_sticking_ends(ratios, begins):
    curve = RatioCurve(np.array([1.0, 2.0, 4.0]), np.array(ratios), adhesive=False)
    assert curve.begins() == begins
