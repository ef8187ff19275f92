"""The height map of a rough surface: the output of readers and generators."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import read_only

Array = NDArray[np.float64]


@typed
@dataclass(frozen=True, eq=False)
class Surface:
    """Heights on a grid, and their provenance; compared and hashed by identity.

    Attributes:
        height: Heights (m), positive towards the other body, shape `grid.nodes`; read-only, copied
            if other code could still write to the array.
        grid: Grid of the heights.
        provenance: Texts and numbers (SI) on the origin of the heights; every result stores them.

    Raises:
        SurfaceError: The shape does not fit the grid, or a height is undefined.
    """

    height: NDArray[np.float64]
    grid: Grid
    provenance: Mapping[str, str | float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.height.shape != self.grid.nodes:
            raise SurfaceError(
                f"height: shape {self.height.shape} does not fit a grid of {self.grid.nodes} nodes"
            )
        undefined = self.height.size - np.count_nonzero(np.isfinite(self.height))
        if undefined:
            raise SurfaceError(
                f"height: {undefined} of {self.height.size} heights are undefined (NaN or "
                "infinite); fill or crop them first"
            )
        object.__setattr__(self, "height", read_only(self.height))
        object.__setattr__(self, "provenance", dict(self.provenance))

    def _summary(self) -> list[str]:
        source = self.provenance.get("kind") or self.provenance.get("source", "heights")
        z = self.height
        rms, low, high = (quantity(float(value), "m") for value in (z.std(), z.min(), z.max()))
        return [f"{source}, Sq {rms}", f"heights {low} to {high}", *self.grid._summary()]

    __repr__ = summary_text
    _repr_html_ = summary_html


def noted(provenance: Mapping[str, str | float], notice: str) -> dict[str, str | float]:
    """Add `notice` to those in `provenance`, which every result repeats as warnings."""
    before = provenance.get("notice")
    return {**provenance, "notice": f"{before}; {notice}" if before else notice}


def is_periodic(surface: Surface) -> bool:
    """Whether the provenance states that opposite edges of the surface match."""
    return str(surface.provenance.get("periodicity", "")).startswith("periodic")
