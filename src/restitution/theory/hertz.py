"""Hertz (1882): smooth, frictionless, linear elastic spheres."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching


@dataclass(frozen=True, eq=False)
class Hertz(PositiveFields):
    """Smooth elastic spheres: F = 4/3 E* R*^½ δ^{3/2} on the contact radius a = (R*δ)^½.

    Valid for a < 0.1 R* or so, up to first yield and without adhesion.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).

    Source:
        H. Hertz (1882); K. L. Johnson, *Contact Mechanics* (1985), section 4.2.
    """

    radius: Values
    contact_modulus: Values

    def force(self, indentation: Values) -> Array:
        """Normal force F (N)."""
        return 4 / 3 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 1.5

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force 4E*a³/(3R*) (N)."""
        return 4 * self.contact_modulus * touching(contact_radius) ** 3 / (3 * self.radius)

    def indentation(self, force: Values) -> Array:
        """Indentation δ (m); the inverse of `force`."""
        stiffness = self.contact_modulus * self.radius**0.5
        return scalar_or_array((0.75 * touching(force) / stiffness) ** (2 / 3))

    def indentation_from_energy(self, energy: Values) -> Array:
        """Indentation δ (m); the inverse of `stored_energy`."""
        W = touching(energy)
        return scalar_or_array((15 * W / (8 * self.contact_modulus * self.radius**0.5)) ** 0.4)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a (m)."""
        return scalar_or_array(np.sqrt(self.radius * touching(indentation)))

    def contact_area(self, indentation: Values) -> Array:
        """Contact area πR*δ (m²), half the intersection of undeformed spheres."""
        return np.pi * self.radius * touching(indentation)

    def stored_energy(self, indentation: Values) -> Array:
        """Elastic energy W = 8/15 E* R*^½ δ^{5/2} (J)."""
        return 8 / 15 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 2.5

    def impact_velocity(self, indentation: Values, mass: Values) -> Array:
        """Smallest impact velocity V (m/s) that reaches an indentation."""
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * self.stored_energy(indentation) / m))

    def duration(self, velocity: Values, mass: Values) -> Array:
        """Duration 2.87 (m*²/(R* E*² V))^⅕ (s) of an impact.

        Source:
            K. L. Johnson, *Contact Mechanics* (1985), eq. 11.24.
        """
        V, m = positive(velocity=velocity, mass=mass)
        return scalar_or_array(2.87 * (m**2 / (self.radius * self.contact_modulus**2 * V)) ** 0.2)

    def peak_pressure(self, indentation: Values) -> Array:
        """Pressure p₀ = 2E*a/(πR*) (Pa) at the centre, 3/2 of the mean pressure."""
        # p₀ = 2E*a/(πR*) with a = (R*δ)^½
        return 2 * self.contact_modulus / np.pi * (touching(indentation) / self.radius) ** 0.5

    def pressure(self, radial_distance: Values, indentation: Values) -> Array:
        """Pressure p₀ (1 − r²/a²)^½ (Pa); zero outside the contact."""
        r, R = np.asarray(radial_distance, dtype=np.float64), self.radius
        d = touching(indentation)  # p = p₀ (1 − r²/a²)^½ with a² = R*δ
        return 2 * self.contact_modulus / (np.pi * R) * touching(R * d - r**2) ** 0.5
