"""Drake: `point_contact_stiffness` and `hunt_crossley_dissipation` of a pair of geometries.

Drake's compliant point contact has the force F = kx (1 + d x′). Here x is the overlap, k the
stiffness and d the dissipation. F is never attractive (Drake documentation, Compliant point contact
and Hydroelastic contact: Hunt & Crossley). Two geometries a and b in contact have

    k = k_a k_b/(k_a + k_b),   d = (k_b d_a + k_a d_b)/(k_a + k_b).

So the export gives both geometries the values 2k and d to obtain a contact with k and d.

The coefficient of restitution e depends only on the product of d and the impact velocity, not on k
or the mass (`damping.hunt_crossley_dissipation`). e decreases with increasing velocity. k is chosen
such that the contact lasts as long as a Hertz contact. The relation between e and d holds for every
elastic force that is multiplied by (1 + d x′). So it also holds for a hydroelastic contact if all
points of its surfaces approach at the same velocity (not tested in Drake).

A geometry has only one k and one d. So in a scene with three types of bodies, the pairs of types
cannot all have their own k and d.

A plant (`MultibodyPlant`) is Drake's system of bodies. In Drake 1.51, a continuous plant
(`time_step=0`) reproduces the exported e. A discrete plant loses additional energy because of its
time step. With the contact approximation `sap`, a discrete plant ignores d. It then damps contacts
strongly for numerical reasons, so that e is close to 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.dem.damping import hunt_crossley_dissipation, hunt_crossley_restitution
from restitution.dem.export_common import Export
from restitution.dem.own_laws import OwnLaw
from restitution.dem.pair import ExportedPair
from restitution.dem.pair_table import PairTable

CODE = "Drake"
LOWEST = 0.05  # smallest e that is exported
FRAGMENT, COLLISION = "restitution_drake.py", "collision_drake.py"
NOTE = (
    "Drake: e holds in a continuous plant (time_step=0). A discrete plant lowers e, from 0.800 to "
    "0.793 with 500 time steps in a contact and to 0.766 with 100; its SAP approximation ignores "
    "the dissipation, so e is close to 0."
)
_ENDS = (
    "the overlap is back to zero; the force is never attractive. e holds in a continuous plant "
    "(time_step=0). A discrete plant (tamsi, similar, lagged) returns 0.793 instead of 0.8 with "
    "500 time steps in a contact, 0.766 with 100 and 0.653 with 20; sap ignores the dissipation, "
    "so e is close to 0."
)
_STEPPING = "In a discrete plant e = 0.8 becomes 0.793 with 1/500 of it, 0.766 with 1/100."
_STEPS = 200  # number of time steps in the contact of the test collision


def own_laws(pair: ExportedPair) -> list[OwnLaw]:
    """The law e(V) that Drake has for `pair`."""
    contact = HuntCrossleyContact(pair, _dissipation(pair))
    V = pair.law.column("velocity") / pair.velocity
    return [OwnLaw("Hunt and Crossley", np.array([contact.restitution(v) for v in V.tolist()]))]


def _dissipation(pair: ExportedPair) -> float:
    return hunt_crossley_dissipation(pair.restitution) / pair.velocity


@dataclass(frozen=True)
class HuntCrossleyContact:
    """The contact of a pair; `dissipation` is the coefficient d (s/m)."""

    pair: ExportedPair
    dissipation: float

    @property
    def stiffness(self) -> float:
        """The stiffness (N/m) of the contact."""
        return self.pair.law.mass * (math.pi / self.pair.contact_time) ** 2

    def restitution(self, share: float) -> float:
        """Drake's e at `share` times the velocity of the export."""
        return hunt_crossley_restitution(self.dissipation * self.pair.velocity * share)


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """A Python module with the contact parameters, and a test collision; names and texts."""
    export = Export(
        table,
        velocity,
        CODE,
        LOWEST,
        _ENDS,
        constant=False,
        steps=0,
        accuracy=_STEPPING,
        own=own_laws,
    )
    contacts = [HuntCrossleyContact(pair, _dissipation(pair)) for pair in export.pairs]
    return {
        FRAGMENT: export.render(
            FRAGMENT,
            contacts=contacts,
            friction_note=export.friction_note("#"),
        ),
        COLLISION: export.render(
            COLLISION,
            contacts=contacts,
            steps=_STEPS,
        ),
    } | export.notes()
