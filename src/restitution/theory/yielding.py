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

import numpy as np

from ._inputs import Array, Values, positive

_COEFFICIENT = math.sqrt(math.pi**5 / 30)  # 3.19385, of V_y in (p_y⁵R*³/(E*⁴m*))^½


def yield_indentation(radius: Values, contact_modulus: Values, yield_pressure: Values) -> Array:
    """Indentation δ_y (m) at which the peak pressure reaches `yield_pressure`."""
    R, E_star, p_y = positive(
        radius=radius, contact_modulus=contact_modulus, yield_pressure=yield_pressure
    )
    return (np.pi * p_y / (2 * E_star)) ** 2 * R


def yield_force(radius: Values, contact_modulus: Values, yield_pressure: Values) -> Array:
    """Normal force F_y (N) at which the peak pressure reaches `yield_pressure`."""
    R, E_star, p_y = positive(
        radius=radius, contact_modulus=contact_modulus, yield_pressure=yield_pressure
    )
    return np.pi**3 / 6 * (R / E_star) ** 2 * p_y**3


def yield_velocity(
    radius: Values, contact_modulus: Values, yield_pressure: Values, mass: Values
) -> Array:
    """Relative normal velocity V_y (m/s) of the fastest impact that stays elastic.

    ½ m* V_y² = W(δ_y) gives V_y = (π⁵/30)^½ (p_y⁵R*³/(E*⁴m*))^½, which Thornton & Ning (1998)
    print as 3.194 (p_y⁵R*³/(E*⁴m*))^½; the exact coefficient is used here.
    """
    R, E_star, p_y, m = positive(
        radius=radius, contact_modulus=contact_modulus, yield_pressure=yield_pressure, mass=mass
    )
    return _COEFFICIENT * (p_y / E_star) ** 2 * (p_y * R**3 / m) ** 0.5
