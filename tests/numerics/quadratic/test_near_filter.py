"""The filter of 7 × 7 nodes multiplies short waves by about their wave number."""

import numpy as np
import pytest

from restitution.numerics.quadratic.near_filter import REACH, NearFilter, kernel_of_wave_number
from tolerance import approx


def spectrum(aspect, qx, qy):
    k = np.arange(-REACH, REACH + 1)
    whole = kernel_of_wave_number(aspect)[np.abs(k)][:, np.abs(k)]
    return np.einsum("ij,qi,qj->q", whole, np.cos(np.outer(qx, k)), np.cos(np.outer(qy, k)))


@pytest.mark.parametrize(("aspect", "least", "most"), [(1.0, 0.91, 1.04), (3.0, 0.84, 1.3)])
def test_the_factor_of_short_waves_is_their_wave_number(aspect, least, most):
    angle, length = np.meshgrid(np.linspace(0, np.pi / 2, 40), np.geomspace(2, 16, 30))
    qx, qy = (2 * np.pi / length.ravel() * of(angle.ravel()) for of in (np.cos, np.sin))
    ratio = spectrum(aspect, qx, qy) / np.hypot(qx, qy / aspect)
    assert least < ratio.min()
    assert ratio.max() < most


@pytest.mark.parametrize("aspect", [0.1, 0.5, 1.0, 2.0, 10.0])
def test_long_waves_are_amplified_not_removed_or_reversed(aspect):
    q = np.linspace(0, np.pi, 60)
    qx, qy = (values.ravel() for values in np.meshgrid(q, q))
    assert (spectrum(aspect, qx, qy) / np.maximum(np.hypot(qx, qy / aspect), 1e-9)).min() > 0.75


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_a_wave_keeps_its_shape_inside(dtype):
    q, scale = 2 * np.pi / 5, 3e7
    wave = np.cos(q * np.arange(60))[:, None] * np.ones(40)
    filtered = NearFilter(1.0, scale)(wave.astype(dtype))
    assert filtered.dtype == dtype
    inside = slice(REACH, -REACH)
    factor = filtered[inside, inside] / (scale * wave[inside, inside])
    assert factor == approx(np.full(factor.shape, spectrum(1.0, [q], [0.0])[0]), rel=1e-4)


def test_the_kept_kernel_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        kernel_of_wave_number(1.0)[0, 0] = 0


def test_values_outside_the_array_are_zero():
    r = np.zeros((9, 8))
    r[0, 0], r[-1, -1] = 1.0, 2.0
    filtered, kernel = NearFilter(2.0, 1.0)(r), kernel_of_wave_number(2.0)
    assert filtered[: REACH + 1, : REACH + 1] == approx(kernel, rel=1e-12)
    assert filtered[: -REACH - 2 : -1, : -REACH - 2 : -1] == approx(2 * kernel, rel=1e-12)
    assert filtered[0, REACH + 1] == 0
