"""The compiled loops, compared with the array expressions."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from compiled_loops import both, seeds, shapes
from restitution.numerics import kernels
from restitution.numerics.contours import contour_means
from restitution.numerics.expressions import (
    diffuse,
    max_magnitude,
    multipoles,
)
from restitution.numerics.growing_bound import growing_bound, step_sums
from restitution.numerics.quadratic import fused_ops
from restitution.numerics.quadratic.fused_ops import (
    as_rows,
    curvature,
    dot_products,
    projected_direction,
    projected_gradient,
    squares,
    take_step,
    violates_bounds,
)
from restitution.numerics.quadratic.grid_transfer import prolong, restrict
from restitution.numerics.quadratic.local_mean import local_sums, subtract_local_mean
from restitution.numerics.quadratic.near_filter import filter_near
from restitution.numerics.relief import lowest_downhill, ridge_shape
from tolerance import approx

pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")


def bounds(rng, kind, shape):
    """Bounds: only p ≥ 0, two numbers, or arrays with some infinite values."""
    if kind == "contact":
        return 0.0, np.inf
    if kind == "numbers":
        return -0.3, 0.7
    lower = np.where(rng.random(shape) < 0.3, -np.inf, rng.uniform(-1, 0.2, shape))
    return lower, np.where(rng.random(shape) < 0.3, np.inf, rng.uniform(0.3, 1, shape))


def as_type(bound, dtype):
    return bound.astype(dtype) if isinstance(bound, np.ndarray) else bound


def point(rng, lower, upper, shape):
    """A point with many nodes on the bounds."""
    return np.clip(2 * rng.normal(size=shape), lower, upper)


@pytest.mark.parametrize("kind", ["contact", "numbers", "arrays"])
@pytest.mark.parametrize(
    ("point_type", "single"),
    [(np.float64, np.float32), (np.float64, np.float64), (np.float32, np.float32)],
)
@settings(deadline=None, max_examples=25)
@given(shapes, seeds, st.sampled_from([0.0, 0.4, 1.0, 1.7]))
def test_a_step_is_that_of_the_expressions(point_type, single, kind, shape, seed, step):
    rng = np.random.default_rng(seed)
    box = [as_type(bound, point_type) for bound in bounds(rng, kind, shape)]
    p, g, b = (
        values.astype(point_type)
        for values in (point(rng, *box, shape), *rng.normal(size=(2, *shape)))
    )
    box = as_rows(*box, p)
    g[rng.random(shape) < 0.2] = 0.0
    d, r, z, Kd, out = (rng.normal(size=shape).astype(single) for _ in range(5))

    (most, (_, slope, *_, left)), (its_most, (_, its_slope, *_, its_left)) = both(
        projected_gradient, p, g + b, b, box, out
    )
    assert most == its_most == approx(np.abs(left).max(), rel=1e-7)
    assert_array_equal(slope, its_slope)
    assert_array_equal(left, its_left)

    (found, (its_d, *_)), (compiled, (compiled_d, *_)) = both(
        projected_direction, d, 0.3, z, 0.8, p, g, r, box
    )
    rounding = 1 if point_type == np.float64 else 4  # p + d and its end round differently
    assert_allclose(compiled_d, its_d, rtol=rounding * 1e-7, atol=rounding * 2e-7)
    assert compiled[0] == approx(found[0], abs=1e-5)
    if point_type == np.float64:  # in single precision, rounding decides at a bound
        assert compiled[1] == found[1]
        ends = [bool(outcome) for outcome, _ in both(violates_bounds, p, compiled_d, step, box)]
        assert ends[0] == ends[1]

    (most, its), (its_most, compiled) = both(take_step, p, g, compiled_d, Kd, step, box, out)
    for which in (0, 1, -1):
        assert_allclose(compiled[which], its[which], rtol=rounding * 1e-7, atol=rounding * 1e-6)
    assert most == np.abs(its[-1]).max()
    assert its_most == np.abs(compiled[-1]).max()


@pytest.mark.parametrize("compiled", [True, False])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_a_step_to_a_bound_ends_on_it(compiled, shape, seed):
    """If it ended a rounding error away, the next iteration would treat the node as free."""
    rng = np.random.default_rng(seed)
    direction, step = (
        function if compiled else function.__wrapped__
        for function in (projected_direction, take_step)
    )
    lower, upper = bounds(rng, "arrays", shape)
    p, g = point(rng, lower, upper, shape), rng.normal(size=shape)
    d, z, r, Kd = np.zeros(shape), 5 * rng.normal(size=shape), g.copy(), rng.normal(size=shape)
    box = lower, upper
    free = fused_ops._free(p, g, box)
    wanted = np.where(free, p - z, p)
    direction(d, 1.0, z, 1.0, p, g, r, box)
    step(p, g, d, Kd, 1.0, box, r)
    assert_array_equal(p[wanted <= lower], lower[wanted <= lower])
    assert_array_equal(p[wanted >= upper], upper[wanted >= upper])


@pytest.mark.parametrize("single", [np.float32, np.float64])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_sums_and_peaks_are_those_of_the_expressions(single, shape, seed):
    rng = np.random.default_rng(seed)
    a, b, c = (rng.normal(size=shape).astype(single) for _ in range(3))
    for operation, *args in (
        (max_magnitude, a),
        (curvature, a, b),
        (dot_products, a, b, c),
        (squares, np.where(c > 0, a, 0)),
    ):
        (found, _), (compiled, _) = both(operation, *args)
        assert_allclose(compiled, found, rtol=1e-6, atol=1e-5)


@pytest.mark.parametrize("single", [np.float32, np.float64])
@settings(deadline=None, max_examples=40)
@given(shapes, st.sampled_from([(2, 2), (3, 5), (8, 8)]), seeds)
def test_means_around_places_are_those_of_the_expressions(single, shape, places, seed):
    rng = np.random.default_rng(seed)
    r = rng.normal(size=shape).astype(single)
    r[rng.random(shape) < 0.3] = 0.0
    mask = r.copy()
    r[rng.random(shape) < 0.5] += 1
    (_, (*_, sums, nodes)), (_, (*_, its_sums, its_nodes)) = both(
        local_sums, r, mask, np.empty(places), np.empty(places)
    )
    assert_allclose(its_sums, sums, atol=1e-4)
    assert_allclose(its_nodes, nodes, atol=1e-4)
    assert sums.sum() == approx(r.sum(where=mask != 0), abs=1e-4)
    assert nodes.sum() == approx(np.count_nonzero(mask))
    (_, (*_, lowered)), (_, (*_, compiled)) = both(
        subtract_local_mean, r, mask, 0.6, sums, nodes, np.full_like(r, 9)
    )
    assert_allclose(compiled, lowered, atol=1e-4)
    assert_array_equal(lowered == 0, mask == 0)


def test_a_constant_on_a_part_is_lowered_to_a_share_of_it():
    """This holds for any subset of the nodes."""
    rng = np.random.default_rng(11)
    r = 2.0 * (rng.random((60, 45)) < 0.4)
    sums, nodes = np.empty((2, 8, 8))
    local_sums(r, r, sums, nodes)
    found = np.empty_like(r)
    subtract_local_mean(r, r, 0.75, sums, nodes, found)
    assert_allclose(found, 0.25 * r, atol=1e-12)


def test_threads_share_the_rows_and_change_nothing(threads):
    """Sums agree to the last digit."""
    rng = np.random.default_rng(5)
    shape = (1701, 1300)  # large enough for threads even in single precision
    p, g = rng.random(shape), rng.normal(size=shape)
    d, r, z, r_old, Kd = rng.normal(size=(5, *shape)).astype(np.float32)
    box = as_rows(0.0, 0.9, p)
    sums, nodes = np.empty((2, 8, 8))
    fine, moments = np.empty((2 * shape[0], 2 * shape[1] - 1)), rng.normal(size=(3, 3))
    kernel = rng.normal(size=(4, 4))
    x, y = (rng.uniform(1, 9, size) for size in ((shape[0], 1), (1, shape[1])))

    def everything():
        its_p, its_g, its_d, its_r = p.copy(), g.copy(), d.copy(), r.copy()
        return [
            projected_gradient(p, its_g, p, box, its_r),
            its_r.copy(),
            its_g.copy(),
            dot_products(z, r, r_old),
            projected_direction(its_d, 0.3, z, 0.8, p, g, r, box),
            its_d,
            curvature(its_d, Kd),
            max_magnitude(g),
            local_sums(r, d, sums, nodes),
            sums.copy(),
            nodes.copy(),
            subtract_local_mean(r, d, 0.1, sums, nodes, its_r),
            its_r.copy(),
            take_step(its_p, its_g, its_d, Kd, 1.0, box, its_r),
            its_p,
            its_g,
            its_r,
            prolong(p, fine),
            fine.copy(),
            restrict(fine, its_g),
            its_g.copy(),
            multipoles(x, y, moments, its_g),
            its_g.copy(),
            filter_near(p, kernel, 2.0, its_g),
            its_g,
        ]

    found = everything()
    kernels.loops.use_threads(1)
    for one, other in zip(found, everything(), strict=True):
        assert_array_equal(one, other)


@pytest.mark.parametrize("single", [np.float32, np.float64])
@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_what_is_not_finite_is_no_small_violation(single, bad, shape, seed):
    """If the maximum ignored NaN, the solve would count as converged."""
    rng = np.random.default_rng(seed)
    p, g = rng.random(shape) + 1, rng.normal(size=shape)
    out, d, Kd = np.empty(shape, single), np.zeros(shape, single), np.zeros(shape, single)
    box = as_rows(0.0, np.inf, p)
    g[tuple(rng.integers(0, shape))] = bad
    values = g.astype(single)
    for largest in (
        projected_gradient(p, g.copy(), p, box, out),
        take_step(p, g, d, Kd, 1.0, box, out),
        max_magnitude(values),
        curvature(d, values)[1],
    ):
        assert not largest < np.inf


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_going_between_grids_is_that_of_the_expressions(dtype, shape, seed):
    rng = np.random.default_rng(seed)
    halves = [(n + 1) // 2 for n in shape]
    fine, coarse = (rng.normal(size=size).astype(dtype) for size in (shape, halves))
    few = 50 * np.finfo(dtype).eps
    for operation, *args in ((restrict, fine, coarse), (prolong, coarse, fine)):
        (_, (_, expected)), (_, (_, found)) = both(operation, *args)
        assert_allclose(found, expected, rtol=few, atol=few)


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_sums_of_a_plastic_step_are_those_of_the_expressions(shape, seed):
    rng = np.random.default_rng(seed)
    now, before, begun, bound = rng.normal(size=(4, *shape))
    before[rng.random(shape) < 0.3] = 0.0
    row = np.broadcast_to(begun[0], shape)  # a bound that is a number
    for first in (begun, row):
        (expected, _), (found, _) = both(step_sums, now, before, first, bound)
        assert_allclose(found, expected, rtol=1e-9, atol=1e-11)
        assert found[1] + found[2] == approx(((now - before) * (bound - first)).sum(), abs=1e-9)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_a_filter_of_near_nodes_is_that_of_the_expression(dtype, shape, seed):
    rng = np.random.default_rng(seed)
    r, kernel = rng.normal(size=shape).astype(dtype), rng.normal(size=(4, 4))
    few = 200 * np.finfo(dtype).eps
    (_, (*_, expected)), (_, (*_, found)) = both(filter_near, r, kernel, 0.3, np.empty_like(r))
    assert_allclose(found, expected, rtol=few, atol=few)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@settings(deadline=None, max_examples=40)
@given(shapes, seeds, st.sampled_from([0.0, 0.2]))
def test_a_bound_that_grows_is_that_of_the_expressions(dtype, shape, seed, hardening):
    rng = np.random.default_rng(seed)
    pressure = np.maximum(rng.normal(size=shape), 0).astype(dtype)
    smooth = rng.normal(size=(shape[0], 1)), rng.normal(size=(1, shape[1]))
    gaps = 1.5 * rng.random(shape), rng.random(shape)  # some crests are deeper than δ
    constants = 0.1, 0.04, 0.25, hardening
    (_, (*_, expected)), (_, (*_, found)) = both(
        growing_bound,
        pressure,
        smooth,
        gaps,
        (1.0, 2.0),
        rng.random(shape) - 0.2,
        constants,
        (0.11, 1.1, 0.25),
        np.full(shape, 9.0),
    )
    assert_allclose(found, expected, rtol=1e-12)
    assert_allclose(found[pressure == 0], 0.1, rtol=1e-15)


@settings(deadline=None, max_examples=50)
@given(st.tuples(st.integers(1, 9), st.integers(1, 20)), seeds, st.booleans(), st.booleans())
def test_means_over_contours_are_those_of_the_expressions(shape, seed, with_ties, periodic):
    rng = np.random.default_rng(seed)
    heights = rng.integers(-1, 4, shape).astype(float) if with_ties else rng.normal(size=shape)
    (_, (*_, expected)), (_, (*_, found)) = both(
        contour_means, heights, periodic, np.full(shape, 9.0)
    )
    assert_allclose(found, expected, rtol=1e-12)
    assert np.all((found > 0) == (heights > 0))


@settings(deadline=None, max_examples=50)
@given(st.tuples(st.integers(1, 9), st.integers(1, 20)), seeds, st.booleans())
def test_ridges_and_descents_are_those_of_the_expressions(shape, seed, with_ties):
    rng = np.random.default_rng(seed)
    heights = rng.integers(0, 4, shape).astype(float) if with_ties else rng.normal(size=shape)
    (_, (*_, expected)), (_, (*_, found)) = both(
        ridge_shape, heights, 0.5, 0.7, np.full(shape, 9.0)
    )
    assert_allclose(found, expected, rtol=1e-9, atol=1e-12)
    (_, (_, expected)), (_, (_, found)) = both(lowest_downhill, heights, np.full(shape, 9.0))
    assert_array_equal(found, expected)


@settings(deadline=None, max_examples=25)
@given(st.integers(1, 30), st.integers(0, 5), seeds)
def test_spreading_is_that_of_the_expression(nodes, steps, seed):
    rng = np.random.default_rng(seed)
    neighbours, weights = rng.integers(0, nodes, (nodes, 9)), rng.random((nodes, 9)) / 5
    (_, (*_, expected)), (_, (*_, have)) = both(
        diffuse, neighbours, weights, steps, rng.random((nodes, 2))
    )
    assert_allclose(have, expected, rtol=1e-12)


@settings(deadline=None, max_examples=25)
@given(shapes, seeds)
def test_multipoles_are_those_of_the_expression(shape, seed):
    rng = np.random.default_rng(seed)
    x, y = rng.uniform(1, 9, (shape[0], 1)), rng.uniform(-9, 9, (1, shape[1]))
    (_, (*_, expected)), (_, (*_, have)) = both(
        multipoles, x, y, rng.normal(size=(3, 3)), np.empty(shape)
    )
    assert_allclose(have, expected, rtol=1e-11, atol=1e-13)


def test_a_loop_refuses_arrays_whose_results_would_be_lost():
    fine = np.zeros((8, 12))
    for coarse in (
        np.zeros((4, 6), np.float16),  # would need conversion
        np.zeros((4, 12))[:, ::2],  # rows not contiguous
        np.broadcast_to(np.zeros(6), (4, 6)),  # read-only
    ):
        with pytest.raises(TypeError, match="incompatible function arguments"):
            restrict(fine, coarse)
    for operation, *args in (
        (curvature, fine, np.zeros((8, 13))),
        (restrict, fine, np.zeros((3, 6))),
        (prolong, np.zeros((4, 5)), fine),
        (filter_near, fine, np.zeros((4, 4)), 1.0, np.zeros((8, 13))),
        (filter_near, fine, np.zeros((3, 4)), 1.0, fine.copy()),
        (multipoles, fine, fine, np.zeros((3, 3)), fine),
    ):
        with pytest.raises(ValueError, match=r"shape|half as many|shapes do not match|4 x 4"):
            operation(*args)


@pytest.mark.parametrize("stranger", [-1, 3])
def test_a_neighbour_that_is_none_is_refused(stranger):
    neighbours = np.array([[0], [1], [stranger]])
    with pytest.raises(IndexError, match="not the index of a node"):
        diffuse(neighbours, np.ones((3, 1)), 1, np.ones((3, 2)))


def test_loops_take_arrays_of_two_dimensions_with_contiguous_rows():
    whole = np.zeros((4, 6))
    assert all(map(kernels.loop_takes, (whole, whole[::2], whole[:, 1:4], whole[:, ::6])))
    refused = whole.T, whole[:, ::2], whole[:, ::3], whole[:, ::-1], whole[0], [[0.0]]
    assert not any(map(kernels.loop_takes, refused))
    assert not kernels.loop_takes(np.ma.zeros((4, 6)))
