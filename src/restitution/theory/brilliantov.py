"""Viscoelastic Hertz contact (Brilliantov, Pöschel): restitution as a Padé approximant.

N. V. Brilliantov, F. Spahn, J.-M. Hertzsch, T. Pöschel, Phys. Rev. E 53 (1996) 5382–5392; R.
Ramírez, T. Pöschel, N. V. Brilliantov, T. Schwager, Phys. Rev. E 60 (1999) 4465–4472; P. Müller, T.
Pöschel, Phys. Rev. E 84 (2011) 021302, arXiv:1102.5247. After first touch at the impact velocity V,
the equation of motion of the approach x is

    ẍ + k x^{3/2} + γ x^½ ẋ = 0,   ẋ(0) = V,   until the force returns to zero (ẍ = 0, x > 0)

After scaling, this equation contains a single parameter, v = β^½ V^{1/10} with β = γ/k^{3/5}. The
dissipative constant A of the material, which is a time, determines γ and β. The restitution e
depends on v alone:

    k = 4E*R*^½/(3m*),  γ = 3/2 A k,  β = 3/2 A k^{2/5}
    series   e = 1 − 1.153449 v² + 0.798267 v⁴ + 0.266666 v⁵ − …
    Padé     e = (1 + 0.501086 v)/(1 + 0.501086 v + 1.15345 v² + 0.577977 v³ + 0.532178 v⁴)

The Padé approximant of e was compared with a numerical solution of the equation of motion. Its
error is at most 10⁻⁵ up to v = 0.2 (e ≥ 0.95), 10⁻³ up to v = 0.6 (e ≥ 0.68) and 0.009 for any v.
If e < 0.2, an error of 0.009 is more than 4.5 % of e.

Valid for smooth spheres with contact radius a ≪ R*, without yield or adhesion, if the relaxation
time of the material is shorter than the impact. The contact ends when the force returns to zero, at
x > 0. If it ended at x = 0, e would be lower.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching
from .hertz import Hertz

_NUMERATOR = 0.501086, 1.0
_DENOMINATOR = 0.532178, 0.577977, 1.15345, 0.501086, 1.0


@dataclass(frozen=True, eq=False)
class Brilliantov(PositiveFields):
    """Impact of viscoelastic spheres.

    The field and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        dissipation: Dissipation parameter β = γ/k^{3/5} (SI, s^{1/5}·m^{−1/5}), where γ and k are
            the damping and the stiffness of the contact, both divided by the reduced mass.

    Raises:
        CaseError: The dissipation is not positive and finite.

    Source:
        P. Müller, T. Pöschel, Phys. Rev. E 84 (2011) 021302.
    """

    dissipation: Values

    @classmethod
    def from_material(
        cls, radius: Values, contact_modulus: Values, dissipative_time: Values, mass: Values
    ) -> Self:
        """Make the law from the dissipative constant A of the material.

        The dissipation parameter is β = 3/2 A (4E*R*^½/(3m*))^{2/5}.

        Args:
            radius: Reduced radius R* (m).
            contact_modulus: Contact modulus E* (Pa).
            dissipative_time: Dissipative constant A (s).
            mass: Reduced mass m* (kg).

        Returns:
            The law for these spheres.

        Raises:
            CaseError: An argument is not positive and finite.
        """
        A, m = positive(dissipative_time=dissipative_time, mass=mass)
        return cls(1.5 * A * (Hertz(radius, contact_modulus).force(1.0) / m) ** 0.4)

    def restitution(self, velocity: Values) -> Array:
        """Coefficient of restitution after an impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).

        Returns:
            Coefficient of restitution e (dimensionless); 1 at zero or negative velocity.
        """
        v = self.dissipation**0.5 * touching(velocity) ** 0.1
        return scalar_or_array(np.polyval(_NUMERATOR, v) / np.polyval(_DENOMINATOR, v))
