"""Jackson, Green & Marghitu (2010): fit to impacts of the Jackson–Green elastic-plastic sphere.

R. L. Jackson, I. Green, D. B. Marghitu, Nonlinear Dynamics 60 (2010) 217–229,
doi 10.1007/s11071-009-9591-z. Their impacts load along `jackson_green.loading_force` and unload as
Hertz from a residual depth found by finite elements. With V* = V/V_c, where V_c first yields:

    ½ m* V_c² = ⅖ P_cω_c,  V_c = (4ω_cP_c/5m*)^½
    V* ≤ 1             e = 1
    1 < V* ≤ 60        e = 1 − 0.1 ln V* [(V* − 1)/59]^{0.156}
    60 < V* ≤ 1000     e = 1 − 0.1 ln 60 − 0.11 ln(V*/60) (V* − 60)^{2.36 Y/E*}

The coefficients were written down from memory, not from the paper, and then checked: the works of
`jackson_green.loading_force` and of a Hertz unloading to the residual depth of Jackson, Chusoipin &
Green (J. Tribology 127 (2005) 484–493), ω_res = 1.02 {1 − [(ω* + 5.9)/6.9]^{−0.54}} ω, give e
within 0.02 of the fit at ν = 0.32, for Y/E* from 0.001 to 0.007 and V* up to 1000.

Above V* = 1000 there is no fit, and the result is NaN; so it is where a Y/E* far beyond the fit's
(0.001 to 0.007) makes the last branch negative. Steel-like materials against a rigid frictionless
flat, no hardening, no adhesion; V_c depends on the Poisson ratio through C.
Units, shapes and errors are those of `restitution.theory`; a Poisson ratio that is not above −1 and
at most ½ raises `CaseError` too.
"""

from __future__ import annotations

import math

import numpy as np

from . import jackson_green
from ._inputs import Array, Values, positive, scalar_or_array, touching

TRANSITION = 60.0
"""V* at which the branches join."""
LIMIT = 1000.0
"""V* up to which there is a fit."""


def critical_velocity(
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
    mass: Values,
) -> Array:
    """Relative normal velocity V_c (m/s) of the fastest impact that stays elastic.

    `yielding.yield_velocity` at the pressure CY of `jackson_green.yield_coefficient`.
    """
    (m,) = positive(mass=mass)
    material = radius, contact_modulus, yield_strength, poisson_ratio
    w_c, P_c = (
        jackson_green.critical_indentation(*material),
        jackson_green.critical_force(*material),
    )
    return (0.8 * w_c * P_c / m) ** 0.5


def restitution(
    velocity: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e after an impact at relative normal `velocity` (m/s).

    1 up to V_c, NaN above 1000 V_c and where the fit would be negative.
    """
    E_star, Y = positive(contact_modulus=contact_modulus, yield_strength=yield_strength)
    V_c = critical_velocity(radius, contact_modulus, yield_strength, poisson_ratio, mass)
    v = touching(velocity) / V_c
    slow = np.clip(v, 1.0, TRANSITION)
    first = 1 - 0.1 * np.log(slow) * ((slow - 1) / (TRANSITION - 1)) ** 0.156
    fast = np.maximum(v, TRANSITION)
    second = 0.11 * np.log(fast / TRANSITION) * (fast - TRANSITION) ** (2.36 * Y / E_star)
    e = np.where(v <= TRANSITION, first, 1 - 0.1 * math.log(TRANSITION) - second)
    return scalar_or_array(np.where((v > LIMIT) | (e < 0), np.nan, e))
