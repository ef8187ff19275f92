"""What the laws of contact share where callers treat them alike: the answer to an impact."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ._inputs import Array, Values, positive, scalar_or_array, touching


class ImpactLaw(Protocol):
    """A contact law that answers an impact."""

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact of `mass` m* (kg) at `velocity` (m/s)."""
        ...


def restitution_of_work(unloading_work: Values, velocity: Values, mass: Values) -> Array:
    """Coefficient of restitution e = (W_u/½m*V²)^½: 0 where W_u ≤ 0, never above 1.

    `unloading_work` W_u (J) is what the contact gives back. 1 at and below zero `velocity` (m/s),
    where nothing approaches.
    """
    (m,) = positive(mass=mass)
    W_l = 0.5 * m * touching(velocity) ** 2
    e = (touching(unloading_work) / np.where(W_l > 0, W_l, 1.0)) ** 0.5
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, np.minimum(e, 1.0)))
