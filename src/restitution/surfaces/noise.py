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
