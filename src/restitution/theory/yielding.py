"""The end of the elastic range: where the peak of the Hertz pressure reaches `yield_pressure`.

`yield_pressure` p_y is a contact pressure, never the yield strength Y of a tensile test:
p_y ≈ 1.6 Y where a sphere first yields under its surface, and 2.8–3 Y, its hardness, where it
flows fully (Johnson 1985, sections 6.1 and 6.3). Setting p₀ = 2E*a/(πR*) = p_y with a² = R*δ gives

    δ_y = (πp_y/2E*)² R*,   F_y = π³R*²p_y³/(6E*²),   ½ m* V_y² = W(δ_y) = ⅖ F_y δ_y.

Exact within Hertz's theory, so valid where that is: δ_y ≪ R*, which p_y ≪ E* ensures. No adhesion.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.errors import CaseError

from ._inputs import Array, Values, keep_positive, positive, scalar_or_array

_COEFFICIENT = math.sqrt(math.pi**5 / 30)  # 3.19385, of V_y in (p_y⁵R*³/(E*⁴m*))^½
_EXP = np.vectorize(math.exp, otypes=[np.float64])  # the same on every processor, unlike np.exp


@dataclass(frozen=True, eq=False)
class FirstYield:
    """Where Hertz's pressure reaches `yield_pressure` p_y (Pa).

    `radius` is R* (m), `contact_modulus` E* (Pa).
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "yield_pressure")

    @property
    def indentation(self) -> Array:
        """Indentation δ_y (m) at which the peak pressure reaches `yield_pressure`."""
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        return scalar_or_array((np.pi * p_y / (2 * E_star)) ** 2 * R)

    @property
    def force(self) -> Array:
        """Normal force F_y (N) at which the peak pressure reaches `yield_pressure`."""
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        return scalar_or_array(np.pi**3 / 6 * (R / E_star) ** 2 * p_y**3)

    def velocity(self, mass: Values) -> Array:
        """Relative normal velocity V_y (m/s) of the fastest impact that stays elastic.

        ½ m* V_y² = W(δ_y) gives V_y = (π⁵/30)^½ (p_y⁵R*³/(E*⁴m*))^½, which Thornton & Ning (1998)
        print as 3.194 (p_y⁵R*³/(E*⁴m*))^½; the exact coefficient is used here.
        """
        R, E_star, p_y = self.radius, self.contact_modulus, self.yield_pressure
        (m,) = positive(mass=mass)
        return _COEFFICIENT * (p_y / E_star) ** 2 * (p_y * R**3 / m) ** 0.5


def yield_coefficient(poissons_ratio: Values) -> Array:
    """C = 1.295 exp(0.736 ν), the peak Hertz pressure at first yield over the yield strength.

    R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354: a fit, within ½ % for 0 ≤ ν ≤ ½, to
    the largest von Mises stress under a Hertz contact; 1.61 at ν = 0.3. Raises `CaseError` for a
    ratio that is not above −1 and at most ½.
    """
    nu = np.asarray(poissons_ratio, dtype=np.float64)
    bad = ~((nu > -1) & (nu <= 0.5))
    if bad.any():
        raise CaseError(
            f"poissons_ratio: {nu[bad].flat[0]:g} is not that of a stable solid; "
            "give one above -1 and at most 0.5"
        )
    return scalar_or_array(1.295 * _EXP(0.736 * nu))
