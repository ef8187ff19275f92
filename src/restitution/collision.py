"""From energies to a collision: restitution and impact velocity.

Quasi-static normal impact: no waves, no friction, no rate effects. The contact ends at separation,
where the force is back to zero; unloading without adhesion is elastic and reversible, so it returns
the stored energy.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.contact.state import State


@dataclass(frozen=True)
class Collision:
    """Works of loading and unloading (J) of one collision, and the reduced mass m* (kg)."""

    loading_work: float
    unloading_work: float
    mass: float | None

    @property
    def restitution(self) -> float:
        """Coefficient of restitution sqrt(W_u/W_l) (Johnson 1985, *Contact Mechanics*, §11.5)."""
        return math.sqrt(self.unloading_work / self.loading_work)

    @property
    def impact_velocity(self) -> float | None:
        """Approach velocity V with ½ m* V² = W_l, m/s; None when a density is not given."""
        return None if self.mass is None else math.sqrt(2 * self.loading_work / self.mass)


def collide(state: State) -> Collision:
    """The collision whose deepest point is `state`, a state of loading."""
    return Collision(state.loading_work, state.stored_energy, state.contact.pair.mass)
