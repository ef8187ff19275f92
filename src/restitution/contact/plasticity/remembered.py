"""Bounds that change, on surfaces that remember at which pressure they have yielded before."""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import separated_state
from restitution.contact.models import Plasticity
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.plasticity.increments import ChangingBound
from restitution.contact.plasticity.size_effect import SizedBound
from restitution.contact.state import Array, State
from restitution.numerics.read_only import freeze


@dataclass(frozen=True)
class _Remembering(ChangingBound):
    """A bound that is at least that at which a node has yielded before.

    So do repeated impacts with J2 plasticity in 3D (evidence/run_in/against_j2.csv).

    Attributes:
        borne: Largest bound (Pa) at which each node has yielded, 0 without, shape `grid.nodes`.
    """

    borne: Array | float = field(default=0.0, compare=False, kw_only=True)

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        limit, convolutions = super().bound(contact, indentation, residual)
        return freeze(np.maximum(limit, self.borne)), convolutions

    def work(self, before: State | None, after: State) -> tuple[float, float]:
        contact = after.contact
        if before is None:
            bound = freeze(np.maximum(self.borne, self.begun(after)))
            before = replace(separated_state(contact, 0.0), bound=bound)
        return super().work(before, after)


@dataclass(frozen=True)
class RememberedCavity(_Remembering, ExpandingCavity):
    """`ExpandingCavity` of surfaces that have yielded before."""


@dataclass(frozen=True)
class RememberedBound(_Remembering, SizedBound):
    """`SizedBound` of surfaces that have yielded before."""


def remembering(model: Plasticity, borne: Array) -> Plasticity:
    """`model`, on nodes that have yielded at the bounds `borne` (Pa) before."""
    kind = RememberedCavity if isinstance(model, ExpandingCavity) else RememberedBound
    known = {one.name: getattr(model, one.name) for one in fields(model)}  # type: ignore[arg-type]
    return kind(**known, borne=borne)
