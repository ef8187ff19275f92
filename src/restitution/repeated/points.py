"""Rows of tables of repeated impacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from restitution.collision import Collision
from restitution.contact.state import State
from restitution.curve.columns import Record, column, magnitude


@dataclass(frozen=True, kw_only=True)
class RepeatedImpact(Record):
    """One impact of a sequence, in SI units; its fields are the columns of `impacts.csv`."""

    number: float = magnitude("impact", "1", "number of the impact, from 1")
    coverage: float = magnitude(
        "coverage", "1", "area of the contacts of smooth bodies so far, over that of the surface"
    )
    velocity: float = magnitude("impact_velocity_m_per_s", "m s-1", "impact velocity")
    restitution: float = magnitude("restitution", "1", "coefficient of restitution", high=1.0)
    indentation: float = column("max_indentation_m", "m", "maximum indentation")
    force: float = column("force_N", "N", "normal force at maximum indentation")
    contact_area: float = magnitude("contact_area_m2", "m2", "real contact area")
    loading_work: float = column("loading_work_J", "J", "work of loading")
    unloading_work: float = column("unloading_work_J", "J", "work returned until separation")
    plastic_work: float = magnitude("plastic_work_J", "J", "work dissipated by yielding")
    adhesive_loss: float = column("adhesive_loss_J", "J", "energy dissipated by adhesion")
    plastic_volume: float = column(
        "plastic_volume_m3", "m3", "volume by which yielding has lowered the surfaces"
    )
    pull_off_force: float = column("pull_off_force_N", "N", "largest tension during unloading")
    restitution_error: float = magnitude(
        "restitution_error", "1", "error of COR due to the solver"
    )

    @classmethod
    def of(
        cls, number: int, coverage: float, velocity: float, state: State, collision: Collision
    ) -> Self:
        return cls(
            number=float(number),
            coverage=coverage,
            velocity=velocity,
            restitution=collision.restitution,
            indentation=state.indentation,
            force=state.force,
            contact_area=state.contact_area,
            loading_work=collision.loading_work,
            unloading_work=collision.unloading_work,
            plastic_work=state.plastic_work,
            adhesive_loss=collision.adhesive_loss,
            plastic_volume=state.plastic_volume,
            pull_off_force=collision.pull_off_force,
            restitution_error=collision.restitution_error,
        )
