"""Johnson (1985): fully plastic impact of a sphere, elastic rebound, no adhesion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array
from .law import impact_energy

COEFFICIENT = 3.8
"""Coefficient printed by Johnson; the derived value is (3π^{5/4} 4^{3/4}/10)^½ 3^{5/8} = 3.743."""


@dataclass(frozen=True, eq=False)
class Johnson(PositiveFields):
    """Fully plastic impact at three times the yield strength: e = 3.8 (Y/E*)^½ (½m*V²/YR*³)^{−1/8}.

    Valid for fully developed plastic flow, E*a/YR* > 30 or so, which means e < 0.6 and V > 190 V_y
    with V_y of `FirstYield` at p_y = 1.6 Y, and for a ≪ R*. At lower velocity the formula
    overestimates e.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_strength: Yield strength Y of a tensile test (Pa).

    Source:
        K. L. Johnson, *Contact Mechanics* (1985), section 11.5.
    """

    radius: Values
    contact_modulus: Values
    yield_strength: Values

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e (dimensionless), 1 where the formula would exceed it."""
        reduced = impact_energy(velocity, mass) / (self.yield_strength * self.radius**3)
        unity = self._energy_of_unity
        return scalar_or_array((unity / np.maximum(reduced, unity)) ** 0.125)

    def velocity_at_restitution(self, restitution: Values, mass: Values) -> Array:
        """Impact velocity that gives a coefficient of restitution.

        Args:
            restitution: Coefficient of restitution e (dimensionless), above 0 and at most 1.
            mass: Reduced mass m* (kg).

        Returns:
            Relative normal velocity V (m/s).
        """
        (e,) = positive(restitution=restitution)
        return self._velocity(self._energy_of_unity / e**8, mass)

    def velocity_at_full_radius(self, mass: Values) -> Array:
        """Impact velocity V (m/s) at which the contact radius reaches R*."""
        return self._velocity(0.75 * np.pi, mass)

    @property
    def _energy_of_unity(self) -> Values:
        """Impact energy, divided by YR*³, at which the formula gives e = 1."""
        return (COEFFICIENT**2 * self.yield_strength / self.contact_modulus) ** 4

    def _velocity(self, reduced: Values, mass: Values) -> Array:
        """Impact velocity V (m/s) of an impact with the energy `reduced` · YR*³."""
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * reduced * self.yield_strength * self.radius**3 / m))
