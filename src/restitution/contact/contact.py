"""The contact before it is loaded: bodies, surface and yield, and the gap between them.

Conventions: gap > 0 open, pressure > 0 compressive, indentation (approach of the bodies) > 0
closing and zero at the first touch of the undeformed bodies. Arrays `[i, j]` ↔ `[x, y]` at cell
centres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from restitution.contact.bodies import Pair
from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface

Plasticity = Literal["equilibrium", "truncated"]


@dataclass(frozen=True)
class Contact:
    """A pair of bodies whose composite roughness is `surface`.

    `yield_pressure` (Pa) is the largest pressure the surface carries: a hardness, about 2.8 times
    the yield strength; inf for elastic bodies. `plasticity` is `equilibrium` (pressure and surface
    in equilibrium under that bound) or `truncated` (the elastic pressure cut at the bound, as in
    Thornton and Ning 1998). Raises `CaseError` for other values.
    """

    pair: Pair
    surface: Surface
    yield_pressure: float = math.inf
    plasticity: Plasticity = "equilibrium"

    def __post_init__(self) -> None:
        if not self.yield_pressure > 0:
            raise CaseError(f"yield_pressure: {self.yield_pressure} Pa is not positive")
        if self.plasticity not in ("equilibrium", "truncated"):
            raise CaseError(f'plasticity: "{self.plasticity}" is not "equilibrium" or "truncated"')

    @property
    def grid(self) -> Grid:
        """The grid of the surface, on which everything is solved."""
        return self.surface.grid

    @cached_property
    def gap(self) -> NDArray[np.float64]:
        """Initial gap h₀ = (x² + y²)/(2R*) − z, shifted to min h₀ = 0; shape `grid.nodes`, m."""
        x, y = self.grid.x[:, None], self.grid.y[None, :]
        gap: NDArray[np.float64] = (x * x + y * y) / (2 * self.pair.radius) - self.surface.height
        gap -= gap.min()
        return gap


def smooth(grid: Grid) -> Surface:
    """The surface without roughness on `grid`."""
    return Surface(np.zeros(grid.nodes), grid, {"kind": "smooth"})
