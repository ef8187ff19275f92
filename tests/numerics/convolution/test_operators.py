"""Convolution by FFT, compared with the direct sum."""

import ducc0
import numpy as np
import pytest
import scipy.fft
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from restitution.contact.influence import half_space
from restitution.numerics.convolution.device import _LibraryDevice
from restitution.numerics.convolution.operators import (
    FreeConvolution,
    PeriodicConvolution,
    SpectralFilter,
    WrappedConvolution,
    fast_size,
)
from restitution.numerics.quadratic.minimise import _ROUNDING
from tolerance import approx

# 1 x 1, single rows, primes and powers of two; up to 23 x 23 the direct sum is fast.
sizes = st.sampled_from([1, 2, 3, 5, 7, 8, 11, 13, 16, 17, 19, 23])
SINGLE = 2e-6  # error of single precision relative to the largest value

shapes = st.tuples(sizes, sizes)
spacings = st.tuples(st.floats(0.1, 10), st.floats(0.1, 10))
seeds = st.integers(0, 2**32 - 1)


def point_load(spacing):
    """1/r on rectangular cells, softened at the origin: positive, even, slowly decaying."""
    hx, hy = spacing
    return lambda i, j: 1 / np.sqrt((i * hx) ** 2 + (j * hy) ** 2 + 0.1 * hx * hy)


def direct(kernel, p):
    """The direct sum Σ_kl K[|i − k|, |j − l|] p[k, l]."""
    nx, ny = p.shape
    table = kernel(np.arange(nx)[:, None], np.arange(ny)[None, :])
    lag_x = abs(np.arange(nx)[:, None] - np.arange(nx))
    lag_y = abs(np.arange(ny)[:, None] - np.arange(ny))
    return np.einsum("ikjl,kl->ij", table[lag_x[:, :, None, None], lag_y], p)


@settings(deadline=None, max_examples=80)
@given(shapes, spacings, seeds)
def test_it_is_the_direct_sum_on_any_shape_and_cell(shape, spacing, seed):
    kernel = point_load(spacing)
    p = np.random.default_rng(seed).random(shape)
    assert_allclose(FreeConvolution(kernel, shape)(p), direct(kernel, p), rtol=1e-12)


@settings(deadline=None, max_examples=30)
@given(shapes, seeds)
def test_it_is_the_direct_sum_for_any_even_kernel_and_sign(shape, seed):
    rng = np.random.default_rng(seed)
    table = rng.normal(size=(64, 64))
    p = rng.normal(size=shape)
    scale = np.abs(table).max() * np.abs(p).sum()

    def kernel(i, j):
        return table[i, j]

    assert_allclose(FreeConvolution(kernel, shape)(p), direct(kernel, p), atol=1e-13 * scale)


@settings(deadline=None, max_examples=20)
@given(shapes, st.floats(-5, 5), seeds)
def test_it_is_linear(shape, factor, seed):
    p, q = np.random.default_rng(seed).normal(size=(2, *shape))
    K = FreeConvolution(point_load((1.0, 2.0)), shape)
    bound = 1e-12 * K(np.abs(p) + abs(factor) * np.abs(q)).max()
    assert_allclose(K(p + factor * q), K(p) + factor * K(q), atol=bound)


@pytest.mark.parametrize("corner", [(0, 0), (0, -1), (-1, 0), (-1, -1)])
def test_a_load_in_a_corner_does_not_come_round_to_the_other(corner):
    shape = (9, 14)
    p = np.zeros(shape)
    p[corner] = 1.0
    table = point_load((1.0, 0.3))(np.arange(9)[:, None], np.arange(14)[None, :])
    flipped = table[:: -1 if corner[0] else 1, :: -1 if corner[1] else 1]
    K = FreeConvolution(point_load((1.0, 0.3)), shape)
    assert_allclose(K(p), flipped, rtol=1e-12)


def test_lags_that_never_meet_do_not_matter():
    def wild(i, j):
        return np.where((i < 7) & (j < 10), point_load((1.0, 1.0))(i, j), 1e3)

    p = np.random.default_rng(0).random((7, 10))
    assert_allclose(FreeConvolution(wild, (7, 10))(p), direct(wild, p), rtol=1e-9)


def test_what_a_value_makes_at_its_own_node_is_known():
    K = FreeConvolution(point_load((1.0, 1.0)), (9, 7))
    p = np.zeros((9, 7))
    p[2, 3] = 4.0
    assert K(p)[2, 3] == approx(4.0 * K.diagonal, rel=1e-12)


def test_a_fast_size_is_the_next_product_of_small_primes():
    def smooth(n):
        for prime in (2, 3, 5, 7):
            while n % prime == 0:
                n //= prime
        return n == 1

    assert [n for n in range(1, 2000) if fast_size(n) == n] == list(filter(smooth, range(1, 2000)))
    assert (fast_size(11), fast_size(1001), fast_size(2**20 - 1)) == (12, 1008, 2**20)


def test_its_size_is_that_of_its_spectra():
    """A period of 2 n values has n + 1 modes of either sign, along both axes."""
    K = FreeConvolution(point_load((1.0, 1.0)), (6, 5))
    assert K.nbytes == 7 * 6 * (8 + 4)  # in double and in single precision
    smoothing = SpectralFilter(lambda qx, qy: 1 / (1 + qx + qy), (6, 5))
    assert smoothing.nbytes == 4 * 3 * 4


def test_it_is_counted_and_leaves_its_input_and_its_earlier_answers_alone():
    K = FreeConvolution(point_load((1.0, 1.0)), (6, 5))
    p = np.random.default_rng(1).random((6, 5))
    given_p = p.copy()
    assert K.count == 0
    first = K(p)
    kept = first.copy()
    K(100 * p)
    assert_array_equal(K(p), first)  # no residue of the previous call
    assert_array_equal(first, kept)
    assert_array_equal(p, given_p)
    assert K.count == 3
    assert FreeConvolution(point_load((1.0, 1.0)), (6, 5)).count == 0


def test_the_memory_layout_of_the_input_does_not_matter():
    K = FreeConvolution(point_load((1.0, 1.0)), (6, 5))
    p = np.random.default_rng(2).random((6, 5))
    wide = np.random.default_rng(2).random((12, 15))
    wide[::2, ::3] = p
    for other in (np.asfortranarray(p), wide[::2, ::3]):
        assert_array_equal(K(other), K(p))


@pytest.mark.parametrize("n", [32, 181, 1024])
@pytest.mark.parametrize("kind", ["random", "positive", "one side", "checkers", "one node"])
def test_single_precision_errs_by_as_much_as_the_minimiser_counts_on(kind, n):
    """The bound is relative to the largest result, even if positive and negative values cancel."""
    rng = np.random.default_rng(n)
    p = rng.normal(size=(n, n))
    if kind == "positive":
        p = np.abs(p)
    elif kind == "one side":
        p[:, n // 8 :] = 0
    elif kind == "checkers":
        p = (-1.0) ** np.add.outer(np.arange(n), np.arange(n))
    elif kind == "one node":
        p = np.where(p == p.max(), 1.0, 0.0)
    p = p.astype(np.float32)
    K = half_space((n, n), (1.0, 1.0), 1.0).with_own_workspace()
    exact = K(p)
    error = np.abs(K.single_precision(p) - exact).max() / np.abs(exact).max()
    assert 0 < error < _ROUNDING * np.finfo(np.float32).eps


@settings(deadline=None, max_examples=20)
@given(shapes, seeds)
def test_single_precision_is_quick_and_nearly_right(shape, seed):
    """Products in both precisions may alternate in the same workspace."""
    p = np.random.default_rng(seed).normal(size=shape)
    K = FreeConvolution(point_load((1.0, 2.0)), shape)
    exact, scale = K(p), np.abs(K(np.abs(p))).max()
    assert_allclose(K.single_precision(p), exact, atol=SINGLE * scale)
    assert K.single_precision(p).dtype == np.float64
    assert_array_equal(K(p), exact)
    out = np.empty(shape)
    assert K.single_precision(p, out=out) is out
    assert K.count == 6


@pytest.mark.parametrize("size", [1e-150, 1e-30, 1e30, 1e150])
def test_a_filter_works_at_any_scale(size):
    r = np.random.default_rng(3).normal(size=(9, 7))
    flat = SpectralFilter(lambda qx, qy: 0.5 + 0 * qx * qy, (9, 7))
    assert_allclose(flat(size * r), 0.5 * size * r, rtol=1e-5)
    assert not flat(0 * r).any()


@settings(deadline=None, max_examples=20)
@given(shapes, seeds)
def test_a_filter_that_passes_everything_returns_its_input(shape, seed):
    r = np.random.default_rng(seed).normal(size=shape)
    through = SpectralFilter(lambda qx, qy: np.ones(np.broadcast(qx, qy).shape), shape)
    assert_allclose(through(r), r, atol=SINGLE * np.abs(r).max())


@pytest.mark.parametrize(("mx", "my"), [(0, 0), (3, 0), (0, 2), (2, 5), (6, 4)])
def test_a_wave_is_multiplied_by_its_symbol(mx, my):
    shape = (12, 10)  # fast sizes: no padding, so a wave is a single mode
    x, y = np.meshgrid(np.arange(12), np.arange(10), indexing="ij")
    qx, qy = 2 * np.pi * mx / 12, 2 * np.pi * my / 10
    wave = np.cos(qx * x + qy * y)
    steep = SpectralFilter(lambda qx, qy: 1 + qx**2 + 3 * np.abs(qy), shape)
    expected = (1 + qx**2 + 3 * qy) * wave
    assert_allclose(steep(wave), expected, atol=SINGLE * np.abs(expected).max())


@settings(deadline=None, max_examples=20)
@given(shapes, seeds)
def test_a_filter_is_symmetric_and_keeps_the_sign_of_its_symbol(shape, seed):
    """A preconditioner needs both properties, for padded sizes too."""
    r, s = np.random.default_rng(seed).normal(size=(2, *shape))
    symbol = SpectralFilter(lambda qx, qy: 0.1 + np.hypot(qx, qy), shape)
    bound = SINGLE * np.linalg.norm(r) * np.linalg.norm(s)
    assert np.vdot(r, symbol(s)) == approx(np.vdot(symbol(r), s), abs=bound)
    assert np.vdot(r, symbol(r)) > 0.099 * np.vdot(r, r)


def test_small_transforms_take_one_thread_and_large_ones_what_there_is():
    assert loops().threads_for(4 * 100 * 100) == 1
    assert loops().threads_for(4 * 800 * 800) == ducc0.misc.thread_pool_size()


def test_two_users_do_not_meet():
    one = FreeConvolution(point_load((1.0, 2.0)), (90, 70))
    rng = np.random.default_rng(0)
    p, other_p = rng.random((90, 70)), rng.random((90, 70))
    other = one.with_own_workspace()
    for apply in (lambda K, p: K(p), lambda K, p: K.single_precision(p)):
        out = apply(one, p)
        other_out = apply(other, other_p)
        assert_array_equal(apply(one, p), out)
        assert not np.array_equal(out, other_out)
    assert (one.count, other.count) == (4, 2)


def loops():
    return pytest.importorskip("restitution.numerics.loops", reason="built without a compiler")


# Even and odd sizes with all supported factors, among them vector lengths and one more.
periods = st.sampled_from(
    [1, 2, 3, 4, 5, 7, 8, 14, 15, 16, 21, 25, 30, 32, 42, 48, 60, 63, 80, 90, 128]
)


@pytest.mark.parametrize("kinds", ["ddd", "ddf", "dff", "dfd", "fff", "ffd", "fdd", "fdf"])
@settings(deadline=None, max_examples=40)
@given(st.tuples(periods, periods), st.data(), st.sampled_from([1e-3, 1.0, 7.0]), seeds)
def test_compiled_convolution_is_that_of_whole_arrays(kinds, both, data, scale, seed):
    """For any period, with or without padding, any even spectrum and any mix of precisions."""
    shape = tuple(data.draw(st.integers(1, n)) for n in both)
    rng = np.random.default_rng(seed)
    given_kind, kind, result_kind = kinds
    values = rng.normal(size=shape).astype(given_kind)
    spectrum = rng.normal(size=(both[1] // 2 + 1, both[0] // 2 + 1)).astype(kind)
    found, expected = np.empty(shape, result_kind), np.empty(shape)
    module = loops()
    workspace = np.empty((1, module.workspace_bytes(shape[1], both[0] // 2 + 1)), np.uint8)
    module.convolve(values, 1 / scale, spectrum, *both, workspace, scale, found)
    plain = _LibraryDevice("plain", np, scipy.fft)
    plain.convolve(values.astype("d"), spectrum.astype("d"), both, scale, workspace, expected)
    # Bound of any value: the sum of the amplitudes of all waves.
    largest = np.abs(values).sum() * np.abs(spectrum).max() * both[0] * both[1]
    assert_allclose(found, expected, atol=(1e-15 if kinds == "ddd" else 5e-7) * largest)


@pytest.mark.parametrize("kind", ["f", "d"])
def test_waves_too_many_for_the_cache(kind):
    """The sizes are not multiples of the vector length, so the last vectors are incomplete."""
    shape, periods = (1001, 1703), (2016, 3430)
    rng = np.random.default_rng(6)
    values = rng.normal(size=shape)
    spectrum = rng.random((periods[1] // 2 + 1, periods[0] // 2 + 1)).astype(kind)
    module = loops()
    workspace = np.empty((1, module.workspace_bytes(shape[1], periods[0] // 2 + 1)), np.uint8)
    found, expected = np.empty(shape), np.empty(shape)
    module.convolve(values, 1.0, spectrum, *periods, workspace, 1.0, found)
    plain = _LibraryDevice("plain", np, scipy.fft)
    plain.convolve(values, spectrum.astype("d"), periods, 1.0, workspace, expected)
    assert_allclose(found, expected, atol=(1e-14 if kind == "d" else 2e-6) * np.abs(expected).max())


def test_threads_share_the_columns(threads):
    p = np.random.default_rng(4).normal(size=(360, 350))
    K = FreeConvolution(point_load((1.0, 2.0)), p.shape)
    assert loops().threads_for(p.nbytes) == threads
    found = K(p)
    loops().use_threads(1)
    assert_array_equal(found, K(p))


def test_what_does_not_go_together_is_refused():
    convolve = loops().convolve
    p, spectrum, out = np.ones((6, 5)), np.ones((6, 7)), np.empty((6, 5))
    workspace = np.empty((1, loops().workspace_bytes(5, 12)), np.uint8)
    convolve(p, 1.0, spectrum, 12, 10, workspace, 1.0, out)
    for change, message in (
        ({"px": 14}, "shapes do not match"),
        ({"out": np.empty((5, 5))}, "shapes do not match"),
        ({"workspace": workspace[:, :-1]}, "shapes do not match"),
        ({"spectrum": np.ones((6, 6))}, "shapes do not match"),
        ({"px": 4, "spectrum": np.ones((6, 3))}, "more values"),
        ({"px": 22, "spectrum": np.ones((6, 12))}, "factors"),
    ):
        its = {"px": 12, "out": out, "workspace": workspace, "spectrum": spectrum} | change
        with pytest.raises(ValueError, match=message):
            convolve(p, 1.0, its["spectrum"], its["px"], 10, its["workspace"], 1.0, its["out"])


@settings(deadline=None, max_examples=40)
@given(shapes, seeds)
def test_a_periodic_convolution_multiplies_the_modes_of_the_whole_array(shape, seed):
    # 11, 13, 17 … are not factors of the compiled transforms.
    rng = np.random.default_rng(seed)
    p = rng.normal(size=shape)

    def symbol(qx, qy):
        return 1 / (0.3 + np.sqrt(qx**2 + 2 * qy**2))

    K = PeriodicConvolution(symbol, shape)
    q = [2 * np.pi * abs(np.fft.fftfreq(n)) for n in shape]
    expected = np.fft.ifft2(symbol(q[0][:, None], q[1][None, :]) * np.fft.fft2(p)).real
    assert_allclose(K(p), expected, atol=1e-12 * abs(expected).max())
    assert_allclose(K.single_precision(p), expected, atol=SINGLE * abs(expected).max())
    point = np.zeros(shape)
    point[0, 0] = 1.0
    assert K(point)[0, 0] == approx(K.diagonal, rel=1e-9)


def patches(shape):
    """Pressure on half of the nodes of an ellipse that touches the edges."""
    x, y = (np.linspace(-1, 1, n) for n in shape)
    ellipse = np.sqrt(np.maximum(1 - np.add.outer(x**2, y**2), 0))
    return (ellipse * (np.random.default_rng(1).random(shape) < 0.5)).astype(np.float32)


@pytest.mark.parametrize("shape", [(160, 160), (243, 178), (330, 421)])
@pytest.mark.parametrize("spacing", [(1.0, 1.0), (1.0, 1.6)])
def test_a_wrapped_convolution_is_nearly_the_linear_one(shape, spacing):
    kernel, p = point_load(spacing), patches(shape)
    expected = FreeConvolution(kernel, shape)(p)
    K = WrappedConvolution(kernel, shape)
    found = K.single_precision(p, out=np.empty_like(p))
    error = (found - expected) / expected.max()
    assert 1e-6 < np.sqrt((error**2).mean()) < 7e-4
    assert np.abs(error).max() < 1e-2
    assert K.count == 1
    assert K.diagonal == approx(kernel(0, 0), rel=1e-12)
    assert K.nbytes < 0.2 * FreeConvolution(kernel, shape).nbytes


def test_copies_of_a_wrapped_convolution_share_no_workspace():
    p = patches((180, 170))
    K = WrappedConvolution(point_load((1.0, 1.0)), p.shape)
    first = K(p)
    other = K.with_own_workspace()
    assert (K.count, other.count) == (1, 0)
    assert other._far._lock is not K._far._lock
    assert_array_equal(other(p), first)
    assert other._far._workspace is not K._far._workspace


def test_a_spectrum_of_single_precision_alone_is_as_accurate():
    p = patches((90, 70))
    both = FreeConvolution(point_load((1.0, 2.0)), p.shape)
    alone = FreeConvolution(point_load((1.0, 2.0)), p.shape, single=True)
    expected = both(p)
    for found in (alone(p), alone.single_precision(p)):
        assert_allclose(found, expected, atol=SINGLE * expected.max())
    assert alone.nbytes < both.nbytes
