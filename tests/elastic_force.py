"""The stored force of smooth elastic spheres, for tests of collisions in time."""

import math

import numpy as np

from restitution import Body
from restitution.impacts.stored_force import StoredForce
from restitution.theory import Hertz

ALUMINA = Body(2.5e-3, 380e9, 0.23, 4000)
GLASS_WALL = Body(math.inf, 70e9, 0.22)


def elastic(pair, velocity):
    """The stored force of smooth elastic spheres, up to an impact velocity."""
    hertz = Hertz(pair.radius, pair.contact_modulus)
    deepest = 1.01 * float(hertz.indentation_from_energy(0.5 * pair.mass * velocity**2))
    depths, s = np.geomspace(deepest / 100, deepest, 20), np.linspace(0, 1, 1001)
    return StoredForce(
        pair,
        deepest,
        1.005 * velocity,
        lambda x: float(hertz.force(max(x, 0.0))),
        lambda x: 0.0,
        depths,
        tuple((depth * s, hertz.force(depth * s)) for depth in depths),
    )
