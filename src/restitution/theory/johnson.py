"""Johnson (1985): fully plastic impact of a sphere, elastic rebound; no adhesion.

K. L. Johnson, Contact Mechanics (Cambridge, 1985), section 11.5. The contact of radius a flows at
the one pressure p_d and keeps δ = a²/2R*; the rebound is Hertz's from the flattened surface:

    ½ m* V² = W = πp_da⁴/4R*,   W_u = 3F²/10E*a,  F = πa²p_d
    e² = W_u/W = (3π^{5/4} 4^{3/4}/10) (p_d/E*) (W/p_dR*³)^{−1/4}

He sets p_d = 3Y, the indentation pressure of a material of yield strength Y, and prints

    e = 3.8 (Y/E*)^½ (½m*V²/YR*³)^{−1/8}

which is used here, although the line before it gives 3.74.

Valid once the plastic zone has broken out, E*a/YR* > 30 or so (his section 6.3): e < 0.6 whatever
the materials, V > 190 V_y with `FirstYield.velocity` at p_y = 1.6 Y. Below, the contact carries
less than 3Y and the formula returns too much; it reaches 1 at 28.5 V_y and is held there. Above,
the limit is a ≪ R*. Rate effects on p_d are left out.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, Values, keep_positive, positive, scalar_or_array, touching

COEFFICIENT = 3.8
"""As printed; (3π^{5/4} 4^{3/4}/10)^½ 3^{5/8} = 3.743 as derived."""


@dataclass(frozen=True, eq=False)
class Johnson:
    """Spheres that flow at three times the `yield_strength` Y (Pa) of a tensile test.

    `radius` is R* (m), `contact_modulus` E* (Pa).
    """

    radius: Values
    contact_modulus: Values
    yield_strength: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "yield_strength")

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e after an impact at relative normal `velocity` (m/s).

        At most 1, which is where it is out of its range; the formula holds for e < 0.6.
        """
        (m,) = positive(mass=mass)
        reduced = 0.5 * m * touching(velocity) ** 2 / (self.yield_strength * self.radius**3)
        unity = self._energy_of_unity
        return scalar_or_array((unity / np.maximum(reduced, unity)) ** 0.125)

    def velocity_at_restitution(self, restitution: Values, mass: Values) -> Array:
        """Relative normal velocity V (m/s) after which e is `restitution`, 1 or less."""
        (e,) = positive(restitution=restitution)
        return self._velocity(self._energy_of_unity / e**8, mass)

    def velocity_at_full_radius(self, mass: Values) -> Array:
        """Relative normal velocity V (m/s) of an impact that reaches a = R*: W = π 3Y a⁴/4R*."""
        return self._velocity(0.75 * np.pi, mass)

    @property
    def _energy_of_unity(self) -> Values:
        """½m*V²/YR*³ at which e = 1."""
        return (COEFFICIENT**2 * self.yield_strength / self.contact_modulus) ** 4

    def _velocity(self, reduced: Values, mass: Values) -> Array:
        """V (m/s) at a reduced energy ½m*V²/YR*³."""
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * reduced * self.yield_strength * self.radius**3 / m))
