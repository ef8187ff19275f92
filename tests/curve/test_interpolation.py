"""Interpolation between the points of a law, and its error estimate."""

import csv
import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from restitution.curve.interpolation import RatioCurve
from restitution.theory import ThorntonNing
from tolerance import approx

BETWEEN = Path(__file__).parents[2] / "evidence" / "dem" / "between_velocities.csv"
R, E_STAR, P_Y, MASS = 250e-6, 112e9, 750e6, 2e-6


def test_an_elastic_adhesive_pair_is_exact_between_any_two_velocities():
    """e² = 1 − (V_s/V)², which is steep near V_s, at five velocities over more than a decade."""
    V = np.array([0.05, 0.2, 0.5, 1.0, 2.0])
    curve = RatioCurve(V, 1 - (0.107 / V) ** 2, adhesive=True)
    for v in (0.06, 0.115, 0.15, 0.3, 1.7):
        assert curve.at(v) == approx(1 - (0.107 / v) ** 2, abs=1e-9)
        assert curve.error(v) < 1e-9
    assert curve.begins() == approx(0.107, rel=1e-6)


def test_adhesion_and_yield_together():
    V = np.geomspace(0.02, 3, 12)

    def exact(v):
        e = ThorntonNing(R, E_STAR, P_Y).restitution(v, MASS)
        return e**2 - (0.05 / v) ** 2

    curve = RatioCurve(V, exact(V), adhesive=True)
    assert curve.begins() == approx(brentq(exact, 0.02, 1), rel=0.01)
    for v in np.geomspace(0.021, 2.9, 40):
        assert abs(curve.at(v) - exact(v)) <= curve.error(v) + 1e-12


@pytest.mark.parametrize("seed", range(4))
def test_the_error_holds_for_curves_that_scatter_as_rough_ones_do(seed):
    """A law from every second point of a wavy curve: nearly all others lie within the error."""
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


def test_the_error_of_the_example_holds_between_its_velocities_and_close_to_them(law):
    """Results of `evidence/dem/dem.py` for four rough surfaces at 17 velocities."""
    with open(BETWEEN, newline="") as file:
        rows = [{key: float(text) for key, text in row.items()} for row in csv.DictReader(file)]
    held = {}
    for seed in (1, 2, 3, 4):
        mine = [row for row in rows if row["seed"] == seed]
        known = law(points=tuple(point_of(law, row) for row in mine if row["share"] == 0))
        assert len(known.points) == 17
        for row in mine:
            found = known.at(row["velocity_m_per_s"])
            miss = abs(found.restitution - row["restitution"])
            if row["share"]:
                held.setdefault(row["share"], []).append(miss <= found.error)
            else:
                assert found.error == row["restitution_error"]
    assert np.mean([each for some in held.values() for each in some]) >= 0.9
    for share, some in held.items():
        assert len(some) == 64
        assert np.mean(some) >= 0.9, share


def point_of(law, row):
    e = row["restitution"]
    changes = {"velocity": row["velocity_m_per_s"], "restitution": e, "ratio": e**2}
    return replace(law().points[0], **changes, error=row["restitution_error"])


@given(st.lists(st.floats(0, 1), min_size=2, max_size=8), st.data())
def test_the_error_is_continuous(law, values, data):
    """A relative change of the velocity by a millionth causes no jump, at a point or between."""
    V = np.geomspace(0.1, 10, len(values))
    errors = data.draw(st.lists(st.floats(0, 0.05), min_size=len(values), max_size=len(values)))
    rows = [
        {"velocity_m_per_s": v, "restitution": e, "restitution_error": error}
        for v, e, error in zip(V.tolist(), values, errors, strict=True)
    ]
    found = law(points=tuple(point_of(law, row) for row in rows))
    k = data.draw(st.integers(0, len(values) - 1))
    for beside in (V[k] * (1 - 1e-8), V[k] * (1 + 1e-8)):
        if found.lowest < beside < found.highest:
            at = found.at(float(beside))
            assert at.restitution == approx(values[k], abs=0.02)
            assert at.error == approx(errors[k], abs=0.03)
    V = data.draw(st.floats(0.1, 9.99))
    here, there = found.at(V), found.at(V * (1 + 1e-9))
    assert here.restitution == approx(there.restitution, abs=1e-3)
    assert here.error == approx(there.error, abs=0.03)


def test_the_error_falls_towards_the_points_and_their_own_is_interpolated(law):
    one, two = (
        replace(point, error=error)
        for point, error in zip(law().points, (0.01, 0.03), strict=False)
    )
    found = law(points=(one, two))
    ends = [one.velocity, two.velocity]
    V = [ends[0] ** (1 - t) * ends[1] ** t for t in (1e-9, 0.1, 0.5, 0.9, 1 - 1e-9)]
    errors = [found.at(v).error for v in V]
    assert errors[0] == approx(0.01, abs=1e-4)
    assert errors[-1] == approx(0.03, abs=1e-4)
    curve = found.curve()
    assert curve.error(V[1]) == approx(0.6 * curve.error(V[2]), rel=1e-6, abs=0)
    assert errors[2] - 0.02 > errors[1] - 0.012 > 0.5 * (errors[2] - 0.02)


def test_of_two_points_the_error_is_their_difference_and_of_one_there_is_none():
    curve = RatioCurve(np.array([0.1, 1.0]), np.array([0.9, 0.5]), adhesive=False)
    assert curve.error(0.316227766) == approx(0.4, abs=1e-9)
    assert curve.error(0.1) == curve.error(1.0) == 0
    assert curve.at(0.316227766) == approx(0.7)
    alone = RatioCurve(np.array([0.1]), np.array([0.9]), adhesive=True)
    assert (alone.at(0.1), alone.error(0.1)) == (0.9, 0.0)


def test_sticking_ends_where_rounding_hides_the_sign():
    V = np.array([1.0, 1.0047897627974371, 1.2093715638305813, 1.3776992179874699])
    curve = RatioCurve(V, np.array([-2.0, 1e-17, -1e-12, 1e-17]), adhesive=True)
    assert curve.at(V[3]) < 0 < curve.ratios[3]
    assert curve.begins() == V[3]


def test_sticking_ends_at_the_point_below_where_rounding_makes_it_rebound(monkeypatch):
    curve = RatioCurve(np.array([1.0, 2.0, 4.0]), np.array([-1e-17, 0.5, 0.9]), adhesive=False)
    exact = curve.at
    monkeypatch.setattr(curve, "at", lambda v: exact(v) + 2e-17)
    assert curve.at(1.0) > 0
    assert curve.begins() == 1.0


@pytest.mark.parametrize(
    ("ratios", "begins"),
    [([0.1, 0.5, 0.9], None), ([-0.5, -0.2, -0.1], None), ([0.0, 0.5, 0.9], 1.0)],
)
def test_where_sticking_ends(ratios, begins):
    curve = RatioCurve(np.array([1.0, 2.0, 4.0]), np.array(ratios), adhesive=False)
    assert curve.begins() == begins


def test_the_last_of_several_sticking_points_counts():
    V = np.array([1.0, 2.0, 4.0])
    curve = RatioCurve(V, np.array([0.0, -0.1, 0.3]), adhesive=False)
    assert 2.0 < curve.begins() < 4.0
    assert curve.at(curve.begins()) == approx(0, abs=1e-9)
    assert RatioCurve(V, np.array([-0.1, 0.0, 0.3]), adhesive=False).begins() == 2.0


def test_the_error_is_at_least_the_distance_from_a_straight_line():
    """The points of a smooth curve are so dense that leave-one-out residuals almost vanish."""
    V = np.geomspace(1.0, 2.0, 40)
    curve = RatioCurve(V, 0.9 - 0.2 * np.log(V) ** 2, adhesive=False)
    for below, above in itertools.pairwise(V[10:30]):
        middle = math.sqrt(below * above)
        line = 0.5 * (curve.at(below) + curve.at(above))
        assert curve.error(middle) >= abs(curve.at(middle) - line) * (1 - 1e-9) > 0


def test_the_error_is_half_as_large_again_as_the_point_that_was_left_out():
    """Without its middle point the curve is a line from 0.2 to 0.4, which is 0.6 off."""
    curve = RatioCurve(np.exp([0.0, 1.0, 2.0]), np.array([0.2, 0.9, 0.4]), adhesive=False)
    for L in (0.5, 1.5):
        assert curve.error(math.exp(L)) == approx(1.5 * 0.6)
    assert curve.error(math.exp(0.25)) == approx(1.5 * 0.6 * 2 * math.sqrt(0.25 * 0.75))


def test_each_point_has_its_own_residual_and_an_end_that_of_its_neighbour():
    L, ratio = np.arange(5.0), np.array([0.1, 0.1, 0.4, 0.1, 0.1])
    curve = RatioCurve(np.exp(L), ratio, adhesive=False)
    beside = float(PchipInterpolator(L[[0, 2, 3, 4]], ratio[[0, 2, 3, 4]])(1.0)) - 0.1
    assert curve._left_out == approx([beside, beside, 0.3, beside, beside])


def test_an_adhesive_pair_whose_ratio_falls_has_no_loss_by_adhesion():
    V = np.array([1.0, 2.0, 4.0])
    assert RatioCurve(V, np.array([0.9, 0.5, 0.2]), adhesive=True).adhesion == 0.0
    rising = RatioCurve(V, np.array([0.2, 0.5, 0.6]), adhesive=True)
    assert rising.adhesion == approx(0.3 / (1 - 1 / 4))
    assert RatioCurve(V, np.array([0.2, 0.5, 0.6]), adhesive=False).adhesion == 0.0


def test_velocities_that_rounding_puts_beyond_an_end_belong_to_the_interval_there():
    curve = RatioCurve(np.array([1.0, 2.0, 4.0]), np.array([0.9, 0.5, 0.2]), adhesive=False)
    assert curve.interval(1.0 - 1e-12) == (1, 0.0)
    assert curve.interval(4.0 + 1e-12) == (2, 1.0)
    assert curve.interval(math.sqrt(8)) == (2, approx(0.5))


def test_the_error_of_restitution_is_that_of_the_points_and_that_of_the_ratio(law):
    values = ((0.01, 0.81), (0.03, 0.25))
    ends = [
        replace(point, error=error, ratio=ratio, restitution=math.sqrt(ratio))
        for point, (error, ratio) in zip(law().points, values, strict=False)
    ]
    found = law(points=tuple(ends))
    curve = found.curve()
    for t in (0.2, 0.5):
        V = ends[0].velocity ** (1 - t) * ends[1].velocity ** t
        e, off = math.sqrt(curve.at(V)), curve.error(V)
        between = e - math.sqrt(max(curve.at(V) - off, 0.0))
        assert found.at(V).restitution == approx(e)
        assert found.at(V).error == approx(0.01 * (1 - t) + 0.03 * t + between)
