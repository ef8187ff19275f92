"""Rebound of alumina spheres from glass, computed and measured by Kharaz, Gorham and Salman (2001).

Prints the tables of docs/oblique.md. The spheres have a diameter of 5 mm and hit the glass at
3.9 m/s; nothing is fitted. The measured values are those of Powder Technol. 120, 281–291, digitised
by the examples of the code Lethe.
"""

from __future__ import annotations

import math

import numpy as np

from restitution import Body, Pair
from restitution.impacts.oblique import ObliqueCollision, collide_obliquely
from restitution.impacts.stored_force import StoredForce
from restitution.theory import Hertz

VELOCITY, FRICTION = 3.9, 0.092
PAIR = Pair(Body(2.5e-3, 380e9, 0.23, 4000), Body(math.inf, 70e9, 0.22))
# Angle of impact (degrees) and the measured value.
TANGENTIAL = {1.84: 0.79344, 3.703: 0.74533, 9.496: 0.67257, 20.012: 0.59691, 30.127: 0.68756,
              39.382: 0.77148, 49.694: 0.84761, 60.02: 0.90142}  # fmt: skip
SPIN = {6.143: 136.18, 10.991: 265.69, 21.251: 577.65, 31.157: 612.88, 39.143: 595.49,
        50.348: 453.21, 60.328: 382.09}  # fmt: skip
REBOUND = {2.15: 1.733, 4.096: 2.962, 9.826: 6.518, 20.567: 12.208, 30.29: 21.67, 39.535: 32.613,
           49.747: 45.125, 60.208: 57.474}  # fmt: skip


def elastic() -> StoredForce:
    """Hertz's force of the pair, loading and unloading."""
    hertz = Hertz(PAIR.radius, PAIR.contact_modulus)
    work = 0.5 * (PAIR.mass or math.nan) * VELOCITY**2
    deepest = 1.01 * float(hertz.indentation_from_energy(work))
    depths, s = np.geomspace(deepest / 20, deepest, 10), np.linspace(0, 1, 1001)
    return StoredForce(
        PAIR,
        deepest,
        1.005 * VELOCITY,
        lambda x: float(hertz.force(max(x, 0.0))),
        lambda x: 0.0,
        depths,
        tuple((depth * s, hertz.force(depth * s)) for depth in depths),
    )


def main() -> None:
    """Print the tables."""
    law = elastic()

    def at(degrees: float) -> ObliqueCollision:
        return collide_obliquely(law, VELOCITY, math.radians(degrees), FRICTION)

    for title, measured, value in (
        ("e_t", TANGENTIAL, lambda found: found.tangential_restitution),
        ("spin (rad/s)", SPIN, lambda found: found.spins[0]),
        ("rebound angle (°)", REBOUND, lambda found: math.degrees(found.rebound_angle)),
    ):
        print(f"\n| angle (°) | {title}, measured | computed | difference |\n|---|---|---|---|")
        for degrees, number in measured.items():
            found = value(at(degrees))
            print(f"| {degrees:.4g} | {number:.4g} | {found:.4g} | {found / number - 1:+.1%} |")
    # The impulse that lowers the tangential velocity turns the sphere: R ω = 5/2 V sin θ (1 − e_t).
    print("\n| angle (°) | spin (rad/s), measured | from the measured e_t | difference |")
    print("|---|---|---|---|")
    angles, values = (list(each) for each in (TANGENTIAL, TANGENTIAL.values()))
    for degrees, number in SPIN.items():
        e_t = np.interp(degrees, angles, values)
        turned = 2.5 * VELOCITY * math.sin(math.radians(degrees)) * (1 - e_t) / PAIR.first.radius
        print(f"| {degrees:.4g} | {number:.4g} | {turned:.4g} | {number / turned - 1:+.1%} |")


if __name__ == "__main__":
    main()
