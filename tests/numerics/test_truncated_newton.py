"""Minimisation of an energy that is not convex."""

import numpy as np
import pytest

from restitution.contact.influence import half_space, periodic_half_space
from restitution.numerics.truncated_newton import minimise_locally
from tolerance import approx

SHAPE = (7, 6)


@pytest.fixture(name="K")
def operator():
    return half_space(SHAPE, (1.0, 1.2), 1.0)


def matrix(K):
    unit = np.eye(SHAPE[0] * SHAPE[1])
    return np.array([K(row.reshape(SHAPE)).ravel() for row in unit])


def minimise(K, potential, p=None, tolerance=1e-10):
    p = np.zeros(SHAPE) if p is None else p
    return minimise_locally(K, potential, start=(p, K(p)), length=0.5, tolerance=tolerance)


def test_springs_are_solved_as_by_a_dense_matrix(K):
    rng = np.random.default_rng(0)
    k, rest = rng.uniform(0.1, 5, SHAPE), rng.normal(size=SHAPE)

    def springs(u):
        return 0.5 * k * (u - rest) ** 2, k * (u - rest), k

    found = minimise(K, springs)
    assert found.converged
    assert not found.negative_curvature
    S = np.linalg.inv(matrix(K))
    exact = np.linalg.solve(S + np.diag(k.ravel()), (k * rest).ravel())
    assert found.u.ravel() == approx(exact, rel=1e-8)
    assert found.p.ravel() == approx(S @ exact, rel=1e-7)
    assert found.energy == approx(0.5 * exact @ S @ exact + springs(exact.reshape(SHAPE))[0].sum())


def test_an_operator_without_mean_is_solved_at_mean_zero():
    rng = np.random.default_rng(0)
    k, rest = rng.uniform(0.1, 5, SHAPE), 1 + rng.normal(size=SHAPE)
    K = periodic_half_space(SHAPE, (1.0, 1.2), 1.0)

    def springs(u):
        return 0.5 * k * (u - rest) ** 2, k * (u - rest), k

    start = rng.normal(size=SHAPE)
    found = minimise_locally(
        K, springs, start=(start, K(start)), length=0.5, tolerance=1e-10, zero_mean=True
    )
    assert found.converged
    # The multiplier m of the zero mean is the last unknown: S u + k (u - rest) = m, Σ u = 0.
    n = rest.size
    system = np.ones((n + 1, n + 1))
    system[:n, :n] = np.linalg.pinv(matrix(K), rcond=1e-10) + np.diag(k.ravel())
    system[n, n] = 0.0
    exact = np.linalg.solve(system, np.append((k * rest).ravel(), 0.0))[:n]
    assert found.u.ravel() == approx(exact, abs=1e-8)
    assert found.p == approx(-springs(found.u)[1], abs=1e-8)


def wells(u):
    """Two wells at each node, at u = ±1, deep enough to hold a node apart from its neighbours."""
    return 3 * (u**2 - 1) ** 2, 12 * u * (u**2 - 1), 12 * (3 * u**2 - 1)


def test_the_end_is_a_minimum_even_from_a_maximum(K):
    start = 1e-3 * np.random.default_rng(1).normal(size=SHAPE)
    found = minimise(K, wells, start)
    assert found.converged
    assert found.negative_curvature
    _, slope, k = wells(found.u)
    assert found.p + slope == approx(np.zeros(SHAPE), abs=1e-7)
    hessian = np.linalg.inv(matrix(K)) + np.diag(k.ravel())
    assert np.linalg.eigvalsh(0.5 * (hessian + hessian.T)).min() > 0
    assert np.isclose(K(found.p), found.u, rtol=1e-12, atol=1e-14).all()


def test_a_minimum_is_kept(K):
    first = minimise(K, wells, np.full(SHAPE, 0.5))
    again = minimise(K, wells, first.p)
    assert again.steps == 0
    assert again.energy == approx(first.energy, rel=1e-12)


def test_it_says_when_it_has_not_converged(K):
    def edge(u):  # a kink keeps the gradient away from zero
        return 5 * np.abs(u - 1), 5 * np.sign(u - 1), np.zeros(SHAPE)

    found = minimise(K, edge)
    assert not found.converged
    assert found.residual > 1e-3


def steep(u):
    """φ = √(1 + (40 (u − 1))²)/5: Newton's steps from far away overshoot more and more."""
    root = np.sqrt(1 + (40 * (u - 1)) ** 2)
    return 0.2 * root, 320 * (u - 1) / root, 320 / root**3


def test_the_trust_region_saves_steps_and_products():
    """Sums over problems that need it, and 3 % more: a step is refused if the energy rises."""
    near = [1e-3 * np.random.default_rng(seed).normal(size=SHAPE) for seed in range(6)]
    far = 2 * np.random.default_rng(9).normal(size=SHAPE)
    problems = [(steep, np.zeros(SHAPE)), (steep, np.full(SHAPE, -3.0))]
    problems += [(wells, start) for start in (*near, far)]
    steps = products = 0
    for potential, start in problems:
        K = half_space(SHAPE, (1.0, 1.2), 1.0)
        energy = 0.5 * np.vdot(start, K(start)) + potential(K(start))[0].sum()
        K = half_space(SHAPE, (1.0, 1.2), 1.0)
        found = minimise(K, potential, start)
        assert found.converged
        assert found.energy < energy
        steps, products = steps + found.steps, products + K.count
    assert steps <= 139
    assert products <= 607


@pytest.mark.parametrize("seed", range(3))
def test_steps_on_the_part_that_matters_find_the_same_minimum(seed):
    rng, shape = np.random.default_rng(seed), (40, 45)
    part = slice(12, 24), slice(15, 30)
    k, rest = np.full(shape, 1e-4), rng.normal(size=shape)
    k[part] = rng.uniform(0.1, 5, (12, 15))

    def springs(u):
        return 0.5 * k * (u - rest) ** 2, k * (u - rest), k

    def operator_of(shape):
        made.append((shape, half_space(shape, (1.0, 1.2), 1.0)))
        return made[-1][1]

    made, p, ends = [], np.zeros(shape), []
    for smaller in (None, operator_of):
        K = half_space(shape, (1.0, 1.2), 1.0)
        ends.append(
            minimise_locally(
                K, springs, start=(p, p), length=0.5, tolerance=1e-9, operator_of=smaller
            )
        )
    whole, by_parts = ends
    assert by_parts.converged
    assert by_parts.residual <= 1e-9
    assert by_parts.u == approx(whole.u, abs=1e-8)
    assert by_parts.energy == approx(whole.energy, rel=1e-9)
    assert {shape for shape, _ in made} == {(12, 15)}
    assert sum(K.count for _, K in made) > 5


def test_from_far_away_both_starts_end_in_the_only_minimum(K):
    one, other = (minimise(K, steep, np.full(SHAPE, start)) for start in (0.0, -3.0))
    assert not one.negative_curvature
    assert one.energy == approx(other.energy, rel=1e-9)
    assert one.u == approx(other.u, rel=1e-6)


@pytest.mark.parametrize("length", [0.5, 0.2])
def test_the_first_step_along_negative_curvature_has_the_given_length(K, length):
    asked = []

    def watched(u):
        asked.append(u.copy())
        return wells(u)

    start = 1e-3 * np.random.default_rng(1).normal(size=SHAPE)
    minimise_locally(K, watched, start=(start, K(start)), length=length, tolerance=1e-10)
    assert np.abs(asked[1] - asked[0]).max() == approx(length, rel=1e-4)


def test_no_product_uses_the_threads_of_blas(K, monkeypatch):
    """They wait in a loop, which costs seven times the CPU time beside busy processes."""
    rest = np.linspace(-1, 1, SHAPE[0] * SHAPE[1]).reshape(SHAPE)

    def springs(u):
        return 0.5 * (u - rest) ** 2, u - rest, np.ones(SHAPE)

    expected = minimise(K, springs).u
    for name in ("vdot", "dot", "inner", "matmul", "tensordot"):
        monkeypatch.setattr(np, name, lambda *_: pytest.fail("BLAS"))
    assert minimise(K, springs).u == approx(expected)
