"""MuJoCo: `solimp` and `solref` of a contact pair; `solref` is (−stiffness, −damping).

During a contact, MuJoCo sets the normal acceleration to a₁ = (1 − d) a₀ + d a_ref. Here a₀ is the
acceleration without contact, d is the impedance, and a_ref = −bv − kr is the reference
acceleration. r is the distance of the surfaces, and v is its rate. The coefficients are
b = damping/d_max and k = stiffness d(r)/d_max², where d_max is the largest impedance (MuJoCo
documentation, Computation: Constraint model, and Modeling: Solver parameters). If the impedance d
is constant, the equation of motion is

    r″ = −stiffness r − damping r′ + (1 − d) a₀.

This is a linear spring and dashpot. Its stiffness and damping are per unit of mass, so the
coefficient of restitution e does not depend on the masses. The contact force is never attractive,
so `damping.dashpot_ratio` gives the damping ratio ζ for e. The usual formula
e = exp(−πζ/(1 − ζ²)^½) does not apply: with the ζ from this formula for e = 0.6, MuJoCo returns
0.632.

d = 0.9999, the largest value that MuJoCo accepts, makes e independent of the friction cone.
With d = 0.9 and pyramidal cones, MuJoCo returns 0.79 for e = 0.8. The stiffness is chosen such that
the contact lasts as long as a Hertz contact. e does not depend on the stiffness.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.damping import dashpot_ratio
from restitution.dem.export_common import Export
from restitution.dem.pair import ExportedPair
from restitution.dem.pair_table import PairTable

CODE = "MuJoCo"
LOWEST = 0.05  # smallest e that is reproduced within 2 %, with `_STEPS` time steps in a contact
FRAGMENT, COLLISION = "restitution_mujoco.xml", "collision_mujoco.py"
NOTE = (
    "MuJoCo: e is the exported e at every velocity, if the time step is at most 1/200 of the "
    "contact time (1/50 for e of 0.5 and more); the file lists softer contacts for longer time "
    "steps."
)
_ENDS = (
    "the force is back to zero, which is before the overlap is zero: contact forces are never "
    "attractive. The error of e is at most 2 % with 200 time steps in a contact if e is at least "
    "0.2, and with 50 time steps if e is at least 0.5."
)
_ACCURACY = (
    "Then e of 0.5 and more is within 1 %; 1/200 keeps e of 0.2 within 2 %. With 1/10, 0.5 becomes "
    "0.45."
)
_STEPS = 500  # number of time steps in the contact of the test collision
_LARGEST = 1e8  # largest acceleration (m/s²) in an export; MuJoCo resets a simulation above 1e10
_DEEPEST = 0.05  # largest overlap in a softened contact, as a fraction of the smaller radius
_COARSE = 50  # number of time steps in a softened contact


@dataclass(frozen=True)
class DashpotContact:
    """Durations (s) and damping ratio ζ of a contact between two bodies.

    `duration` is that of an elastic Hertz contact, or longer if the acceleration would exceed
    `_LARGEST`. `soft_duration` is that of a softened contact, for longer time steps: without
    damping, its largest overlap is the fraction `_DEEPEST` of the smaller radius.
    """

    pair: ExportedPair
    duration: float
    soft_duration: float
    ratio: float

    def solref(self, duration: float) -> tuple[float, float]:
        """`solref` in the direct format (1/s², 1/s) of a contact of this duration (s)."""
        frequency = math.pi / duration
        return -(frequency**2), -2 * self.ratio * frequency


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Contact parameters to include in an MJCF model, and a test collision; names and texts."""
    export = Export(table, velocity, CODE, LOWEST, _ENDS, steps=100, accuracy=_ACCURACY)
    contacts = [_contact(pair) for pair in export.pairs]
    return {
        FRAGMENT: export.render(
            FRAGMENT,
            "",
            contacts=contacts,
            share=_DEEPEST,
            coarse=_COARSE,
            friction_note=export.friction_note(),
        ),
        COLLISION: export.render(
            COLLISION,
            contacts=contacts,
            steps=_STEPS,
        ),
    } | export.notes()


def _contact(pair: ExportedPair) -> DashpotContact:
    duration = max(pair.contact_time, math.pi * pair.velocity / _LARGEST)
    radius = min(body.radius for body in (pair.first, pair.second) if body.radius is not None)
    soft = max(duration, math.pi * _DEEPEST * radius / pair.velocity)
    return DashpotContact(pair, duration, soft, dashpot_ratio(pair.restitution))
