"""The impact velocities of a sequence: in turn, or drawn from a distribution."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from itertools import cycle

import numpy as np

from restitution.errors import CaseError


def in_turn(velocities: Sequence[float]) -> Iterator[float]:
    """The `velocities` (m/s), one after the other, again and again."""
    return cycle(velocities)


def drawn(velocities: Sequence[float], weights: Sequence[float], seed: int) -> Iterator[float]:
    """One of the `velocities` (m/s) with the probability `weights`, again and again.

    Raises:
        CaseError: A weight is negative, or all are 0.
    """
    share = np.array(weights, dtype=float)
    if not (share >= 0).all() or not share.sum() > 0:
        raise CaseError("weights: must not be negative, and not all 0")
    random = np.random.default_rng(seed)
    while True:
        yield float(random.choice(velocities, p=share / share.sum()))


def rayleigh(mean: float, seed: int) -> Iterator[float]:
    """Normal velocities of impacts in a gas with Maxwell's distribution, with this mean (m/s).

    Source: Chapman and Cowling (1970), The Mathematical Theory of Non-uniform Gases, §5.2: impacts
    of relative velocity v occur with the density v exp(−v²/2σ²).
    """
    random = np.random.default_rng(seed)
    while True:
        yield float(random.rayleigh(mean / math.sqrt(0.5 * math.pi)))
