"""Viscoelastic Hertz contact (Brilliantov, Pöschel): restitution as a Padé approximant."""

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
    """Viscoelastic spheres, ẍ + k x^{3/2} + γ x^½ ẋ = 0 until the force returns to zero at x > 0.

    The restitution depends on v = β^½ V^{1/10} alone. The error of the Padé approximant is at most
    10⁻⁵ up to v = 0.2 (e ≥ 0.95), 10⁻³ up to v = 0.6 (e ≥ 0.68) and 0.009 for any v. Valid for a ≪
    R*, without yield or adhesion, if the relaxation time of the material is shorter than the
    impact.

    Attributes:
        dissipation: Dissipation parameter β = γ/k^{3/5} (SI, s^{1/5}·m^{−1/5}), where γ and k are
            the damping and the stiffness of the contact, both divided by the reduced mass.

    Source:
        N. V. Brilliantov et al., Phys. Rev. E 53 (1996) 5382–5392; R. Ramírez et al., Phys. Rev. E
        60 (1999) 4465–4472; P. Müller, T. Pöschel, Phys. Rev. E 84 (2011) 021302.
    """

    dissipation: Values

    @classmethod
    def from_material(
        cls, radius: Values, contact_modulus: Values, dissipative_time: Values, mass: Values
    ) -> Self:
        """Make the law from the dissipative constant A of the material.

        β = 3/2 A (4E*R*^½/(3m*))^{2/5}.

        Args:
            radius: Reduced radius R* (m).
            contact_modulus: Contact modulus E* (Pa).
            dissipative_time: Dissipative constant A (s).
            mass: Reduced mass m* (kg).

        Returns:
            The law for these spheres.
        """
        A, m = positive(dissipative_time=dissipative_time, mass=mass)
        return cls(1.5 * A * (Hertz(radius, contact_modulus).force(1.0) / m) ** 0.4)

    def restitution(self, velocity: Values) -> Array:
        """Coefficient of restitution e (dimensionless)."""
        v = self.dissipation**0.5 * touching(velocity) ** 0.1
        return scalar_or_array(np.polyval(_NUMERATOR, v) / np.polyval(_DENOMINATOR, v))
