"""The split convolution against the padded one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad
from scipy.special import erfcx, j0

from restitution.contact.influence import half_space, influence_coefficients
from restitution.numerics import split
from restitution.numerics.convolution import FreeConvolution
from restitution.numerics.split import SplitConvolution

E_STAR = 1e11


def pair(shape, spacing):
    """The same convolution padded, in double precision, and split."""

    def kernel(i, j):
        return influence_coefficients(i, j, spacing, E_STAR)

    strength = spacing[0] * spacing[1] / (np.pi * E_STAR)
    return FreeConvolution(kernel, shape), SplitConvolution(kernel, strength, spacing, shape)


def error(exact, approximate, p):
    expected = exact(p)
    out = np.empty(p.shape, np.float32)
    assert approximate(p, out) is out
    return np.abs(out - expected).max() / np.abs(expected).max()


@settings(deadline=None, max_examples=25)
@given(
    st.integers(1, 260), st.integers(1, 260), st.sampled_from([1.0, 0.5, 1.7, 3.0]),
    st.sampled_from(["even", "noise", "sparse", "corner"]), st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_it_is_that_of_the_padded_arrays_in_single_precision(nx, ny, aspect, kind, seed):
    rng = np.random.default_rng(seed)
    p = {
        "even": lambda: np.ones((nx, ny)),
        "noise": lambda: rng.normal(size=(nx, ny)),
        "sparse": lambda: rng.random((nx, ny)) * (rng.random((nx, ny)) < 0.02),
        "corner": lambda: np.zeros((nx, ny)),
    }[kind]()
    p[0, 0] += 1.0
    assert error(*pair((nx, ny), (1e-7, aspect * 1e-7)), p) < 1e-6


@pytest.mark.parametrize("kind", ["even", "cap"])
def test_the_error_does_not_grow_with_the_size(kind):
    shape = (700, 640)
    x, y = (np.linspace(-1, 1, n) for n in shape)
    p = {"even": np.ones(shape), "cap": np.sqrt(np.maximum(0, 1 - x[:, None] ** 2 - y**2))}[kind]
    assert error(*pair(shape, (1e-7, 1e-7)), p) < 1e-6


def test_the_smooth_kernel_is_its_integral():
    s, c = split._S, split._C
    for r in (0.0, 0.03, 1.0, 7.77, 15.99, 16.01, 40.0):
        expected, _ = quad(
            lambda q, r=r: j0(q * r) * erfcx(q * s / np.sqrt(2)) * np.exp(-0.5 * (c * q) ** 2),
            0, 10, epsabs=1e-12, limit=2000,
        )  # fmt: skip
        assert split._sharpened(np.array([r]))[0] == pytest.approx(expected, rel=3e-7)


@pytest.mark.parametrize("size", [10, 10**6])
def test_two_users_do_not_meet(size):
    """Whether or not there is room enough for it in the memory that it is given."""
    _, one = pair((90, 70), (1e-7, 1e-7))
    rng = np.random.default_rng(0)
    p, other_p = rng.random((90, 70)), rng.random((90, 70))
    out, other_out = np.empty_like(p), np.empty_like(p)
    one(p, out)
    other = one.within(np.empty(size))
    other(other_p, other_out)
    again = np.empty_like(p)
    one(p, again)
    assert_array_equal(again, out)
    assert not np.array_equal(out, other_out)


def test_large_half_spaces_are_split_for_single_precision():
    """And counted; a batch of them is not, and neither is what has to be exact."""
    K = half_space((310, 310), (1e-7, 1e-7), E_STAR)
    assert isinstance(K._approximation, SplitConvolution)
    assert half_space((290, 290), (1e-7, 1e-7), E_STAR)._approximation is None
    p = np.random.default_rng(1).random((310, 310))
    expected = K(p)
    assert_allclose(K.quick(p), expected, atol=1e-6 * expected.max())
    assert K.count == 2
    both = half_space((310, 310), (1e-7, 1e-7), E_STAR, batch=(2,))
    assert both._approximation is None
    assert_allclose(both.quick(np.stack([p, p]))[1], expected, atol=1e-6 * expected.max())
