"""Displacement due to one cell, compared with the integral of the point load over it."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import dblquad, quad

from restitution import operator_cache
from restitution.contact.influence import (
    far_displacement,
    half_space,
    influence_coefficients,
    inverse_half_space,
    love_displacement,
)
from restitution.numerics.grid import Grid
from tolerance import approx

E_STAR = 3.0
cells = st.tuples(st.floats(0.2, 5), st.floats(0.2, 5))


def love(x, y, hx=1.0, hy=1.0):
    return float(love_displacement(np.array(float(x)), np.array(float(y)), hx, hy, E_STAR))


def lags(nx, ny):
    return np.arange(nx)[:, None], np.arange(ny)[None, :]


def gauss(x, y, hx, hy, points=20):
    """∬dA/(πE*r) by Gauss–Legendre, without cancellation; exact to rounding outside the cell."""
    t, w = np.polynomial.legendre.leggauss(points)
    dx = np.asarray(x)[..., None, None] - 0.5 * hx * t[:, None]
    dy = np.asarray(y)[..., None, None] - 0.5 * hy * t[None, :]
    return 0.25 * hx * hy * (w[:, None] * w / np.hypot(dx, dy)).sum((-2, -1)) / (np.pi * E_STAR)


@pytest.mark.parametrize(
    ("x", "y", "hx", "hy"),
    [(1.0, 0.0, 1.0, 1.0), (0.7, 0.9, 1.0, 1.5), (2.0, -3.0, 1.0, 0.3), (0.0, 1.1, 3.0, 2.0)],
)
def test_love_is_the_integral_of_the_point_load_outside_the_cell(x, y, hx, hy):
    total, _ = dblquad(
        lambda t, s: 1 / np.hypot(x - s, y - t), -hx / 2, hx / 2, -hy / 2, hy / 2, epsabs=1e-11
    )
    assert love(x, y, hx, hy) == approx(total / (np.pi * E_STAR), rel=1e-9)


@pytest.mark.parametrize(
    ("x", "y", "hx", "hy"), [(0.0, 0.0, 1.0, 1.0), (0.2, -0.1, 1.0, 0.7), (0.0, 0.3, 10.0, 1.0)]
)
def test_love_is_the_integral_of_the_point_load_inside_the_cell(x, y, hx, hy):
    """For four rectangles around the point ∬dA/r = ∫R(φ)dφ, R the distance to their far sides."""
    total = 0.0
    for width in (hx / 2 - x, hx / 2 + x):
        for height in (hy / 2 - y, hy / 2 + y):
            split = np.arctan2(height, width)
            total += quad(lambda f, w=width: w / np.cos(f), 0, split)[0]
            total += quad(lambda f, h=height: h / np.sin(f), split, np.pi / 2)[0]
    assert love(x, y, hx, hy) == approx(total / (np.pi * E_STAR), rel=1e-9)


def test_the_centre_has_a_closed_form():
    assert love(0, 0) == approx(4 / (np.pi * E_STAR) * np.log(1 + np.sqrt(2)), rel=1e-14)
    for hx, hy in ((1.0, 10.0), (10.0, 1.0), (0.3, 0.4)):
        exact = 2 / (np.pi * E_STAR) * (hx * np.arcsinh(hy / hx) + hy * np.arcsinh(hx / hy))
        assert love(0, 0, hx, hy) == approx(exact, rel=1e-13)


@settings(deadline=None, max_examples=40)
@given(cells, st.floats(-3, 3), st.floats(-3, 3), st.floats(1e-9, 1e3))
def test_love_is_even_symmetric_and_without_a_scale(cell, x, y, scale):
    hx, hy = cell
    x, y = x * hx, y * hy
    assume(min(abs(abs(x) / hx - 0.5), abs(abs(y) / hy - 0.5)) > 1e-3)  # 0/0 on the edge itself
    u = love(x, y, hx, hy)
    for sx, sy in ((-1, 1), (1, -1), (-1, -1)):
        assert love(sx * x, sy * y, hx, hy) == approx(u, rel=1e-9)
    assert love(y, x, hy, hx) == approx(u, rel=1e-9)
    assert love(scale * x, scale * y, scale * hx, scale * hy) == approx(scale * u, rel=1e-9)
    assert 0 < u <= love(0, 0, hx, hy) * (1 + 1e-12)


def test_the_pieces_of_a_cell_add_up_to_it():
    """Nine by five cells under equal pressure have the displacement of one large cell."""
    hx, hy = 0.7, 1.9
    i, j = np.arange(-4, 5)[:, None], np.arange(-2, 3)[None, :]
    for x, y in ((0.0, 0.0), (3.0, 4.0), (30.0, 1.0)):
        pieces = love_displacement(x - i * hx / 9, y - j * hy / 5, hx / 9, hy / 5, E_STAR).sum()
        assert love(x, y, hx, hy) == approx(pieces, rel=1e-9)


@pytest.mark.parametrize("cell", [(1.0, 1.0), (1.0, 3.0), (2.0, 0.5)])
@pytest.mark.parametrize("angle", np.linspace(0, np.pi / 2, 7))
def test_series_and_love_agree_where_both_hold(cell, angle):
    r = np.hypot(*cell) * np.array([16.0, 24.0, 32.0, 48.0])
    x, y = r * np.cos(angle), r * np.sin(angle)
    exact = gauss(x, y, *cell)
    assert_allclose(love_displacement(x, y, *cell, E_STAR), exact, rtol=2e-11)
    error = np.abs(far_displacement(x, y, *cell, E_STAR) / exact - 1)
    assert (error < 2e-9 * (16 * np.hypot(*cell) / r) ** 6 + 2e-15).all()
    assert (error[2:] < 2e-12).all()  # stated in the module


@pytest.mark.parametrize(
    ("spacing", "accuracy"), [((1.0, 1.0), 3e-12), ((0.5, 0.7), 3e-12), ((1.0, 10.0), 3e-11)]
)
def test_the_coefficients_are_accurate_on_both_sides_of_the_switch(spacing, accuracy):
    hx, hy = spacing
    k = influence_coefficients(*lags(500, 480), spacing, E_STAR)
    rows = np.unique(np.r_[0:6, 20:500:37, 31:36, 44:48, 318:326])
    x, y = (rows * hx)[:, None], (rows[rows < 480] * hy)[None, :]
    exact = gauss(*np.broadcast_arrays(x, y), hx, hy, points=12)
    # next to a slender cell twelve points are too few
    off = np.broadcast_to(np.hypot(x, y) > 2.5 * max(hx, hy), exact.shape)
    found = k[rows][:, rows[rows < 480]]
    assert_allclose(found[off], exact[off], rtol=accuracy)
    assert np.isfinite(k).all()


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (3.0, 0.5)])
def test_the_coefficients_fall_with_distance_towards_the_point_load(spacing):
    hx, hy = spacing
    i, j = lags(300, 300)
    k = influence_coefficients(i, j, spacing, E_STAR)
    assert (k > 0).all()
    assert (np.diff(k, axis=0) < 0).all()
    assert (np.diff(k, axis=1) < 0).all()
    assert_allclose(influence_coefficients(i, j, (hy, hx), E_STAR), k.T, rtol=1e-11)
    r = np.hypot(299 * hx, 299 * hy)
    assert k[-1, -1] == approx(hx * hy / (np.pi * E_STAR * r), rel=1e-5)
    # at the switch from one formula to the other there is no jump
    slope = np.diff(np.log(k[20:120, 0]))
    assert np.abs(np.diff(slope, 2)).max() < 1e-3


@pytest.mark.parametrize("scale", [1e-9, 1e3])
def test_the_coefficients_have_no_scale(scale):
    k = influence_coefficients(*lags(60, 50), (1.0, 0.4), 1.0)
    scaled = influence_coefficients(*lags(60, 50), (scale, 0.4 * scale), 1e11)
    assert_allclose(scaled, k * scale / 1e11, rtol=1e-11)


@pytest.mark.parametrize(
    ("shape", "spacing"),
    [((11, 7), (1.0, 1.0)), ((6, 13), (1.0, 10.0)), ((1, 9), (2.0, 1.0)), ((1, 1), (1.0, 4.0))],
)
def test_the_operator_is_the_dense_matrix_and_positive_definite(dense, shape, spacing):
    A = dense.influence(Grid(shape, spacing), E_STAR)
    K = half_space(shape, spacing, E_STAR)
    p = np.random.default_rng(0).normal(size=shape)
    assert_allclose(K(p).ravel(), A @ p.ravel(), atol=1e-12 * np.abs(A).max() * np.abs(p).sum())
    assert np.linalg.eigvalsh(A).min() > 0


@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 10.0)])
def test_the_preconditioner_is_nearly_the_inverse(dense, spacing):
    shape = (12, 10)
    A = dense.influence(Grid(shape, spacing), E_STAR)
    inverse = inverse_half_space(shape, spacing, E_STAR)
    M = np.array([inverse(e.reshape(shape)).ravel() for e in np.eye(A.shape[0])])
    assert_allclose(M, M.T, atol=1e-6 * np.abs(M).max())  # single precision
    assert np.linalg.eigvalsh(M).min() > 0
    values = np.linalg.eigvals(M @ A).real
    assert values.max() / values.min() < 0.25 * np.linalg.cond(A)


def test_the_preconditioner_is_exact_on_a_periodic_wave():
    """The displacement under p = p̂ cos(qx) is 2p̂/(E*q) cos(qx) (Johnson 1985)."""
    shape, spacing = (16, 12), (0.5, 2.0)
    x = np.arange(16)[:, None] * 0.5
    q = 2 * np.pi * 3 / (16 * 0.5)
    u = np.cos(q * x) * np.ones(shape)
    inverse = inverse_half_space(shape, spacing, E_STAR)
    assert_allclose(inverse(u), 0.5 * E_STAR * q * u, atol=1e-6 * E_STAR * q)


def test_one_node_has_an_approximate_inverse_too():
    value = inverse_half_space((1, 1), (1.0, 1.0), E_STAR)(np.ones((1, 1)))
    assert 0 < value[0, 0] < np.inf


@pytest.fixture
def small_cache():
    """Set the size of the cache (bytes) for one test."""
    before = operator_cache.max_bytes

    def limit(size):
        operator_cache.max_bytes = size

    operator_cache.clear()
    yield limit
    operator_cache.max_bytes = before
    operator_cache.clear()


def test_an_operator_is_kept_until_the_cache_is_cleared(small_cache):
    arguments = ((30, 20), (1.0, 1.0), E_STAR)
    half_space(*arguments)
    assert len(operator_cache) == 2  # the operator and its coefficients
    size = operator_cache.nbytes
    half_space(*arguments)
    assert operator_cache.nbytes == size
    operator_cache.clear()
    assert (len(operator_cache), operator_cache.nbytes) == (0, 0)


def test_large_operators_are_not_kept(small_cache):
    """The spectra of large operators would fill the memory as a contact grows."""
    small = half_space((10, 10), (1.0, 1.0), E_STAR)
    operator_cache.clear()
    small_cache(15 * small.nbytes)
    for shape in ((10, 10), (14, 10)):
        half_space(shape, (1.0, 1.0), E_STAR)
    assert len(operator_cache) == 2  # the small operator and the coefficients
    half_space((10, 10), (1.0, 1.0), E_STAR)
    assert len(operator_cache) == 2


@pytest.mark.parametrize("aspect", [1.0, 0.4])
def test_coefficients_of_a_smaller_or_larger_block_are_the_same(aspect):
    operator_cache.clear()
    blocks = [
        influence_coefficients(*lags(*n), (1.0, aspect), 1.0)
        for n in ((30, 60), (50, 20), (40, 40))
    ]
    operator_cache.clear()
    whole = influence_coefficients(*lags(60, 60), (1.0, aspect), 1.0)
    for k in blocks:
        assert_allclose(k, whole[: k.shape[0], : k.shape[1]], rtol=1e-14)


@pytest.mark.parametrize("size", [1200, 8 * 590])
def test_a_block_that_is_too_large_is_not_kept(small_cache, size):
    """400 coefficients are more than 150, and more than two thirds of 590."""
    small_cache(size)
    influence_coefficients(*lags(20, 20), (1.0, 1.0), 1.0)
    assert len(operator_cache) == 0


def test_blocks_that_are_long_both_ways_make_no_larger_one(small_cache):
    small_cache(12 * 1000 + 11)
    for n in ((100, 10), (10, 100)):
        influence_coefficients(*lags(*n), (1.0, 1.0), 1.0)
        assert operator_cache.nbytes == 8 * 1000


@pytest.mark.parametrize(("n", "kept"), [(20, (30, 20)), (24, (10, 24))])
def test_two_blocks_make_one_that_takes_at_most_two_thirds_of_the_cache(small_cache, n, kept):
    """Of 1000 coefficients: 30 x 20 are kept together, but 30 x 24 are not."""
    small_cache(8 * 1000)
    for each in ((30, 10), (10, n)):
        influence_coefficients(*lags(*each), (1.0, 1.0), 1.0)
    assert operator_cache.nbytes == 8 * math.prod(kept)
