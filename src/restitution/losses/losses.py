"""All losses of one pair besides yielding and adhesion."""

from __future__ import annotations

from dataclasses import dataclass, replace

from restitution.losses.half_space import HalfSpace
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Viscosity

NAMES = ("plate", "waves", "viscosity")
"""The losses, as fields of `Losses`."""


@dataclass(frozen=True)
class Damping:
    """Coefficients of an impact: mobility α (m/(N s)), γ (s/(kg/s)) and dissipation time A (s)."""

    mobility: float = 0.0
    radiation: float = 0.0
    time: float = 0.0


@dataclass(frozen=True)
class Losses:
    """The losses of a pair; None where the pair has none."""

    plate: Plate | None = None
    waves: HalfSpace | None = None
    viscosity: Viscosity | None = None

    @property
    def present(self) -> tuple[str, ...]:
        """Names of the losses of this pair."""
        return tuple(name for name in NAMES if getattr(self, name) is not None)

    def only(self, name: str) -> Losses:
        """The loss `name` alone."""
        return replace(self, **{other: None for other in NAMES if other != name})

    def damping(self, duration: float) -> Damping:
        """The coefficients of an impact of `duration` (s) without these losses."""
        time = 0.0
        if self.viscosity is not None:
            time = self.viscosity.relaxation_time + self.viscosity.share_of_duration * duration
        return Damping(
            mobility=0.0 if self.plate is None else self.plate.mobility,
            radiation=0.0 if self.waves is None else self.waves.radiation,
            time=time,
        )
