"""The split convolution against the padded one."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import quad
from scipy.special import erf, erfcx, j0

from restitution.contact.influence import half_space, influence_coefficients
from restitution.numerics import split
from restitution.numerics.convolution import FreeConvolution
from restitution.numerics.device import CPU
from restitution.numerics.split import SplitConvolution

E_STAR = 1e11


def pair(shape, spacing):
    """The same convolution padded, in double precision, and split."""

    def kernel(i, j):
        return influence_coefficients(i, j, spacing, E_STAR)

    strength = spacing[0] * spacing[1] / (np.pi * E_STAR)
    return FreeConvolution(kernel, shape), SplitConvolution(kernel, strength, spacing, shape)


def errors(exact, split, p):
    """Of double and of single precision, over the largest value."""
    expected = exact(p)
    single = np.empty(p.shape, np.float32)
    assert split.quick(p, single) is single
    return [np.abs(u - expected).max() / np.abs(expected).max() for u in (split(p), single)]


@settings(deadline=None, max_examples=25)
@given(
    st.integers(1, 260), st.integers(1, 260), st.sampled_from([1.0, 0.5, 1.7, 3.0]),
    st.sampled_from(["even", "noise", "sparse", "corner"]), st.integers(0, 2**32 - 1),
)  # fmt: skip
def test_it_is_that_of_the_padded_arrays(nx, ny, aspect, kind, seed):
    rng = np.random.default_rng(seed)
    p = {
        "even": lambda: np.ones((nx, ny)),
        "noise": lambda: rng.normal(size=(nx, ny)),
        "sparse": lambda: rng.random((nx, ny)) * (rng.random((nx, ny)) < 0.02),
        "corner": lambda: np.zeros((nx, ny)),
    }[kind]()
    p[0, 0] += 1.0
    double, single = errors(*pair((nx, ny), (1e-7, aspect * 1e-7)), p)
    assert double < 3e-13
    assert single < 1e-6


@pytest.mark.parametrize("kind", ["even", "cap"])
def test_the_error_does_not_grow_with_the_size(kind):
    shape = (700, 640)
    x, y = (np.linspace(-1, 1, n) for n in shape)
    p = {"even": np.ones(shape), "cap": np.sqrt(np.maximum(0, 1 - x[:, None] ** 2 - y**2))}[kind]
    double, single = errors(*pair(shape, (1e-7, 1e-7)), p)
    assert double < 3e-13
    assert single < 1e-6


@pytest.mark.parametrize("precision", [split._DOUBLE, split._SINGLE])
@pytest.mark.parametrize("longest", [40, 4000])
def test_the_smooth_kernel_is_its_integral(longest, precision):
    """As its spectrum gives it: that of F times exp(q²g²)."""
    i, j = np.arange(longest)[:, None], np.arange(2)[None, :]
    found = split._sharpened(i, j, 2.0, (1.0, 0.9), precision, CPU)
    for i, j in ((0, 0), (0, 1), (1, 0), (8, 1), (15, 0), (39, 1)):
        r = np.hypot(i, 0.9 * j)
        expected, _ = quad(
            lambda q, r=r: j0(q * r) * erfcx(q * precision.s / np.sqrt(2))
            * np.exp(-0.5 * (precision.c * q) ** 2),
            0, 10, epsabs=1e-12, limit=2000,
        )  # fmt: skip
        assert found[i, j] == pytest.approx(2 * expected, rel=1e-9)


def test_the_smooth_part_is_the_mean_of_its_function():
    i, j, width = np.arange(50), np.arange(60), 9.0
    found = split._smooth_part(i, j, 2.0, (1.0, 0.7), width, CPU)
    nodes, weights = np.polynomial.legendre.leggauss(8)
    for at in ((0, 0), (0, 1), (17, 3), (49, 59)):
        r = np.hypot(at[0] + nodes[:, None] / 2, 0.7 * (at[1] + nodes[None, :] / 2))
        mean = weights @ (2.0 * erf(r / (np.sqrt(2) * width)) / r) @ weights / 4
        assert found[at] == pytest.approx(mean, rel=1e-8)


def test_two_users_do_not_meet():
    _, one = pair((90, 70), (1e-7, 1e-7))
    rng = np.random.default_rng(0)
    p, other_p = rng.random((90, 70)), rng.random((90, 70))
    other = one.fresh()
    for apply in (lambda K, p: K(p), lambda K, p: K.quick(p)):
        out = apply(one, p)
        other_out = apply(other, other_p)
        assert_array_equal(apply(one, p), out)
        assert not np.array_equal(out, other_out)
    assert (one.count, other.count) == (4, 2)


def test_a_batch_is_one_after_the_other():
    _, K = pair((60, 50), (1e-7, 2e-7))
    p = np.random.default_rng(3).random((4, 60, 50))
    batch = K.fresh((4,))
    assert_allclose(batch(p), [K(item) for item in p], rtol=1e-13)
    assert_allclose(batch.quick(p), [K.quick(item) for item in p], rtol=1e-5)
    assert batch.count == 2


@pytest.mark.parametrize(
    ("shape", "spacing", "kind"),
    [
        ((200, 200), (1e-7, 1e-7), SplitConvolution),
        ((180, 300), (1e-7, 1e-7), FreeConvolution),
        # The margins are as wide as the long side of the cells says.
        ((200, 200), (1e-7, 3e-7), FreeConvolution),
        ((600, 200), (1e-7, 3e-7), SplitConvolution),
    ],
)
def test_large_half_spaces_are_split(shape, spacing, kind):
    assert isinstance(half_space(shape, spacing, E_STAR), kind)
    assert isinstance(half_space(shape, spacing, E_STAR, batch=(2,)), kind)
