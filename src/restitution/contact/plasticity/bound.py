"""Bodies that do not yield, or yield at a constant pressure."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from restitution.arguments import typed
from restitution.contact.models import Plasticity, set_field
from restitution.display import quantity

if TYPE_CHECKING:
    from restitution.contact.contact import Contact

# Largest relative difference of COR from finite elements (docs/validation.md), at the values of the
# COR due to plasticity alone.
_RESTITUTION = (0.34, 0.5, 0.56, 0.68, 0.77, 0.86, 0.9999, 1.0)
_DIFFERENCE = (0.1, 0.095, 0.06, 0.06, 0.09, 0.115, 0.115, 0.07)


@typed
@dataclass(frozen=True)
class Elastic(Plasticity):
    """Bodies that do not yield."""

    label = "none"
    bytes_per_node = 115.0

    @property
    def hardness(self) -> float:
        """inf (Pa)."""
        return math.inf

    def describe(self) -> str:
        return "elastic"


@typed
@dataclass(frozen=True)
class ConstantBound(Plasticity):
    """The pressure is at most the yield pressure, and in equilibrium with the deformed surface.

    Attributes:
        yield_pressure: Pressure (Pa) at which the surface yields: a hardness, about 2.8 times the
            yield strength; inf for elastic bodies.

    Raises:
        CaseError: The yield pressure is not positive.
    """

    yield_pressure: float

    label = "equilibrium"
    bytes_per_node = 140.0
    strengths = ("yield_pressure",)

    def __post_init__(self) -> None:
        set_field(self, "yield_pressure", "Pa", finite=False)

    @property
    def hardness(self) -> float:
        """Yield pressure (Pa)."""
        return self.yield_pressure

    def describe(self) -> str:
        if math.isinf(self.yield_pressure):
            return "elastic"
        return f"yield pressure {quantity(self.yield_pressure, 'Pa')} ({self.label})"

    def difference(self, contact: Contact, restitution: float) -> float:
        return float(np.interp(restitution, _RESTITUTION, _DIFFERENCE))
