"""Elastic spheres that stick: up to which velocity adhesion keeps them, what it takes beyond.

An elastic adhesive cycle loses the energy W_s of `jkr.hysteresis_loss` at any depth, so

    ½ m* V_s² = W_s:  V_s = (14.18/m*)^½ (w⁵R*⁴/E*²)^{1/6},   e² = 1 − (V_s/V)², 0 for V ≤ V_s

(C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162, who print 14.18; 2 × 7.092 = 14.184
exactly, used here). Whether the JKR theory under it applies, `tabor_parameter` says:

    μ = (R*w²/(E*²z₀³))^{1/3}

(D. Tabor, J. Colloid Interface Sci. 58 (1977) 2–13), the neck JKR draws out over the range z₀ of
the forces. μ > 5 is JKR, μ < 0.1 DMT or rigid (Johnson & Greenwood, J. Colloid Interface Sci. 192
(1997) 326–333); between, and in W_s more than in the pull-off force, the truth lies between. Small
hard particles have a small μ, and then stick less than V_s says.

Valid for quasi-static normal impacts in which nothing yields (V < `yielding.yield_velocity` and
V_s below it too) and for a large μ. V is the velocity before the forces act.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import numpy as np

from . import jkr
from ._inputs import Array, Values, positive, scalar_or_array, touching


def sticking_velocity(
    radius: Values, contact_modulus: Values, work_of_adhesion: Values, mass: Values
) -> Array:
    """Relative normal velocity V_s (m/s) of the fastest elastic impact that sticks."""
    (m,) = positive(mass=mass)
    return (2 * jkr.hysteresis_loss(radius, contact_modulus, work_of_adhesion) / m) ** 0.5


def restitution(velocity: Values, sticking_velocity: Values) -> Array:
    """Coefficient of restitution e = (1 − (V_s/V)²)^½ after an impact at `velocity` (m/s).

    For any V_s, computed or measured. 0 where the spheres stick, V ≤ V_s; 1 at and below zero
    velocity, where none approaches.
    """
    V = touching(velocity)
    (V_s,) = positive(sticking_velocity=sticking_velocity)
    q = V_s / np.maximum(V, V_s)
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, ((1 - q) * (1 + q)) ** 0.5))


def tabor_parameter(
    radius: Values,
    contact_modulus: Values,
    work_of_adhesion: Values,
    equilibrium_separation: Values,
) -> Array:
    """Tabor's μ; `equilibrium_separation` z₀ (m) is that of the surface forces, 0.15–0.4 nm."""
    R, E_star, w, z0 = positive(
        radius=radius,
        contact_modulus=contact_modulus,
        work_of_adhesion=work_of_adhesion,
        equilibrium_separation=equilibrium_separation,
    )
    return np.cbrt(R * (w / E_star) ** 2) / z0
