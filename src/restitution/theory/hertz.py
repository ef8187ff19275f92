"""Hertz (1882): smooth, frictionless, linear elastic spheres.

At the indentation δ the contact radius a follows from a² = R*δ. The force F, the elastic energy W
and the pressure p at the distance r from the axis are (Johnson 1985, *Contact Mechanics*, section
4.2):

    F = 4/3 E* R*^½ δ^{3/2},   W = 8/15 E* R*^½ δ^{5/2},
    p(r) = p₀ (1 − r²/a²)^½,   p₀ = 2E*a/(πR*).

Valid for contacts small compared with the spheres (a < 0.1 R* or so, δ < 0.01 R*), up to first
yield (δ ≤ `FirstYield.indentation`) and without adhesion.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching


@dataclass(frozen=True, eq=False)
class Hertz(PositiveFields):
    """Hertz contact of smooth elastic spheres.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        H. Hertz (1882); K. L. Johnson, *Contact Mechanics* (1985), section 4.2.
    """

    radius: Values
    contact_modulus: Values

    def force(self, indentation: Values) -> Array:
        """Normal force at an indentation.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F = 4/3 E* R*^½ δ^{3/2} (N), positive in compression.
        """
        return 4 / 3 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 1.5

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force at a contact radius.

        Args:
            contact_radius: Contact radius a (m).

        Returns:
            Normal force F = 4E*a³/(3R*) (N).
        """
        return 4 * self.contact_modulus * touching(contact_radius) ** 3 / (3 * self.radius)

    def indentation(self, force: Values) -> Array:
        """Indentation under a normal force; the inverse of `force`.

        Args:
            force: Normal force F (N).

        Returns:
            Indentation δ (m).
        """
        stiffness = self.contact_modulus * self.radius**0.5
        return scalar_or_array((0.75 * touching(force) / stiffness) ** (2 / 3))

    def indentation_from_energy(self, energy: Values) -> Array:
        """Indentation at which an elastic energy is stored; the inverse of `stored_energy`.

        Args:
            energy: Elastic energy W (J).

        Returns:
            Indentation δ (m).
        """
        W = touching(energy)
        return scalar_or_array((15 * W / (8 * self.contact_modulus * self.radius**0.5)) ** 0.4)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius at an indentation.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Contact radius a = (R*δ)^½ (m).
        """
        return scalar_or_array(np.sqrt(self.radius * touching(indentation)))

    def contact_area(self, indentation: Values) -> Array:
        """Contact area at an indentation.

        Undeformed spheres at the same approach would intersect in a circle of twice this area.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Contact area πa² = πR*δ (m²).
        """
        return np.pi * self.radius * touching(indentation)

    def stored_energy(self, indentation: Values) -> Array:
        """Elastic energy stored from first touch to an indentation.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Elastic energy W = ∫F dδ = 8/15 E* R*^½ δ^{5/2} (J).
        """
        return 8 / 15 * self.contact_modulus * self.radius**0.5 * touching(indentation) ** 2.5

    def impact_velocity(self, indentation: Values, mass: Values) -> Array:
        """Impact velocity that is just large enough to reach an indentation.

        The impact energy ½ m* V² then equals the elastic energy stored at this indentation.

        Args:
            indentation: Approach δ of the spheres (m).
            mass: Reduced mass m* (kg).

        Returns:
            Relative normal velocity V (m/s).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,) = positive(mass=mass)
        return scalar_or_array(np.sqrt(2 * self.stored_energy(indentation) / m))

    def peak_pressure(self, indentation: Values) -> Array:
        """Pressure at the centre of the contact, 3/2 of the mean pressure.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Peak pressure p₀ = 2E*a/(πR*) (Pa), with the contact radius a.
        """
        # p₀ = 2E*a/(πR*) with a = (R*δ)^½
        return 2 * self.contact_modulus / np.pi * (touching(indentation) / self.radius) ** 0.5

    def pressure(self, radial_distance: Values, indentation: Values) -> Array:
        """Pressure at a distance from the axis.

        For profiles at several depths choose shapes that broadcast: distances of shape (n,) and
        indentations of shape (m, 1) give pressures of shape (m, n).

        Args:
            radial_distance: Distance r from the axis (m); its sign does not matter.
            indentation: Approach δ of the spheres (m).

        Returns:
            Pressure p(r) = p₀ (1 − r²/a²)^½ (Pa), with the peak pressure p₀ and the contact radius
            a; zero outside the contact.
        """
        r, R = np.asarray(radial_distance, dtype=np.float64), self.radius
        d = touching(indentation)  # p = p₀ (1 − r²/a²)^½ with a² = R*δ
        return 2 * self.contact_modulus / (np.pi * R) * touching(R * d - r**2) ** 0.5
