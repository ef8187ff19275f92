"""The step on few nodes goes to their minimum within the bounds."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import solve_triangular
from scipy.optimize import lsq_linear

from compiled_loops import seeds
from restitution.contact.influence import (
    half_space,
    inverse_half_space,
    periodic_half_space,
    sprung_half_space,
)
from restitution.numerics.kernels import loops
from restitution.numerics.quadratic.few_nodes import few_free, minimum_on, step_on_few
from restitution.numerics.quadratic.fused_ops import as_rows
from restitution.numerics.quadratic.minimise import BoundedQuadratic, minimise_quadratic
from tolerance import approx

SHAPE, SPACING, E = (23, 31), (1.0, 1.7), 2.0
compiled = pytest.param(True, marks=pytest.mark.skipif(loops is None, reason="not compiled"))


def problem(rng, nodes):
    """A point with pressures on both bounds, its gradient, the bounds and the matrix of `nodes`."""
    K = half_space(SHAPE, SPACING, E)
    lower, upper = -rng.uniform(0, 0.5, SHAPE), rng.uniform(0.3, 1, SHAPE)
    p = np.clip(rng.normal(size=SHAPE), lower, upper)
    units = np.zeros((nodes.shape[1], *SHAPE))
    units[np.arange(nodes.shape[1]), nodes[0], nodes[1]] = 1
    A = np.array([K(unit)[tuple(nodes)] for unit in units])
    return K, p, rng.normal(size=SHAPE), (lower, upper), A


def some_nodes(rng, count):
    return np.array(np.unravel_index(rng.choice(np.prod(SHAPE), count, replace=False), SHAPE))


@pytest.mark.parametrize("loop", [compiled, False])
@settings(deadline=None, max_examples=30)
@given(st.integers(1, 40), seeds)
def test_the_step_is_that_of_a_least_squares_solver(loop, count, seed):
    rng = np.random.default_rng(seed)
    nodes = some_nodes(rng, count)
    K, p, g, bounds, A = problem(rng, nodes)
    at = tuple(nodes)
    d = rng.normal(size=SHAPE)
    if loop:
        descent = minimum_on(nodes, K.lags, p, g, bounds, d)
    else:
        expression = getattr(step_on_few, "__wrapped__", step_on_few)
        descent = expression(d, nodes, K.lags(*SHAPE), p, g, bounds, (1e-5, 100))
    L = np.linalg.cholesky(A)  # ½dᵀAd + dᵀg = ½|Lᵀd + L⁻¹g|² + constant
    least, most = (bound[at] - p[at] for bound in bounds)
    c = -solve_triangular(L, g[at], lower=True)
    best = lsq_linear(L.T, c, (least, most), method="bvls", tol=1e-14).x
    assert_allclose(d[at], best, atol=1e-4 * np.abs(best).max())
    assert descent == approx(float((g * d).sum()), rel=1e-12)
    assert np.count_nonzero(d) <= count
    d[at] = 0
    assert_array_equal(d, 0)


@settings(deadline=None, max_examples=30)
@given(seeds)
def test_a_step_to_a_bound_ends_on_it(seed):
    rng = np.random.default_rng(seed)
    nodes = some_nodes(rng, 30)
    K, p, g, (lower, upper), _ = problem(rng, nodes)
    d = np.empty(SHAPE)
    minimum_on(nodes, K.lags, p, 10 * g, (lower, upper), d)
    at = tuple(nodes)
    least, most = (bound[at] - p[at] for bound in (lower, upper))
    to_lower, to_upper = d[at] <= least, d[at] >= most
    assert to_lower.any()
    assert to_upper.any()
    assert_array_equal(d[at][to_lower], least[to_lower])
    assert_array_equal(d[at][to_upper], most[to_upper])


@pytest.mark.parametrize(
    "make", [half_space, periodic_half_space, sprung_half_space], ids=lambda make: make.__name__
)
def test_the_lags_are_those_of_the_operator(make):
    """Along both axes, for a grid and cells that are not square."""
    K, p = make(SHAPE, SPACING, E), np.zeros(SHAPE)
    p[5, 8] = 1.0
    i, j = (np.abs(np.arange(n) - at) for n, at in zip(SHAPE, (5, 8), strict=True))
    lags = K.lags(18, 23)
    assert lags.shape == (23, 18)
    response = lags[j[:, None], i].T
    assert response == approx(K(p), rel=1e-9)
    assert K.lags(2, 3) == approx(lags[:3, :2], rel=1e-12)


def test_many_free_nodes_are_left_to_the_gradient():
    r = np.zeros((90, 100), np.float32)
    r[3, 5] = r[80, 99] = -1
    assert_array_equal(few_free(r), [[3, 80], [5, 99]])
    r[:, 0] = 1
    assert few_free(r).shape == (2, 92)
    r[:4] = 1
    assert few_free(r) is None


@pytest.mark.parametrize("make", [half_space, periodic_half_space])
def test_few_free_nodes_take_few_products(make):
    """The same minimum as by the preconditioned gradient alone, in fewer steps."""
    shape, steps = (60, 66), np.zeros(2)
    for seed in range(10):
        rng = np.random.default_rng(seed)
        b, upper = rng.normal(size=shape), rng.uniform(0.02, 0.03, shape)
        K, found = make(shape, SPACING, E), []
        made = BoundedQuadratic.of(K, b - 1.0 * (make is half_space), 0.0, upper)
        for each in (replace(made, lags=None), made):
            found.append(
                minimise_quadratic(
                    each,
                    start=np.zeros(shape),
                    precondition=inverse_half_space(shape, SPACING, E),
                    tolerance=1e-8,
                    max_iterations=100,
                )
            )
            assert found[-1].converged
        assert_allclose(found[1].point, found[0].point, atol=1e-6)
        steps += [minimum.iterations for minimum in found]
    assert steps[1] <= 0.6 * steps[0]


def test_nodes_without_progress_are_left_to_the_gradient():
    """The lags of another operator give useless steps; the solve still ends."""
    shape = 40, 44
    K = half_space(shape, SPACING, E)
    b = np.random.default_rng(1).normal(size=shape) - 1
    stiff = BoundedQuadratic(
        K, b, 0.0, 0.02, K.single_precision, lambda rows, columns: 1e3 * K.lags(rows, columns)
    )
    found = minimise_quadratic(
        stiff,
        start=np.zeros(shape),
        precondition=inverse_half_space(shape, SPACING, E),
        tolerance=1e-8,
        max_iterations=100,
    )
    assert found.converged
    assert_allclose(K(found.point) - b, found.gradient, atol=1e-8)


@pytest.mark.skipif(loops is None, reason="not compiled")
@pytest.mark.parametrize("nodes", [[[0, 3], [0, 9]], [[-1], [0]], [[4], [0]], [[0, 0], [0, 6]]])
def test_nodes_outside_are_refused(nodes):
    d, p = np.empty((4, 8)), np.zeros((4, 8))
    with pytest.raises(ValueError, match="outside"):
        step_on_few(d, np.array(nodes), np.ones((6, 4)), p, p, as_rows(0.0, 1.0, p), (0.1, 1))
