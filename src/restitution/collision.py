"""Restitution and impact velocity of a collision, from its works of loading and unloading.

The impact is quasi-static and normal, without waves, friction or rate effects.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

from restitution.arguments import typed
from restitution.contact.models import RESTITUTION_ERROR
from restitution.contact.path import unloading_path
from restitution.contact.state import State
from restitution.display import quantity, summary_html, summary_text

UnloadingMethod = Literal["path", "energy-estimate"]


@typed
@dataclass(frozen=True)
class Collision:
    """Works of loading and unloading of one collision, and quantities that follow from these works.

    Attributes:
        loading_work: Work of loading W_l (J).
        unloading_work: Work of unloading W_u (J).
        mass: Reduced mass m* (kg); None if a density is missing.
        separation_indentation: Indentation at which the bodies separate (m); NaN if it is not
            known.
        pull_off_force: Largest tensile force during unloading (N); NaN if it is not known.
        adhesive_loss: Energy dissipated by adhesion (J).
        loading_work_error: Error of the work of loading (J).
        unloading_work_error: Error of the work of unloading (J).
        convolutions: Number of convolutions computed for unloading.
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
        """Whether the bodies stick, because the work of unloading or loading is not positive."""
        return self.unloading_work <= 0 or self.loading_work <= 0

    @property
    def restitution(self) -> float:
        """Coefficient of restitution sqrt(W_u/W_l) (dimensionless); 0 if the bodies stick.

        W_u and W_l are the works of unloading and loading (Johnson 1985, §11.5).
        """
        return _restitution(self.unloading_work, self.loading_work)

    @property
    def restitution_error(self) -> float:
        """Error of the COR (dimensionless), from the independent errors of the two works."""
        here, W_u, W_l = self.restitution, self.unloading_work, self.loading_work
        dW_u, dW_l = self.unloading_work_error, self.loading_work_error
        by_unloading = (_restitution(W_u + dW_u, W_l), _restitution(W_u - dW_u, W_l))
        by_loading = (_restitution(W_u, W_l - dW_l), _restitution(W_u, W_l + dW_l))
        return math.hypot(
            *(max(abs(e - here) for e in pair) for pair in (by_unloading, by_loading))
        )

    @property
    def impact_velocity(self) -> float | None:
        """Impact velocity V (m/s) whose kinetic energy ½ m* V² is the work of loading.

        None if a density is missing, because the reduced mass m* is then unknown. Also None if the
        work of loading is negative. Adhesion then pulls the bodies to a larger depth than that of
        this collision, at any impact velocity.
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


@typed
def collide(
    state: State,
    unloading: Sequence[State] | None = None,
    *,
    method: UnloadingMethod = "path",
    tolerance: float = RESTITUTION_ERROR,
) -> Collision:
    """Compute the collision whose deepest point is `state`.

    Without adhesion, the work of unloading is the stored energy. With adhesion, `method="path"`
    simulates unloading, and `method="energy-estimate"` estimates its work as the elastic energy
    minus the energy of the attraction. The estimate neglects the energy dissipated at detachment,
    so its error is set to wA, the work of adhesion times the contact area.

    Args:
        state: Deepest state of the collision, reached by loading.
        unloading: States of unloading from `unloading_path`. By default they are computed here.
            Used only with adhesion and `method="path"`.
        method: Method for the work of unloading with adhesion.
        tolerance: Largest error of the coefficient of restitution (dimensionless) that the
            unloading steps may cause.

    Returns:
        Works of loading and unloading, and restitution.

    Raises:
        NotConvergedError: The bodies did not separate, or a solve did not converge.
    """
    contact = state.contact
    elastic = Collision(
        loading_work=state.loading_work,
        loading_work_error=state.work_error,
        unloading_work=state.stored_energy,
        mass=contact.pair.mass,
        separation_indentation=state.separation_indentation,
    )
    adhesion = contact.adhesion
    if adhesion is None or not adhesion.attracts:
        return elastic
    if method == "energy-estimate":
        owed = adhesion.attraction_energy(state)
        surface_energy = adhesion.work_of_adhesion * state.contact_area
        return replace(
            elastic,
            unloading_work=state.stored_energy - owed,
            unloading_work_error=surface_energy,
            adhesive_loss=owed,
            pull_off_force=math.nan,
            separation_indentation=math.nan,
        )
    path = list(unloading_path(state, tolerance=tolerance) if unloading is None else unloading)
    separation = adhesion.separation_of(path)
    return replace(
        elastic,
        unloading_work=separation.unloading_work,
        unloading_work_error=separation.error + adhesion.release_error() * state.contact_area,
        adhesive_loss=separation.adhesive_loss,
        pull_off_force=separation.pull_off_force,
        separation_indentation=separation.separation_indentation,
        convolutions=separation.convolutions,
    )


def _restitution(unloading_work: float, loading_work: float) -> float:
    if unloading_work <= 0 or loading_work <= 0:
        return 0.0
    # The ratio exceeds 1 only because of numerical errors, which restitution_error includes.
    return min(1.0, math.sqrt(unloading_work / loading_work))
