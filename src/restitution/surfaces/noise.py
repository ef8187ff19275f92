"""Random numbers that stay the same: what a seed means may not change with a library."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray


def white_noise(shape: tuple[int, int], seed: int) -> NDArray[np.float64]:
    """Independent standard normal numbers of the given shape."""
    from scipy.special import ndtri

    # numpy keeps the raw stream of a bit generator fixed for ever, but lets the methods of
    # Generator (standard_normal and the like) change from release to release (NEP 19). So the
    # raw 64-bit words are mapped here. 52 of their bits and a half keep u off 0 and 1, where
    # the inverse distribution is infinite; a 53rd bit would round up to 1.
    raw = np.random.PCG64(seed).random_raw(shape[0] * shape[1])
    u = ((raw >> np.uint64(12)).astype(np.float64) + 0.5) * 2.0**-52
    noise: NDArray[np.float64] = ndtri(u).reshape(shape)
    return noise


def wave_phases(seed: int, numbers: NDArray[np.int64], count: int) -> NDArray[np.float64]:
    """Phases (rad) of the waves with numbers (m, n), m in `numbers` and n in 0 … count − 1.

    Shape (numbers.size, count). A phase depends on `seed`, m and n alone, so that a finer grid
    has the phases of a coarser one and more. Waves with n = 0 come in conjugate pairs, m and −m.
    """
    phases = np.empty((numbers.size, count))
    for row, m in enumerate(numbers.tolist()):
        # One stream for each m; like that of PCG64, the raw stream of Philox never changes.
        key = np.array([seed, m % 2**64], dtype=np.uint64)
        raw = np.random.Philox(key=key).random_raw(count)
        phases[row] = (raw >> np.uint64(12)).astype(np.float64)
        if m < 0:
            opposite = np.random.Philox(key=np.array([seed, -m], dtype=np.uint64)).random_raw(1)
            phases[row, 0] = -(opposite >> np.uint64(12)).astype(np.float64)[0]
    phases *= 2.0**-51 * np.pi
    return phases
