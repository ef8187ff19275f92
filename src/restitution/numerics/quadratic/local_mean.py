"""Local means of the nonzero values of an array, around points of a coarse lattice ("places")."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]  # double or single precision


@use_loop
def local_sums(r: Array, mask: Array, sums: Array, nodes: Array) -> None:
    """Sum r where `mask` ≠ 0 and count these nodes around each place, into `sums` and `nodes`.

    Along each axis there are at least two places. A node between two places contributes to both
    with linear weights (hat functions).
    """
    over_x, over_y = _hat_weights(r, sums)
    counted = (mask != 0).astype(np.float64)
    sums[...] = over_x.T @ (r * counted) @ over_y
    nodes[...] = over_x.T @ counted @ over_y


@use_loop
def subtract_local_mean(
    r: Array, mask: Array, share: float, sums: Array, nodes: Array, out: Array
) -> None:
    """Write r minus `share` times its local mean into `out`, and zero where `mask` = 0.

    The local mean is the ratio of `sums` and `nodes`, both interpolated between the places.
    """
    over_x, over_y = _hat_weights(r, sums)
    total, count = (over_x @ at_places @ over_y.T for at_places in (sums, nodes))
    np.multiply(r - share * total / (count + (mask == 0)), mask != 0, out=out)


def damp_local_mean(
    r: Array, share: float, places: int, out: Array, mask: Array | None = None
) -> None:
    """Write r minus `share` times its local mean into `out`, and zero where `mask` = 0.

    The lattice has `places` points along each axis. `out` may be `r`, which is the mask by default.
    """
    mask = r if mask is None else mask
    sums, nodes = np.empty_like(r, dtype=np.float64, shape=(2, places, places))
    local_sums(r, mask, sums, nodes)
    subtract_local_mean(r, mask, share, sums, nodes, out)


def _hat_weights(r: Array, places: Array) -> list[Array]:
    """Hat functions, one matrix (nodes, places) for x and one for y."""
    hats = []
    for n, m in zip(r.shape, places.shape, strict=True):
        node, place = (np.cumsum(np.ones_like(places, shape=k)) for k in (n, m))
        position = np.clip((node - 0.5) * m / n + 0.5, 1, m)
        hats.append(np.maximum(0.0, 1.0 - np.abs(position[:, None] - place)))
    return hats
