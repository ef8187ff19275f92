"""Wu, Li & Thornton (2003, 2005): fit to finite elements at large plastic deformation.

C.-Y. Wu, L.-Y. Li, C. Thornton, Int. J. Impact Engineering 28 (2003) 929–946 and 32 (2005) 593–604.
One elastic, perfectly plastic body against one that does not yield, no adhesion:

    e = c [(V/V_y)/(E*/Y)]^{−½},  c = 0.78: plastic sphere, rigid wall
                                  c = 0.62: elastic sphere, plastic half-space
    for  V/V_y ≥ 0.008 (E*/Y)²

V_y is `yielding.yield_velocity` at p_y = 1.6 Y, Y the yield strength of the one that yields.

All four numbers were written down from memory, not from the papers. What speaks for the square in
the threshold: a plastic contact of radius a has a/R* = 2.2 (V/V_y)^½ Y/E*, so only that form means
one finite deformation, a/R* = 0.2, whatever the materials; and there the formula meets `johnson`,
at 1.13 times its e. Linear in E*/Y it would begin at e = 8.7.

Below the threshold, where e follows V/V_y alone, the result is NaN; so it is where the formula
exceeds 1, as it does just above the threshold for soft, strong bodies (E*/Y < 76, or 48). Up to V_y
nothing yields and e = 1.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import numpy as np

from restitution.errors import CaseError

from ._inputs import Array, Values, positive, scalar_or_array, touching
from .yielding import yield_velocity

COEFFICIENTS = {"sphere": 0.78, "half-space": 0.62}
"""c by the body that yields."""
YIELD_COEFFICIENT = 1.6
"""p_y/Y."""
THRESHOLD = 0.008
"""(V/V_y)/(E*/Y)² from which on the deformation is finite and the formula holds."""


def restitution(
    velocity: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    mass: Values,
    plastic: str = "sphere",
) -> Array:
    """Coefficient of restitution e after an impact at relative normal `velocity` (m/s).

    `plastic` is the body that yields, "sphere" or "half-space". 1 up to V_y, NaN between V_y and
    the threshold of finite plastic deformation and where the formula exceeds 1.
    """
    if plastic not in COEFFICIENTS:
        raise CaseError(
            f"plastic: {plastic!r} is not a body that can yield; give one of "
            + ", ".join(COEFFICIENTS)
        )
    E_star, Y = positive(contact_modulus=contact_modulus, yield_strength=yield_strength)
    V_y = yield_velocity(radius, contact_modulus, YIELD_COEFFICIENT * Y, mass)
    v, s = touching(velocity) / V_y, E_star / Y
    e = COEFFICIENTS[plastic] * (s / np.maximum(v, 1.0)) ** 0.5
    outside = (v < THRESHOLD * s**2) | (e > 1)
    return scalar_or_array(np.where(v <= 1, 1.0, np.where(outside, np.nan, e)))
