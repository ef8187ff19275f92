"""Reproducible random numbers: a seed gives the same numbers with every version of NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.surfaces.surface import Array


def white_noise(shape: tuple[int, int], seed: int) -> Array:
    """Independent standard normal numbers in an array of this shape."""
    from scipy.special import ndtri

    # NumPy never changes the raw stream of a bit generator, but the methods of Generator (such as
    # standard_normal) can change between releases (NEP 19). So the raw 64-bit words are mapped to
    # normal numbers here. The inverse normal distribution is infinite at 0 and 1, but
    # u = (52 bits + ½)/2⁵² never reaches these values. With 53 bits, u could round to 1.
    u = (_random_bits(np.random.PCG64(seed), shape[0] * shape[1]) + 0.5) * 2.0**-52
    return np.asarray(ndtri(u).reshape(shape))


def wave_phases(seed: int, numbers: NDArray[np.int64], count: int) -> Array:
    """Random phases (rad) of the waves of m periods along x, n in 0 … `count` − 1 along y.

    The shape is (numbers.size, count). A phase depends only on `seed`, m and n, so a finer grid
    keeps the phases of a coarser grid. Waves (m, 0) and (−m, 0) have opposite phases: heights are
    real.
    """
    phases = np.empty((numbers.size, count))
    for row, m in enumerate(numbers.tolist()):
        # Each m has its own random stream.
        phases[row] = _random_bits(_stream(seed, m), count)
        if m < 0:
            phases[row, 0] = -_random_bits(_stream(seed, -m), 1)[0]
    phases *= 2.0**-51 * np.pi
    return phases


def _stream(seed: int, m: int) -> np.random.Philox:
    return np.random.Philox(key=np.array([seed, m % 2**64], dtype=np.uint64))


def _random_bits(stream: np.random.BitGenerator, count: int) -> Array:
    return (stream.random_raw(count) >> np.uint64(12)).astype(np.float64)
