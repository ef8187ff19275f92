"""Intervals of a linear problem, where they are known."""

import math

import numpy as np

from restitution.fit.uncertainty import Deviations, Uncertainty
from tolerance import approx

J = np.array([[1.0, 0.2], [0.5, -0.3], [0.1, 0.9], [0.8, 0.8]])
S = np.array([0.01, 0.02, 0.01, 0.03])


def deviations(**changes):
    none = {"random": S, "freedom": math.inf, "surfaces": np.zeros((1, 4)), "grid": None}
    return Deviations(**{**none, "model": np.zeros(4), **changes})


def test_noise_alone_gives_the_covariance_of_weighted_least_squares():
    found = Uncertainty.of(J, S, deviations())
    A = J / S[:, None]
    assert found.covariance == approx(np.linalg.inv(A.T @ A), rel=1e-9)
    sigma = math.sqrt(found.covariance[0, 0])
    assert found.halves[0] == approx(1.959964 * sigma, rel=1e-5)


def test_intervals_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(3)
    n, cases, held = 5, 1500, 0
    common = rng.standard_normal((2, 4)) * 0.05
    for _ in range(cases):
        surfaces = rng.standard_normal((n, 2)) @ common
        # Measured are means over as many places, whose scatter is the same.
        places = rng.standard_normal((n, 2)) @ common
        data = S * rng.standard_normal(4) + (places - surfaces).mean(axis=0)
        found = Uncertainty.of(J, S, deviations(surfaces=surfaces - surfaces.mean(axis=0)))
        held += abs((found.sensitivity @ data)[0]) < found.halves[0]
    assert 0.935 < held / cases < 0.975


def test_one_surface_scatters_more_than_the_mean():
    surfaces = np.array([[1.0, 0, 0, 0], [-1.0, 0, 0, 0], [0, 0, 0, 0]]) * 0.1
    found = Uncertainty.of(J, S, deviations(surfaces=surfaces))
    P = found.sensitivity
    spread = abs(P[0, 0]) * 0.1
    assert found.deviation("surface")[0] == approx(spread * math.sqrt(2 / 3))
    assert found.by_one_place[0] == approx(spread * math.sqrt(1 + 1 / 3))


def test_the_grid_moves_parameters_as_its_difference_does():
    found = Uncertainty.of(J, S, deviations(grid=J @ [0.1, -0.2], model=J @ [0.3, 0.0]))
    assert found.deviation("grid") == approx([0.1, 0.2])
    assert found.by_model == approx([0.3, 0.0], rel=1e-6, abs=1e-12)


def test_a_direction_without_effect_is_unbounded():
    flat = np.outer(J[:, 0], [1.0, 2.0])
    found = Uncertainty.of(flat, S, deviations())
    assert found.halves == [math.inf, math.inf]
    assert found.correlation[0, 1] == approx(-1.0)
    assert found.best_direction == approx([0.5, 1.0])
    assert found.half(found.best_direction) < 0.1
    none = Uncertainty.of(np.zeros((4, 2)), S, deviations())
    assert none.halves == [math.inf, math.inf]


def test_the_band_of_a_straight_line_is_that_of_its_parameters():
    at = np.array([[0.3, -0.4]])
    found = Uncertainty.of(J, S, deviations())
    deviation = math.sqrt((at @ found.covariance @ at.T)[0, 0])
    assert found.band(at)[0] == approx(1.959964 * deviation, rel=1e-5)
    # Noise estimated with two degrees of freedom: Student's t instead of the normal distribution.
    assert Uncertainty.of(J, S, deviations(freedom=2)).band(at)[0] == approx(
        4.302653 * deviation, rel=1e-5
    )


def test_the_band_is_wide_where_no_point_determines_the_curve():
    flat = Uncertainty.of(np.outer(J[:, 0], [1.0, 2.0]), S, deviations())
    known, unknown = flat.band(np.array([[0.1, 0.2], [0.2, -0.1]]))
    assert known == approx(1.959964 * 0.1 / np.linalg.norm(J[:, 0] / S), rel=1e-5)
    assert unknown == 1.0
