"""An upper bound that grows with a logarithm, node by node (see `contact.plasticity.cavity`)."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.kernels import use_loop

Array = NDArray[Any]
Constants = tuple[float, float, float, float]
OfRidge = tuple[float, float, float]

_SMALLEST = 1e-300  # takes the place of 0 in a logarithm


@use_loop
def growing_bound(
    pressure: Array,
    smooth: tuple[Array, Array],
    shape: tuple[Array, Array],
    depths: tuple[float, float],
    harder: Array,
    constants: Constants,
    of_ridge: OfRidge,
    out: Array,
) -> None:
    """Write `bound_of` ln(m/m₁), at least 0, to `out`.

    With f = δ₂/δ, m = p/√f [f(δ − h)/(fδ − h)]^s, s = max(1 − (H √f/p)^1.5, 0) and q = e s; both
    ln and q are 0 where p, the `pressure`, is 0. m₁ is m₀ times 1 + q times the first value of
    `of_ridge`. `smooth` holds a column and a row whose sum is H² (0 where negative), `shape` h and
    e, `depths` δ and δ₂. ln is smaller by
    `harder`, the logarithm of the ratio of a local strength to that of the `constants`.
    """
    depth, deeper = depths
    factor, (crest_gap, elongation) = deeper / depth, shape
    nodes = np.nonzero(pressure)
    value = pressure[nodes] / np.sqrt(factor)
    hertz = np.sqrt(np.maximum(smooth[0] + smooth[1], 0))[nodes]
    apart, gap = np.maximum(1 - (hertz / value) ** 1.5, 0), crest_gap[nodes]
    ridge = elongation[nodes] * apart
    grown = np.log(value / (constants[0] * (1 + of_ridge[0] * ridge)))
    grown += apart * np.log(factor * np.maximum(depth - gap, _SMALLEST) / (deeper - gap))
    grown -= harder[nodes]
    out[...] = bound_of(np.zeros(1), np.zeros(1), constants, of_ridge)
    out[nodes] = bound_of(np.maximum(grown, 0), ridge, constants, of_ridge)


@use_loop
def step_sums(now: Array, before: Array, begun: Array, bound: Array) -> tuple[float, float, float]:
    """Sums for the plastic work of a step with the displacement Δ = `now` − `before`.

    Σ Δ `begun`, and Σ Δ (`bound` − `begun`) where `before` > 0 and elsewhere.
    """
    given = now - before
    more = given * (bound - begun)
    yielded = before > 0
    whole, on, fresh = given * begun, more * yielded, more * ~yielded
    return float(whole.sum()), float(on.sum()), float(fresh.sum())


def bound_of(growth: Array, ridge: Array, constants: Constants, of_ridge: OfRidge) -> Array:
    """min(m₀ + s·growth, M) (1 + h (m₁/m₀) (e^growth − 1)); m₀, s, M and h are the `constants`.

    m₀, s and M are larger by `of_ridge` times `ridge`.
    """
    onset, slope, largest, hardening = constants
    begin, steeper, higher = (1 + more * ridge for more in of_ridge)
    bound = np.minimum(onset * begin + slope * steeper * growth, largest * higher)
    return bound * (1 + hardening * begin * np.expm1(growth)) if hardening else bound
