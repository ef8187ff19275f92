"""A uniform rectangular grid of cells. Arrays are `[i, j]` ↔ `[x, y]`, values at cell centres."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError


@dataclass(frozen=True)
class Grid:
    """Cells of `spacing` (hx, hy) in metres, `nodes` (nx, ny) of them.

    The origin is the centre of cell (nx // 2, ny // 2), so that the lowest point of a sphere on it
    is a node at any grid size, and grids of one spacing coincide whatever their sizes.

    Raises `CaseError` for a grid without nodes or with a spacing that is not a positive length.
    """

    nodes: tuple[int, int]
    spacing: tuple[float, float]

    def __post_init__(self) -> None:
        if min(self.nodes) < 1:
            raise CaseError(f"grid.nodes: {self.nodes} holds no cell; give at least 1 x 1 nodes")
        if not all(math.isfinite(h) and h > 0 for h in self.spacing):
            raise CaseError(f"grid.spacing: {self.spacing} m is not a positive length")

    @property
    def cell_area(self) -> float:
        """Area of one cell, m²."""
        return self.spacing[0] * self.spacing[1]

    @property
    def size(self) -> tuple[float, float]:
        """Edge lengths of the domain, nodes times spacing, m."""
        return self.nodes[0] * self.spacing[0], self.nodes[1] * self.spacing[1]

    @property
    def x(self) -> NDArray[np.float64]:
        """Cell centres along the first axis, shape (nx,), m; zero at nx // 2."""
        return _centres(self.nodes[0], self.spacing[0])

    @property
    def y(self) -> NDArray[np.float64]:
        """Cell centres along the second axis, shape (ny,), m; zero at ny // 2."""
        return _centres(self.nodes[1], self.spacing[1])


def _centres(n: int, h: float) -> NDArray[np.float64]:
    return np.asarray((np.arange(n) - n // 2) * h, dtype=np.float64)
