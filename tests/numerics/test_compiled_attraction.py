"""The compiled loops of contacts with an attraction of finite range."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from compiled_loops import both, seeds, shapes
from restitution.numerics.expressions import (
    add_curvature,
    advance,
    continued_lennard_jones,
    largest_ratio,
    lennard_jones,
    lennard_jones_chords,
    redirect,
)
from restitution.numerics.node_tables import tabulated_potential
from tolerance import approx

pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")


@pytest.mark.parametrize("single", [np.float32, np.float64])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_newton_steps_are_those_of_the_expressions(single, shape, seed):
    rng, near = np.random.default_rng(seed), {np.float32: 2e-6, np.float64: 1e-13}[single]
    x, Sx, rest, d, Sd, k, z = (rng.normal(size=shape).astype(single) for _ in range(7))
    (sum_, (*_, Hd)), (its_sum, (*_, its_Hd)) = both(add_curvature, d, Sd, k, np.empty_like(d))
    assert_allclose(its_Hd, Hd, atol=near)
    assert its_sum == approx(sum_, abs=near * d.size)
    moved, its_moved = (outcome[1] for outcome in both(advance, x, Sx, rest, d, Sd, Hd, 0.7))
    turned, its_turned = (outcome[1] for outcome in both(redirect, d, Sd, z, rest, 0.3))
    for expected, compiled in zip(
        (*moved[:3], *turned[:2]), (*its_moved[:3], *its_turned[:2]), strict=True
    ):
        assert_allclose(compiled, expected, atol=near)
    ratio, its_ratio = (outcome[0] for outcome in both(largest_ratio, x, k, 0.5))
    assert its_ratio == approx(ratio, rel=near)
    x[0, 0] = np.nan
    assert all(np.isnan(outcome[0]) for outcome in both(largest_ratio, x, k, 0.5))


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_the_lennard_jones_law_is_that_of_the_expression(shape, seed):
    gap = 3e-10 * np.random.default_rng(seed).uniform(0.8, 30, shape)
    empty = [np.empty_like(gap) for _ in range(3)]
    (_, expected), (_, compiled) = both(lennard_jones, gap, 0.05, 3e-10, *empty)
    for one, other in zip(expected[3:], compiled[3:], strict=True):
        assert_allclose(other, one, rtol=1e-12, atol=1e-14 * np.abs(one).max())


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
