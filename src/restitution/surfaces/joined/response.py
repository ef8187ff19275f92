"""What the estimate of a power spectrum measures of long waves: leakage, levelling and the edge.

The expectation of the estimate at the wave vector k of a scan is Σ_q C(q) |T(k, q)|², where T is
the transform of the wave q after levelling and tapering (docs/several-scans.md).
"""

from __future__ import annotations

import math
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from restitution.surfaces.level import orthonormal_polynomials
from restitution.surfaces.psd import tapers
from restitution.surfaces.surface import Array

MOST = 10.0  # periods per shorter edge up to which the response is summed
_POINTS = 64  # of the edge for which waves are sampled
_PER_PERIOD = 3  # sampled waves per period in an edge
_BEYOND = 4  # periods beyond MOST whose leakage is summed


@lru_cache(maxsize=32)
def of_map(aspect: float, degree: int) -> tuple[Array, Array, Array]:
    """Response of a scan whose second edge is `aspect` (at least 1) times its first.

    Returns the wave numbers of modes (in periods per first edge), those of the waves, and the
    weight of the density of each wave in the expectation at each mode.
    """
    scale = 1.0, aspect
    most = [math.floor(MOST * s) for s in scale]
    waves = [_sampled(m + _BEYOND) for m in most]
    axes = [(np.arange(m + 1), q) for m, q in zip(most, waves, strict=True)]
    rough = [_transforms(k, q) for k, q in axes]
    level = [_levelled(k, q, degree) for k, q in axes]
    q = np.hypot(waves[0][:, None] / scale[0], waves[1][None, :] / scale[1]).ravel()
    k = np.hypot(np.arange(most[0] + 1)[:, None], np.arange(most[1] + 1)[None, :] / aspect).ravel()
    number = np.rint(_PER_PERIOD * q).astype(int)
    weight = np.zeros((k.size, int(number.max()) + 1))
    count = rough[0].shape[0]
    for i in range(most[0] + 1):
        power = np.zeros((most[1] + 1, waves[0].size, waves[1].size))
        for a in range(count):
            for b in range(count):
                T = rough[0][a, i][None, :, None] * rough[1][b][:, None, :]
                for m in range(degree + 1):
                    for n in range(degree + 1 - m):
                        T = T - level[0][m, a, i][None, :, None] * level[1][n, b][:, None, :]
                power += np.abs(T) ** 2
        for j in range(most[1] + 1):
            row = np.bincount(number, power[j].ravel(), weight.shape[1])
            weight[i * (most[1] + 1) + j] = row
    weight *= 1 / (count**2 * _PER_PERIOD**2)
    sums = np.bincount(number, q, weight.shape[1])
    size = np.bincount(number, minlength=weight.shape[1])
    keep = (size > 0) & (sums > 0)
    inside = (k > 0) & (k <= MOST)
    return k[inside], sums[keep] / size[keep], weight[np.ix_(inside, keep)]


@lru_cache(maxsize=32)
def of_line(degree: int) -> tuple[Array, Array, Array]:
    """Response of a line scan, as in `of_map`, with the density of profiles."""
    k, q = np.arange(1, math.floor(MOST) + 1), _sampled(math.floor(MOST) + _BEYOND)
    T = _transforms(k, q) - _levelled(k, q, degree).sum(axis=0)
    weight = (np.abs(T) ** 2).mean(axis=0) / _PER_PERIOD
    half = q > 0
    return k.astype(float), q[half], weight[:, half] + weight[:, ::-1][:, half]


def _sampled(most: int) -> Array:
    half = (np.arange(most * _PER_PERIOD) + 0.5) / _PER_PERIOD
    return np.concatenate([-half[::-1], half])


def _transforms(k: NDArray[np.int64], q: Array) -> NDArray[np.complex128]:
    """Transform of each taper times each wave, shape (tapers, k, q)."""
    x = (np.arange(_POINTS) + 0.5) / _POINTS
    waves = np.exp(2j * np.pi * np.outer(q, x))
    modes = np.exp(-2j * np.pi * np.outer(k, x)) / _POINTS
    return np.stack([(modes * taper) @ waves.T for taper in tapers(_POINTS)])


def _levelled(k: NDArray[np.int64], q: Array, degree: int) -> NDArray[np.complex128]:
    """What levelling subtracts from `_transforms`, shape (degree + 1, tapers, k, q)."""
    x = (np.arange(_POINTS) + 0.5) / _POINTS
    waves = np.exp(2j * np.pi * np.outer(q, x))
    modes = np.exp(-2j * np.pi * np.outer(k, x)) / _POINTS
    P = orthonormal_polynomials(_POINTS, degree).T if degree >= 0 else np.zeros((0, _POINTS))
    return np.array(
        [
            [np.outer((modes * taper) @ form, waves @ form) for taper in tapers(_POINTS)]
            for form in P
        ]
    ).reshape(len(P), len(tapers(_POINTS)), k.size, q.size)
