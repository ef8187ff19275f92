"""Closed forms for impacts in which the whole contact slides from the beginning to the end.

The bodies meet without spin, at the angle θ from the normal, with the tangential velocity V_t and
the normal velocity V_n. e is the normal restitution, µ the coefficient of friction, E* the contact
modulus and G* the tangential modulus. The contact is modelled as a row of springs (`foundation`). A
spring that slides has the displacement µ (E*/G*)(δ − g), where δ is the indentation and g the
indentation at which this spring touches. The spring continues to slide as long as the velocity U of
the contact point exceeds the rate of this displacement:

    U > µ (E*/G*) dδ/dt.

With full slip, U minus this rate decreases during the whole contact. So the condition is strictest
at the end of contact, where dδ/dt = −e V_n and U = V_t − (7/2) µ (1 + e) V_n. There the condition
becomes

    tan θ ≥ µ [(7/2)(1 + e) − e E*/G*].

For e = 1 this is the condition ψ₁ ≥ 4χ − 1 of Maw, Barber and Fawcett (1976, Wear 38, 101–114).
Here ψ₁ = (G*/E*) tan θ/µ and χ = (7/4) G*/E*. The same derivation holds for e < 1, because springs
unload with the stiffness E*, whether or not the contact has yielded.
"""

from __future__ import annotations

import math


def full_slip_angle(friction: float, restitution: float, modulus_ratio: float) -> float:
    """The smallest angle of impact at which the whole contact slides, for bodies without spin.

    Args:
        friction: Coefficient of friction µ (dimensionless).
        restitution: Normal restitution e (dimensionless).
        modulus_ratio: Ratio G*/E* of tangential to contact modulus (dimensionless).

    Returns:
        The angle from the normal (rad).

    Source:
        Maw, Barber and Fawcett (1976) for e = 1. The top of this module derives it for e < 1.
    """
    least = 3.5 * (1 + restitution) - restitution / modulus_ratio
    # If ψ₁ = (G*/E*) tan θ/µ is below 1, the contact sticks at first (Maw, Barber and Fawcett). So
    # full slip also needs ψ₁ ≥ 1.
    return math.atan(friction * max(least, 1 / modulus_ratio))


def full_slip_restitution(friction: float, restitution: float, angle: float) -> float:
    """Tangential restitution of the particle centres with full slip: 1 − µ (1 + e)/tan θ.

    Args:
        friction: Coefficient of friction µ (dimensionless).
        restitution: Normal restitution e (dimensionless).
        angle: Angle of impact from the normal (rad), above 0.

    Returns:
        Ratio of the relative tangential velocities of the particle centres after and before the
        impact (dimensionless).

    Source:
        The impulse of a sliding contact: µ times the normal impulse, (1 + e) m* V_n.
    """
    return 1 - friction * (1 + restitution) / math.tan(angle)
