"""The interface of impact laws, the impact energy, and the restitution from unloading work."""

from __future__ import annotations

from typing import Protocol

import numpy as np

from ._inputs import Array, Values, positive, scalar_or_array, touching


class ImpactLaw(Protocol):
    """A contact law that predicts the restitution of an impact."""

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after a normal impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e (dimensionless).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        ...


def impact_energy(velocity: Values, mass: Values) -> Array:
    """Impact energy ½ m* V² (J), where V is the velocity (m/s) and m* the reduced mass (kg)."""
    (m,) = positive(mass=mass)
    return 0.5 * m * touching(velocity) ** 2


def restitution_of_work(unloading_work: Values, velocity: Values, mass: Values) -> Array:
    """Coefficient of restitution e = (W_u/½m*V²)^½, limited to 1; 0 where W_u ≤ 0.

    `unloading_work` W_u (J) is the work that the contact returns, `velocity` V (m/s) the impact
    velocity and `mass` m* (kg) the reduced mass. The result is 1 at zero or negative velocity.
    """
    W_l = impact_energy(velocity, mass)
    e = (touching(unloading_work) / np.where(W_l > 0, W_l, 1.0)) ** 0.5
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, np.minimum(e, 1.0)))
