"""The bound that grows, on surfaces that remember at which pressure they have yielded before."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import separated_state
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.state import Array, State
from restitution.numerics.read_only import freeze


@dataclass(frozen=True)
class RememberedCavity(ExpandingCavity):
    """`ExpandingCavity` whose bound is at least that at which a node has yielded before.

    So do repeated impacts with J2 plasticity in 3D (evidence/run_in/against_j2.csv).

    Attributes:
        borne: Largest bound (Pa) at which each node has yielded, 0 without, shape `grid.nodes`.
    """

    borne: Array | float = field(default=0.0, compare=False)

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        limit, convolutions = super().bound(contact, indentation, residual)
        return freeze(np.maximum(limit, self.borne)), convolutions

    def work(self, before: State | None, after: State) -> tuple[float, float]:
        contact = after.contact
        if before is None:
            bound = freeze(np.maximum(self.borne, contact.first_yield_pressure))
            before = replace(separated_state(contact, 0.0), bound=bound)
        return super().work(before, after)
