"""The minimiser, compared with enumerated active sets and a least-squares solver."""

import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from restitution.numerics.quadratic.minimise import (
    BoundedQuadratic,
    minimise_quadratic,
    violation,
)
from tolerance import approx

TOLERANCE = 1e-10  # of `minimise`
seeds = st.integers(0, 2**32 - 1)


def enumerated(A, b, lower, upper):
    """The stationary point of lowest energy among all faces of the box."""
    best, best_energy = None, np.inf
    for side in itertools.product((-1, 0, 1), repeat=b.size):
        side = np.array(side)
        p = np.select([side < 0, side > 0], [lower, upper], 0.0)
        if not np.isfinite(p).all():
            continue
        free = side == 0
        if free.any():
            p[free] = np.linalg.solve(A[free][:, free], (b - A @ p)[free])
        if (p < lower - 1e-12).any() or (p > upper + 1e-12).any():
            continue
        energy = 0.5 * p @ A @ p - b @ p
        if energy < best_energy:
            best, best_energy = p, energy
    return best


@settings(deadline=None, max_examples=60)
@given(st.integers(1, 4), seeds)
def test_it_finds_the_best_of_all_active_sets(minimise, random_matrix, random_bounds, n, seed):
    rng = np.random.default_rng(seed)
    A, b = random_matrix(rng, n), 3 * rng.normal(size=n)
    lower, upper = random_bounds(rng, n)
    found, _ = minimise(A, b, lower, upper, start=rng.normal(size=n))
    assert found.converged
    assert_allclose(found.point, enumerated(A, b, lower, upper), atol=1e-9)


@settings(deadline=None, max_examples=40)
@given(st.integers(5, 40), st.booleans(), seeds)
def test_it_agrees_with_least_squares_on_the_cholesky_factor(
    minimise, random_matrix, random_bounds, kkt_violation, n, preconditioned, seed
):
    rng = np.random.default_rng(seed)
    A, b = random_matrix(rng, n), 3 * rng.normal(size=n)
    lower, upper = random_bounds(rng, n)
    inverse = np.diag(1 / np.diag(A)) if preconditioned else None
    found, _ = minimise(A, b, lower, upper, start=5 * rng.normal(size=n), inverse=inverse)
    L = np.linalg.cholesky(A)  # ½pᵀAp − pᵀb = ½|Lᵀp − L⁻¹b|² + constant
    c = solve_triangular(L, b, lower=True)
    other = lsq_linear(L.T, c, (lower, upper), method="bvls", tol=1e-14)
    assert found.converged
    assert_allclose(found.point, other.x, atol=1e-8)
    assert_allclose(found.gradient, A @ found.point - b, atol=1e-12 * n)
    assert found.residual <= TOLERANCE
    assert found.residual == approx(kkt_violation(A, b, found.point, lower, upper), abs=1e-12 * n)


@settings(deadline=None, max_examples=30)
@given(st.integers(2, 30), seeds)
def test_the_energy_falls_at_every_iteration(minimise, random_matrix, random_bounds, n, seed):
    rng = np.random.default_rng(seed)
    A, b = random_matrix(rng, n, condition=1e3), 3 * rng.normal(size=n)
    lower, upper = random_bounds(rng, n)
    start = 5 * rng.normal(size=n)
    points = [
        minimise(A, b, lower, upper, start=start.copy(), max_iterations=k)[0].point
        for k in range(20)
    ]
    energies = np.array([0.5 * p @ A @ p - b @ p for p in points])
    assert (np.diff(energies) <= 1e-12 * np.abs(energies).max()).all()


@settings(deadline=None, max_examples=30)
@given(st.integers(5, 40), seeds)
def test_an_iteration_takes_one_product(minimise, random_matrix, random_bounds, n, seed):
    """Also if it reaches a bound. Recomputing the gradient counts as an iteration."""
    rng = np.random.default_rng(seed)
    A, b = random_matrix(rng, n), 3 * rng.normal(size=n)
    found, applied = minimise(A, b, *random_bounds(rng, n))
    assert found.converged
    assert len(applied) <= found.iterations + 2  # the first and the accepted gradient


@pytest.mark.parametrize("scale", [1e-6, 1e6])
def test_a_preconditioner_of_another_scale_costs_some_iterations(
    minimise, random_matrix, random_bounds, scale
):
    """The preconditioner sets the length of the first trial step, which is wrong here."""
    rng = np.random.default_rng(13)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    lower, upper = random_bounds(rng, 20)
    right, _ = minimise(A, b, lower, upper)
    wrong, _ = minimise(A, b, lower, upper, inverse=scale * np.eye(20))
    assert wrong.converged
    assert_allclose(wrong.point, right.point, atol=1e-9)
    assert wrong.iterations <= right.iterations + 25


def test_a_preconditioner_that_points_up_is_followed_down(minimise, random_matrix, random_bounds):
    """An approximate inverse may give an ascent direction."""
    rng = np.random.default_rng(17)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    bounds = random_bounds(rng, 20)
    right, _ = minimise(A, b, *bounds)
    found, _ = minimise(A, b, *bounds, inverse=-np.eye(20))
    assert found.converged
    assert_allclose(found.point, right.point, atol=1e-9)


def test_a_preconditioner_perpendicular_to_the_gradient_does_not_stall_it(
    minimise, random_matrix, random_bounds
):
    """Steps along the gradient itself replace steps that make no progress."""
    rng = np.random.default_rng(19)
    A, b = random_matrix(rng, 20), 3 * rng.normal(size=20)
    bounds = random_bounds(rng, 20)
    right, _ = minimise(A, b, *bounds)
    turned = np.kron(np.eye(10), [[0.0, -1.0], [1.0, 0.0]])
    found, _ = minimise(A, b, *bounds, inverse=turned, max_iterations=20_000)
    assert found.converged
    assert_allclose(found.point, right.point, atol=1e-9)


def test_without_bounds_it_is_conjugate_gradients(minimise, random_matrix):
    """It takes at most n steps in exact arithmetic, and one step with the exact inverse."""
    rng = np.random.default_rng(3)
    A, b = random_matrix(rng, 12, condition=5.0), rng.normal(size=12)
    free = np.full(12, np.inf)
    found, _ = minimise(A, b, -free, free)
    assert_allclose(found.point, np.linalg.solve(A, b), atol=1e-9)
    assert found.iterations <= 12 + 5  # and a recomputed gradient per factor 1e4
    at_once, applied = minimise(A, b, -free, free, inverse=np.linalg.inv(A))
    assert_allclose(at_once.point, np.linalg.solve(A, b), atol=1e-9)
    assert len(applied) <= 3  # first gradient, step, accepted gradient


def test_the_answer_is_believed_on_a_gradient_computed_there(minimise, random_matrix):
    """A gradient that is only updated along the steps drifts."""
    rng = np.random.default_rng(9)
    A, b = random_matrix(rng, 30), rng.normal(size=30)
    found, applied = minimise(A, b, np.full(30, -np.inf), np.full(30, np.inf))
    assert_array_equal(applied[-1], found.point)
    assert_allclose(found.gradient, A @ found.point - b, atol=1e-14)


def test_a_product_that_is_known_is_not_computed(minimise, random_matrix, random_bounds):
    rng = np.random.default_rng(11)
    A, b = random_matrix(rng, 30), 3 * rng.normal(size=30)
    bounds = random_bounds(rng, 30)
    start = np.clip(rng.normal(size=30), *bounds)
    found, products = minimise(A, b, *bounds, start=start.copy())
    known, fewer = minimise(A, b, *bounds, start=start.copy(), K_start=(A @ start)[:, None])
    assert_array_equal(fewer, products[1:])
    assert_array_equal(known.point, found.point)


@pytest.mark.parametrize("start", [-100.0, 0.5, 100.0, 1e12])
def test_a_start_outside_the_bounds_is_put_onto_them(minimise, random_matrix, start):
    rng = np.random.default_rng(4)
    A, b = random_matrix(rng, 6), 3 * rng.normal(size=6)
    lower, upper = np.zeros(6), np.ones(6)
    found, _ = minimise(A, b, lower, upper, start=np.full(6, start))
    assert_allclose(found.point, minimise(A, b, lower, upper)[0].point, atol=1e-9)
    assert found.converged


def test_an_optimal_start_costs_one_product(minimise):
    A = np.array([[2.0, 1.0], [1.0, 2.0]])
    # p = (1, 0): g = (0, 1) pushes p₂ against its lower bound
    found, applied = minimise(
        A, np.array([2.0, 0.0]), np.zeros(2), np.full(2, np.inf), start=np.array([1.0, 0.0])
    )
    assert found.converged
    assert (found.iterations, found.residual, len(applied)) == (0, 0.0, 1)
    assert_array_equal(found.point, [1.0, 0.0])
    assert_array_equal(found.gradient, [0.0, 1.0])


def test_values_worked_out_by_hand(minimise):
    A = np.array([[2.0, 1.0], [1.0, 2.0]])
    big = np.full(2, np.inf)
    # without bounds: (2, -1); with p₂ ≥ 0: (3/2, 0); with p₁ ≤ 1 too: (1, 0)
    b = np.array([3.0, 0.0])
    assert_allclose(minimise(A, b, -big, big)[0].point, [2, -1], atol=1e-9)
    assert_allclose(minimise(A, b, np.zeros(2), big)[0].point, [1.5, 0], atol=1e-9)
    assert_allclose(minimise(A, b, np.zeros(2), np.ones(2))[0].point, [1, 0], atol=1e-9)
    # tension allowed: p₂ ≥ −½ is active, p₁ = (3 + ½)/2
    tension = np.array([0.0, -0.5])
    assert_allclose(minimise(A, b, tension, big)[0].point, [1.75, -0.5], atol=1e-9)


def test_the_shape_is_that_of_the_input(minimise, random_matrix):
    rng = np.random.default_rng(5)
    A, b = random_matrix(rng, 12), rng.normal(size=12)
    flat, _ = minimise(A, b, np.zeros(12), np.ones(12))
    problem = BoundedQuadratic(
        lambda p, out=None: np.positive((A @ p.ravel()).reshape(3, 4), out=out),
        b.reshape(3, 4),
        np.zeros((3, 4)),
        np.ones((3, 4)),
    )
    shaped = minimise_quadratic(
        problem,
        start=np.zeros((3, 4)),
        precondition=np.positive,
        tolerance=TOLERANCE,
        max_iterations=500,
    )
    assert_allclose(shaped.point, flat.point.reshape(3, 4), atol=1e-12)


def test_without_a_load_nothing_moves_unless_the_bounds_move_it(minimise):
    A = np.diag([1.0, 2.0, 3.0])
    rest, applied = minimise(A, np.zeros(3), -np.ones(3), np.ones(3))
    assert rest.converged
    assert_array_equal(rest.point, np.zeros(3))
    assert (rest.iterations, len(applied)) == (0, 0)
    held, _ = minimise(A, np.zeros(3), np.array([0.5, -1, -1]), np.ones(3), start=np.ones(3))
    assert held.converged
    assert_allclose(held.point, [0.5, 0, 0], atol=1e-9)


@pytest.mark.parametrize("allowed", [0, 1, 3])
def test_too_few_iterations_are_reported_and_not_raised(
    minimise, random_matrix, kkt_violation, allowed
):
    rng = np.random.default_rng(6)
    A, b = random_matrix(rng, 30), 3 * rng.normal(size=30)
    lower, upper = np.zeros(30), np.full(30, np.inf)
    found, _ = minimise(A, b, lower, upper, max_iterations=allowed)
    assert not found.converged
    assert found.iterations == allowed
    assert found.residual > TOLERANCE
    assert found.residual == approx(kkt_violation(A, b, found.point, lower, upper), rel=1e-9)


def test_a_looser_tolerance_is_met_in_fewer_iterations(minimise, random_matrix):
    rng = np.random.default_rng(7)
    A, b = random_matrix(rng, 60, condition=30.0), rng.normal(size=60)
    lower, upper = np.zeros(60), np.full(60, 0.3)
    loose, _ = minimise(A, b, lower, upper, tolerance=1e-2)
    tight, _ = minimise(A, b, lower, upper, tolerance=1e-12)
    assert loose.converged
    assert tight.converged
    assert tight.residual <= 1e-12 < loose.residual <= 1e-2
    assert loose.iterations < tight.iterations


def test_a_mean_violation_is_over_the_nodes_that_may_move():
    """Three free nodes violate by 3, 4 and 0 (not counted); the fourth is held at its bound."""
    b = np.array([[3.0, 4.0, 0.0, -7.0]])
    found = minimise_quadratic(
        BoundedQuadratic(lambda p, out=None: 1.0 * p, b, 0.0, np.inf),
        start=np.zeros_like(b),
        precondition=lambda r, out=None: 1.0 * r,
        tolerance=3.6,
        max_iterations=0,
        mean_violation=True,
    )
    assert found.residual == approx(np.sqrt((9 + 16) / 2), rel=1e-12)
    assert found.converged


def test_violation_looks_only_where_a_node_may_move():
    lower, upper = np.zeros((1, 4)), np.ones((1, 4))
    p = np.array([[0.0, 1.0, 0.5, 0.5]])
    gradients = {
        (7.0, -7.0, 0.0, 0.0): 0,
        (-2.0, -7.0, 0.0, 0.0): 2,
        (7.0, 3.0, 0.0, 0.0): 3,
        (7.0, -7.0, 0.0, -4.0): 4,
    }
    b = np.array([[3.0, 1.0, -2.0, 0.0]])
    for g, expected in gradients.items():
        product = b + g
        assert violation(p, product, b, lower, upper) == expected
        assert_array_equal(product, [g])


@pytest.mark.parametrize("push", [1.0, -1.0])
def test_a_node_between_equal_bounds_is_held(minimise, push):
    """The pressure is prescribed there, so either sign of the gradient is optimal."""
    A = np.array([[2.0, 1.0], [1.0, 2.0]])
    lower, upper = np.array([0.5, 0.0]), np.array([0.5, 9.0])
    found, _ = minimise(A, np.array([5 * push, 2.5]), lower, upper)
    assert found.converged
    assert_allclose(found.point, [0.5, 1.0], atol=1e-9)


def test_it_does_not_cycle_on_an_ill_conditioned_matrix(minimise):
    A = np.array(
        [
            [15.91849023, -14.23225511, -25.1834665],
            [-14.23225511, 14.93316061, 27.634366],
            [-25.1834665, 27.634366, 80.14834916],
        ]
    )
    b = np.array([-2.97295187, 2.47269883, 2.88949394])
    assert np.linalg.cond(A) < 101
    found, _ = minimise(A, b, np.zeros(3), np.full(3, np.inf))
    assert found.converged
    assert_allclose(found.point, [0, b[1] / A[1, 1], 0], atol=1e-9)


def test_an_unreachable_tolerance_is_reported_and_not_raised(minimise, random_matrix):
    rng = np.random.default_rng(8)
    A, b = random_matrix(rng, 8), rng.normal(size=8)
    found, _ = minimise(A, b, np.zeros(8), np.full(8, np.inf), tolerance=-1.0)
    assert not found.converged
