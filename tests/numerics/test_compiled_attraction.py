"""The compiled loops of contacts with an attraction of finite range."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from compiled_loops import both, seeds, shapes
from restitution.numerics.expressions import (
    add_and_compare,
    continued_lennard_jones,
    descend,
    ends_above,
    lennard_jones,
    lennard_jones_chords,
    lennard_jones_totals,
)
from restitution.numerics.node_tables import tabulated_potential
from tolerance import approx

pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")


@pytest.mark.parametrize("single", [np.float32, np.float64])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_newton_steps_are_those_of_the_expressions(single, shape, seed):
    rng, near = np.random.default_rng(seed), {np.float32: 2e-6, np.float64: 1e-13}[single]
    p, slope, k = (rng.normal(size=shape).astype(single) for _ in range(3))
    outcomes = both(add_and_compare, p, slope, k, 0.5, np.empty_like(p))
    (ratio, (*_, sums)), (its_ratio, (*_, its_sums)) = outcomes
    assert its_ratio == approx(ratio, rel=near)
    assert_allclose(its_sums, sums, atol=near)
    for least in (0.5, 2.0, 9.0):
        ends, its_ends = (outcome[0] for outcome in both(ends_above, k, least))
        assert its_ends == ends
    p[0, 0] = np.nan
    assert all(
        np.isnan(outcome[0]) for outcome in both(add_and_compare, p, slope, k, 0.5, sums.copy())
    )


def descended(function, matrix, b, k, limits, zero_mean):
    """Results of `descend` with K = `matrix`: its ends, x, S x and the residual."""
    single, shape = b.dtype, b.shape
    rest, (x, Sx, z, Hd) = b.copy(), np.zeros((4, *shape), single)

    def product():
        z[...] = (matrix @ rest.ravel()).reshape(shape)

    d = (matrix @ rest.ravel()).reshape(shape).astype(single)
    ended = function(rest, d, (x, Sx, rest.copy(), z, Hd), k, product, limits, zero_mean)
    return ended, x, Sx, rest


@settings(deadline=None, max_examples=40)
@given(shapes, seeds, st.sampled_from([np.inf, 0.5, 50.0]), st.booleans(), st.floats(-1.5, 3))
def test_the_descent_is_that_of_the_expression(shape, seed, radius, zero_mean, softest):
    rng, n = np.random.default_rng(seed), shape[0] * shape[1]
    root = rng.normal(size=(n, n)) / np.sqrt(n)
    b, k = rng.normal(size=shape), rng.uniform(min(softest, 1.0), 4, shape)
    given = root @ root.T + 0.1 * np.eye(n), b, k, (1e-9, radius, 0.3, 6), zero_mean
    ended, *expected = descended(descend.__wrapped__, *given)
    its_ended, *compiled = descended(descend, *given)
    assert its_ended == ended
    for one, other in zip(expected, compiled, strict=True):
        assert_allclose(other, one, rtol=1e-6, atol=1e-9 * np.abs(given[1]).max())


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_the_descent_solves_the_system(shape, seed):
    rng, n = np.random.default_rng(seed), shape[0] * shape[1]
    root = rng.normal(size=(n, n)) / np.sqrt(n)
    matrix, b, k = root @ root.T + 0.1 * np.eye(n), rng.normal(size=shape), rng.uniform(0, 4, shape)
    for function in (descend, descend.__wrapped__):
        ended, x, Sx, _ = descended(function, matrix, b, k, (1e-22, np.inf, 1.0, 10 * n), False)
        assert ended == (False, False)
        exact = np.linalg.solve(np.linalg.inv(matrix) + np.diag(k.ravel()), b.ravel())
        assert x.ravel() == approx(exact, abs=1e-7 * np.abs(exact).max())
        assert (matrix @ Sx.ravel()) == approx(exact, abs=1e-7 * np.abs(exact).max())


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_the_lennard_jones_law_is_that_of_the_expression(shape, seed):
    gap = 3e-10 * np.random.default_rng(seed).uniform(0.8, 30, shape)
    empty = [np.empty_like(gap) for _ in range(3)]
    (_, expected), (_, compiled) = both(lennard_jones, gap, 0.05, 3e-10, *empty)
    for one, other in zip(expected[3:], compiled[3:], strict=True):
        assert_allclose(other, one, rtol=1e-12, atol=1e-14 * np.abs(one).max())
    totals, its_totals = (
        outcome[0] for outcome in both(lennard_jones_totals, gap, -1e-10, 3.6e-10, (0.05, 3e-10))
    )
    assert its_totals == approx(totals, rel=1e-11)


@settings(deadline=None, max_examples=25)
@given(shapes, seeds, st.booleans())
def test_the_bounded_law_and_its_chords_are_those_of_the_expressions(shape, seed, yields):
    rng, law = np.random.default_rng(seed), (0.05, 3e-10)
    base, u = 3e-10 * rng.uniform(0.5, 3, shape), 3e-11 * rng.uniform(-1, 1, shape)
    p = 10 ** rng.uniform(6, 11, shape) * rng.choice([-1, 1], shape)
    row = np.broadcast_to(3e-10 * rng.uniform(0.6, 0.9, shape[1]), shape)  # one for all rows
    bound = rng.uniform(1e9, 1e10, shape)
    stiff = np.zeros(shape) if yields else rng.uniform(1e18, 1e20, shape)
    empty = [np.empty(shape) for _ in range(4)]
    (_, expected), (_, compiled) = both(
        continued_lennard_jones, base, u, (row, bound, stiff), law, *empty[:3]
    )
    for one, other in zip(expected[4:], compiled[4:], strict=True):
        assert_allclose(other, one, rtol=1e-12, atol=1e-14 * np.abs(one).max())
    known = p, *expected[5:]
    soft = np.zeros(shape) if yields else 1 / stiff
    for least_way in (1e-13, 3e-11):
        arguments = base, u, known, (bound, soft), law, least_way, empty[3]
        (_, expected), (_, compiled) = both(lennard_jones_chords, *arguments)
        assert_allclose(compiled[-1], expected[-1], rtol=1e-6)
        assert (expected[-1] != known[2]).any() or p.size < 40


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_the_potential_of_tables_is_that_of_the_expression(shape, seed):
    rng = np.random.default_rng(seed)
    rows, cells = 3, 8
    first, step = rng.uniform(-1, 0, shape), rng.uniform(0.1, 0.3, shape)
    gap = first + step * rng.uniform(-3, 14, shape)  # below, in and beyond the table
    row, middle = rng.integers(0, rows, shape), first - rng.uniform(0.1, 1, shape)
    tables = rng.standard_normal((rows * cells, 5)), rng.standard_normal((rows, 3))
    nodes = np.concatenate([first, step, middle])
    (_, expected), (_, compiled) = both(
        tabulated_potential, gap, row, nodes, *tables, np.empty_like(nodes)
    )
    for one, other in zip(np.split(expected[-1], 3), np.split(compiled[-1], 3), strict=True):
        assert_allclose(other, one, rtol=1e-11, atol=1e-12 * np.abs(one).max())


def test_a_node_without_a_row_is_refused():
    nodes, row = np.ones((3, 1)), np.array([[3]])
    with pytest.raises(IndexError):
        tabulated_potential(
            nodes[:1], row, nodes, np.ones((6, 5)), np.ones((3, 3)), np.ones((3, 1))
        )
