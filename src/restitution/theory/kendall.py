"""Kendall (1971): a flat circular punch stuck to an elastic half-space, all of it at once.

K. Kendall, J. Phys. D: Appl. Phys. 4 (1971) 1186–1195, doi 10.1088/0022-3727/4/8/320. The contact
radius a stays fixed, so the punch is a spring of stiffness 2E*a whose rim is a crack of energy
release rate F²/(8πE*a³). It parts where that reaches the work of adhesion w:

    F = (8πE*wa³)^½,   drawn apart by F/(2E*a) = (2πwa/E*)^½.

Nothing recedes first: the least tension is the last. F grows as a^{3/2}, so the pressure F/(πa²) it
takes falls with size, and the work ½F²/(2E*a) = 2πwa² is twice the surface energy; the other half
is lost. Both numbers are what JKR takes off Hertz at the same contact radius (`jkr`).

Valid for a rigid punch (or an elastic one, in E*, where its sides do not matter), frictionless or
incompressible, with forces of range much shorter than the opening (2πwa/E*)^½, and a ≪ the bodies.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, Values, keep_positive, scalar_or_array, touching


@dataclass(frozen=True, eq=False)
class Kendall:
    """A punch on a half-space of `contact_modulus` E* (Pa), `work_of_adhesion` w (J/m²)."""

    contact_modulus: Values
    work_of_adhesion: Values

    def __post_init__(self) -> None:
        keep_positive(self, "contact_modulus", "work_of_adhesion")

    def pull_off_force(self, contact_radius: Values) -> Array:
        """Tension (8πE*wa³)^½ (N), as a magnitude, that parts a punch of `contact_radius` (m)."""
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(8 * np.pi * E_star * w * a**3))

    def pull_off_displacement(self, contact_radius: Values) -> Array:
        """Distance (2πwa/E*)^½ (m), as a magnitude, by which the punch is drawn out as it parts."""
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(2 * np.pi * a * w / E_star))
