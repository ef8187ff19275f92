"""Kendall (1971): a flat circular punch that adheres to an elastic half-space.

K. Kendall, J. Phys. D: Appl. Phys. 4 (1971) 1186–1195, doi 10.1088/0022-3727/4/8/320. The contact
radius a is fixed, so the contact is a spring of stiffness 2E*a. Its rim is a crack with energy
release rate F²/(8πE*a³). The punch detaches when this rate reaches the work of adhesion w:

    F = (8πE*wa³)^½,   displacement F/(2E*a) = (2πwa/E*)^½.

The whole contact detaches at once, because crack growth raises the energy release rate. F grows as
a^{3/2}, so the mean tension F/(πa²) at detachment decreases with a. The work up to detachment,
½F²/(2E*a) = 2πwa², is twice the surface energy πwa² of the contact; half of this work is
dissipated. JKR theory (`jkr`) subtracts this force and this displacement from the force and the
indentation of a Hertz contact of the same radius.

Valid under four conditions:

- The contact is frictionless, or the half-space is incompressible.
- The range of the surface forces is much shorter than the displacement (2πwa/E*)^½.
- The radius a is much smaller than the bodies.
- The punch is rigid. An elastic punch is also allowed if E* includes the compliance of the punch
  and the influence of its side walls is negligible.

Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, scalar_or_array, touching


@dataclass(frozen=True, eq=False)
class Kendall(PositiveFields):
    """Flat circular punch that adheres to an elastic half-space.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        contact_modulus: Contact modulus E* (Pa).
        work_of_adhesion: Work of adhesion w (J/m²).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        K. Kendall, J. Phys. D: Appl. Phys. 4 (1971) 1186–1195.
    """

    contact_modulus: Values
    work_of_adhesion: Values

    def pull_off_force(self, contact_radius: Values) -> Array:
        """Tensile force that detaches the punch.

        Args:
            contact_radius: Radius a of the punch (m).

        Returns:
            Magnitude of the tension (8πE*wa³)^½ (N).
        """
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(8 * np.pi * E_star * w * a**3))

    def pull_off_displacement(self, contact_radius: Values) -> Array:
        """Displacement of the punch, away from the half-space, at which it detaches.

        Args:
            contact_radius: Radius a of the punch (m).

        Returns:
            Magnitude of the displacement (2πwa/E*)^½ (m).
        """
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(2 * np.pi * a * w / E_star))
