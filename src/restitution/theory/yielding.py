"""First yield of a Hertz contact: the peak pressure reaches the yield pressure p_y."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.errors import CaseError

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array

# Impact velocity at first yield in units of (p_y⁵R*³/(E*⁴m*))^½; its value is 3.19385.
_COEFFICIENT = math.sqrt(math.pi**5 / 30)
_EXP = np.vectorize(math.exp, otypes=[np.float64])  # same result on every processor, unlike np.exp


@dataclass(frozen=True, eq=False)
class FirstYield(PositiveFields):
    """First yield of a Hertz contact; exact within Hertz theory, which requires p_y ≪ E*.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_pressure: Contact pressure p_y at yield (Pa), not the yield strength Y of a tensile
            test: about 1.6 Y at first yield below the surface, 2.8–3 Y for fully plastic flow.

    Source:
        K. L. Johnson, *Contact Mechanics* (1985), sections 4.2, 6.1 and 6.3.
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values

    @property
    def indentation(self) -> Array:
        """Indentation δ_y = (πp_y/2E*)² R* (m) at first yield."""
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        return scalar_or_array((np.pi * p_y / (2 * E_star)) ** 2 * R)

    @property
    def force(self) -> Array:
        """Normal force F_y = π³R*²p_y³/(6E*²) (N) at first yield."""
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        return scalar_or_array(np.pi**3 / 6 * (R / E_star) ** 2 * p_y**3)

    def velocity(self, mass: Values) -> Array:
        """Largest velocity V_y = (π⁵/30)^½ (p_y⁵R*³/(E*⁴m*))^½ (m/s) of an elastic impact."""
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        (m,) = positive(mass=mass)
        return _COEFFICIENT * (p_y / E_star) ** 2 * (p_y * R**3 / m) ** 0.5


def yield_coefficient(poissons_ratio: Values) -> Array:
    """Ratio C = 1.295 exp(0.736 ν) of the peak Hertz pressure at first yield to the yield strength.

    A fit to the largest von Mises stress, accurate within ½ % for 0 ≤ ν ≤ ½.

    Args:
        poissons_ratio: Poisson's ratio ν (dimensionless).

    Returns:
        Yield coefficient C (dimensionless).

    Raises:
        CaseError: Poisson's ratio is outside the range −1 < ν ≤ ½.

    Source:
        R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354.
    """
    nu = np.asarray(poissons_ratio, dtype=np.float64)
    bad = ~((nu > -1) & (nu <= 0.5))
    if bad.any():
        raise CaseError(
            f"poissons_ratio: {nu[bad].flat[0]:g} is not possible for a stable solid; "
            "give a value above -1 and at most 0.5"
        )
    return scalar_or_array(1.295 * _EXP(0.736 * nu))
