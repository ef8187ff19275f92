"""Johnson (1985): fully plastic impact of a sphere, elastic rebound, no adhesion.

K. L. Johnson, Contact Mechanics (Cambridge, 1985), section 11.5. The contact of radius a flows at a
constant pressure p_d, and its indentation is δ = a²/2R*. W is the loading work and F the largest
force. The rebound is that of a Hertz contact with the flattened surface and returns the work W_u:

    ½ m* V² = W = πp_da⁴/4R*,   W_u = 3F²/10E*a,  F = πa²p_d
    e² = W_u/W = (3π^{5/4} 4^{3/4}/10) (p_d/E*) (W/p_dR*³)^{−1/4}

Johnson sets p_d = 3Y, the indentation pressure of a material of yield strength Y, and prints

    e = 3.8 (Y/E*)^½ (½m*V²/YR*³)^{−1/8}

The printed coefficient 3.8 is used here, although the equation for e² gives 3.74.

Valid for fully developed plastic flow, at E*a/YR* > 30 or so (his section 6.3). This range
corresponds to e < 0.6 for any material, and to V > 190 V_y, where V_y is `FirstYield.velocity` at
p_y = 1.6 Y. At lower velocity the contact pressure is below 3Y and the formula overestimates e. It
gives e = 1 at 28.5 V_y; at lower velocities e is limited to 1. The formula also requires a ≪ R*,
which limits the velocity from above. Rate effects on p_d are neglected.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array
from .law import impact_energy

COEFFICIENT = 3.8
"""Coefficient printed by Johnson; the derived value is (3π^{5/4} 4^{3/4}/10)^½ 3^{5/8} = 3.743."""


@dataclass(frozen=True, eq=False)
class Johnson(PositiveFields):
    """Fully plastic impact of a sphere at a contact pressure of three times the yield strength.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_strength: Yield strength Y of a tensile test (Pa).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        K. L. Johnson, *Contact Mechanics* (1985), section 11.5.
    """

    radius: Values
    contact_modulus: Values
    yield_strength: Values

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        The formula holds for e < 0.6. At low velocity, where it would exceed 1, e is set to 1.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e (dimensionless).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
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

        Raises:
            CaseError: `restitution` or `mass` is not positive and finite.
        """
        (e,) = positive(restitution=restitution)
        return self._velocity(self._energy_of_unity / e**8, mass)

    def velocity_at_full_radius(self, mass: Values) -> Array:
        """Impact velocity at which the contact radius a reaches R*.

        At this velocity the impact energy ½m*V² equals the loading work W = π 3Y a⁴/4R* with
        a = R*.

        Args:
            mass: Reduced mass m* (kg).

        Returns:
            Relative normal velocity V (m/s).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        return self._velocity(0.75 * np.pi, mass)

    @property
    def _energy_of_unity(self) -> Values:
        """Impact energy, divided by YR*³, at which the formula gives e = 1."""
        return (COEFFICIENT**2 * self.yield_strength / self.contact_modulus) ** 4

    def _velocity(self, reduced: Values, mass: Values) -> Array:
        """Impact velocity V (m/s) of an impact with the energy `reduced` · YR*³."""
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * reduced * self.yield_strength * self.radius**3 / m))
