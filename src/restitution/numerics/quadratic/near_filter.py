"""A filter for short waves: convolution with an even kernel of 7 × 7 nodes, zero outside the array.

The kernel is fitted to the wave number. For waves shorter than 16 nodes the relative error is at
most 9 %, or 30 % on cells three times as wide as long; longer waves are amplified too much.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop
from restitution.numerics.read_only import freeze

Array = NDArray[Any]

REACH = 3  # nodes on either side
_SAMPLES = 32  # of the symbol along each axis
_LEAST = 0.07  # the fit is relative to the symbol, but at least to this share of its largest value


class NearFilter:
    """Multiplication by approximately `scale` times |q|, with the wave vector q in rad per cell.

    The cells have the width 1 along x and the width `aspect` along y.
    """

    def __init__(self, aspect: float, scale: float) -> None:
        self._kernel, self._scale = kernel_of_wave_number(aspect), scale

    def __call__(self, r: Array, out: Array | None = None) -> Array:
        """Return the filtered `r`, in a new array or in `out`, which is not `r`."""
        result = np.empty_like(r) if out is None else out
        filter_near(r, self._kernel, self._scale, result)
        return result


@lru_cache(maxsize=8)
def kernel_of_wave_number(aspect: float) -> Array:
    """Quadrant (4 × 4) of the kernel whose spectrum is nearest to |q|, by least squares."""
    q = np.pi * (np.arange(_SAMPLES) + 0.5) / _SAMPLES
    symbol = np.hypot(q[:, None], q / aspect).ravel()
    k = np.arange(REACH + 1)
    waves = np.cos(np.outer(q, k)) * np.where(k == 0, 1, 2)
    terms = np.einsum("ik,jl->ijkl", waves, waves).reshape(symbol.size, -1)
    weight = 1 / np.maximum(symbol, _LEAST * symbol.max())
    kernel = np.linalg.lstsq(terms * weight[:, None], symbol * weight, rcond=None)[0]
    return freeze(np.asarray(kernel.reshape(k.size, k.size)))


@use_loop
def filter_near(r: Array, kernel: Array, scale: float, out: Array) -> None:
    """Write the convolution of r with `scale` times an even kernel, given by a quadrant."""
    padded, (rows, columns) = np.pad(r, REACH), r.shape
    out[...] = 0
    for i in range(-REACH, REACH + 1):
        for j in range(-REACH, REACH + 1):
            shifted = padded[REACH + i : REACH + i + rows, REACH + j : REACH + j + columns]
            out += float(scale * kernel[abs(i), abs(j)]) * shifted
