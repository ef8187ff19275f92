"""The interface of impact laws, the impact energy, and the restitution from unloading work."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ._inputs import Array, Values, positive, scalar_or_array, touching


class ImpactLaw(Protocol):
    """A contact law that predicts the restitution of an impact."""

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e (dimensionless) after a normal impact."""
        ...


def impact_energy(velocity: Values, mass: Values) -> Array:
    """Impact energy ½ m* V² (J)."""
    (m,) = positive(mass=mass)
    return 0.5 * m * touching(velocity) ** 2


def restitution_of_work(unloading_work: Values, velocity: Values, mass: Values) -> Array:
    """Restitution (W_u/½m*V²)^½, at most 1; 0 where the unloading work W_u (J) is not positive."""
    W_l = impact_energy(velocity, mass)
    e = (touching(unloading_work) / np.where(W_l > 0, W_l, 1.0)) ** 0.5
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, np.minimum(e, 1.0)))
