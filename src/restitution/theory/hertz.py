"""Hertz (1882): smooth, frictionless, linear elastic spheres.

With a² = R*δ the contact radius (Johnson 1985, *Contact Mechanics*, section 4.2):

    F = 4/3 E* R*^½ δ^{3/2},   W = 8/15 E* R*^½ δ^{5/2},
    p(r) = p₀ (1 − r²/a²)^½,   p₀ = 2E*a/(πR*).

Valid while the contact is small beside the spheres (a ≪ R*, about a < 0.1 R*, that is
δ < 0.01 R*) and nothing has yielded: δ ≤ `FirstYield.indentation`. No adhesion.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, Values, keep_positive, positive, scalar_or_array, touching


@dataclass(frozen=True, eq=False)
class Hertz:
    """Elastic spheres of reduced radius `radius` R* (m) and `contact_modulus` E* (Pa)."""

    radius: Values
    contact_modulus: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus")

    def force(self, indentation: Values) -> Array:
        """Normal force F (N), compressive positive."""
        return 4 / 3 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 1.5

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force F = 4E*a³/(3R*) (N)."""
        a = touching(contact_radius)
        return 4 * self.contact_modulus * a**3 / (3 * self.radius)

    def indentation(self, force: Values) -> Array:
        """Indentation δ (m) under a normal force (N); the inverse of `force`."""
        F = touching(force)
        return scalar_or_array((0.75 * F / (self.contact_modulus * self.radius**0.5)) ** (2 / 3))

    def indentation_from_energy(self, energy: Values) -> Array:
        """Indentation δ (m) at which `energy` (J) is stored; the inverse of `stored_energy`."""
        W = touching(energy)
        return scalar_or_array((15 * W / (8 * self.contact_modulus * self.radius**0.5)) ** 0.4)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a = (R*δ)^½ (m)."""
        return scalar_or_array(np.sqrt(self.radius * touching(indentation)))

    def contact_area(self, indentation: Values) -> Array:
        """Contact area πa² = πR*δ (m²): half the area the undeformed spheres would overlap in."""
        return np.pi * self.radius * touching(indentation)

    def stored_energy(self, indentation: Values) -> Array:
        """Elastic energy W = ∫F dδ (J) stored from first touch to `indentation`."""
        return 8 / 15 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 2.5

    def impact_velocity(self, indentation: Values, mass: Values) -> Array:
        """Relative normal velocity V (m/s) that reaches `indentation`: ½ m* V² = W."""
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * self.stored_energy(indentation) / m))

    def peak_pressure(self, indentation: Values) -> Array:
        """Pressure p₀ in the centre of the contact (Pa), 3/2 of the mean."""
        d = touching(indentation)  # 2E*a/(πR*) with a = (R*δ)^½
        return 2 * self.contact_modulus / np.pi * (d / self.radius) ** 0.5

    def pressure(self, radial_distance: Values, indentation: Values) -> Array:
        """Pressure p(r) (Pa) at `radial_distance` (m) from the axis, zero outside the contact.

        For a profile at several depths give the distances and the indentations shapes that
        broadcast: (n,) and (m, 1) make (m, n). The sign of the distance does not matter.
        """
        r, R = np.asarray(radial_distance, dtype=np.float64), self.radius
        d = touching(indentation)  # p₀(1 − r²/a²)^½, a² = R*δ
        return 2 * self.contact_modulus / (np.pi * R) * touching(R * d - r**2) ** 0.5
