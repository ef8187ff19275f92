"""The bound that grows, on surfaces that remember at which pressure they have yielded before."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import separated_state
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.state import Array, State
from restitution.numerics.read_only import freeze

# A node that has yielded yields again at this multiple of the bound at which it did, because the
# residual stress of the first flow opposes the second (evidence/run_in: J2 in 3D).
AGAIN = 1.2


@dataclass(frozen=True)
class RememberedCavity(ExpandingCavity):
    """`ExpandingCavity` whose bound is at least 1.2 times that at which a node has yielded before.

    Attributes:
        borne: Bound (Pa) at which each node first yielded, 0 without, shape `grid.nodes`.
    """

    borne: Array | float = field(default=0.0, compare=False)

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        limit, convolutions = super().bound(contact, indentation, residual)
        return freeze(np.maximum(limit, AGAIN * self.borne)), convolutions

    def work(self, before: State | None, after: State) -> tuple[float, float]:
        contact = after.contact
        if before is None:
            bound = freeze(np.maximum(AGAIN * self.borne, contact.first_yield_pressure))
            before = replace(separated_state(contact, 0.0), bound=bound)
        return super().work(before, after)
