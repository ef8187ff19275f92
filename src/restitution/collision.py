"""From energies to a collision: restitution, impact velocity, sticking.

Quasi-static normal impact: no waves, no friction, no rate effects. The contact ends at separation,
where the force is back to zero, after pull-off where there is adhesion. Without adhesion unloading
is elastic and reversible, so it returns the stored energy; with adhesion it is followed step by
step, or estimated.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from restitution.contact.separation import RESTITUTION_ERROR, separate, separation_of
from restitution.contact.state import State
from restitution.display import quantity, summary_html, summary_text

UnloadingMethod = Literal["path", "energy-estimate"]
# Error of the grid in letting go, as a share of w times the area; steps do not show it. Crack
# closure releases at 0.985 to 0.99 of w, the tension limit at 1.0 (kink) to 1.8 w (straight edge).
_RELEASE_ERROR = {"crack-closure": 0.015, "pohrt-popov": 0.4}


@dataclass(frozen=True)
class Collision:
    """What one collision takes and returns.

    Works of loading and unloading (J) with their errors, the reduced mass m* (kg; None when a
    density is not given), the energy that adhesion has dissipated (J), the largest tension on the
    way back (N) and the indentation at which the bodies part (m).
    """

    loading_work: float
    unloading_work: float
    mass: float | None
    separation_indentation: float = math.nan
    pull_off_force: float = 0.0
    adhesive_loss: float = 0.0
    loading_work_error: float = 0.0
    unloading_work_error: float = 0.0
    convolutions: int = 0

    @property
    def sticks(self) -> bool:
        """Whether nothing is returned: the pair does not come apart by itself."""
        return self.unloading_work <= 0 or self.loading_work <= 0

    @property
    def restitution(self) -> float:
        """Coefficient of restitution sqrt(W_u/W_l) (Johnson 1985, §11.5); 0 when it sticks."""
        return _restitution(self.unloading_work, self.loading_work)

    @property
    def restitution_error(self) -> float:
        """How far the errors of the two works, which are independent, may move the restitution."""
        here, W_u, W_l = self.restitution, self.unloading_work, self.loading_work
        dW_u, dW_l = self.unloading_work_error, self.loading_work_error
        by_unloading = (_restitution(W_u + dW_u, W_l), _restitution(W_u - dW_u, W_l))
        by_loading = (_restitution(W_u, W_l - dW_l), _restitution(W_u, W_l + dW_l))
        return math.hypot(
            *(max(abs(e - here) for e in pair) for pair in (by_unloading, by_loading))
        )

    @property
    def impact_velocity(self) -> float | None:
        """Approach velocity V with ½ m* V² = W_l, m/s.

        None when a density is not given, and where adhesion has done more work than the approach:
        every impact goes deeper.
        """
        if self.mass is None or self.loading_work < 0:
            return None
        return math.sqrt(2 * self.loading_work / self.mass)

    def _summary(self) -> list[str]:
        velocity = self.impact_velocity
        at = "" if velocity is None else f" at {quantity(velocity, 'm/s')}"
        cor = "sticks, COR 0" if self.sticks else f"COR {self.restitution:.4f}"
        error = f" ± {self.restitution_error:.1g}" if self.restitution_error else ""
        lines = [
            f"{cor}{error}{at}",
            f"work of loading {quantity(self.loading_work, 'J')}, "
            f"of unloading {quantity(self.unloading_work, 'J')}",
        ]
        if self.pull_off_force:
            lines.append(f"pull-off force {quantity(self.pull_off_force, 'N')}")
        return lines

    __repr__ = summary_text
    _repr_html_ = summary_html


def collide(
    state: State,
    unloading: Sequence[State] | None = None,
    *,
    method: UnloadingMethod = "path",
    tolerance: float = RESTITUTION_ERROR,
) -> Collision:
    """The collision whose deepest point is `state`, a state of loading.

    With adhesion its unloading is `unloading` (from `separate`), or is followed here to an error of
    restitution of `tolerance`; `method="energy-estimate"` takes W_u = E_el − wA instead, with no
    pull-off force (NaN), and wA again as its error: what snapping off dissipates, and the grid's
    share in letting go, stayed below that in every case compared. Raises as `separate`.
    """
    contact = state.contact
    elastic = Collision(
        loading_work=state.loading_work,
        loading_work_error=state.work_error,
        unloading_work=state.stored_energy,
        mass=contact.pair.mass,
        separation_indentation=state.separation_indentation,
    )
    if not contact.adhesive:
        return elastic
    if method == "energy-estimate":
        surface_energy = contact.work_of_adhesion * state.contact_area
        return replace(
            elastic,
            unloading_work=state.stored_energy - surface_energy,
            unloading_work_error=surface_energy,
            adhesive_loss=surface_energy,
            pull_off_force=math.nan,
            separation_indentation=math.nan,
        )
    path = list(separate(state, tolerance=tolerance) if unloading is None else unloading)
    separation = separation_of(path)
    release_error = _RELEASE_ERROR[contact.detachment] * contact.work_of_adhesion
    return replace(
        elastic,
        unloading_work=separation.unloading_work,
        unloading_work_error=separation.error + release_error * state.contact_area,
        adhesive_loss=separation.adhesive_loss,
        pull_off_force=separation.pull_off_force,
        separation_indentation=separation.separation_indentation,
        convolutions=separation.convolutions,
    )


def _restitution(unloading_work: float, loading_work: float) -> float:
    if unloading_work <= 0 or loading_work <= 0:
        return 0.0
    # What is returned cannot exceed what was given; numerical error may, by restitution_error.
    return min(1.0, math.sqrt(unloading_work / loading_work))
