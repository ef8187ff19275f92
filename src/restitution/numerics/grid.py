"""A uniform rectangular grid of cells. Arrays are `[i, j]` ↔ `[x, y]`, values at cell centres."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError, shown


@dataclass(frozen=True, init=False)
class Grid:
    """Cells of `spacing` (hx, hy) in metres, `nodes` (nx, ny) of them; a number is for both axes.

    The origin is the centre of cell (nx // 2, ny // 2), so that the lowest point of a sphere on it
    is a node at any grid size, and grids of one spacing coincide whatever their sizes.

    Raises `CaseError` for nodes that are not whole numbers from 1, and for a spacing that is not a
    positive length.
    """

    nodes: tuple[int, int]
    spacing: tuple[float, float]

    def __init__(self, nodes: int | tuple[int, int], spacing: float | tuple[float, float]) -> None:
        nx, ny = _both("nodes", nodes, "a whole number, or two (nx, ny)")
        if not all(isinstance(n, Integral) or n == math.floor(n) for n in (nx, ny)):
            raise CaseError(f"grid.nodes: {nodes!r} are not whole numbers")
        if min(nx, ny) < 1:
            raise CaseError(f"grid.nodes: {(nx, ny)} holds no cell; give at least 1 x 1 nodes")
        hx, hy = _both("spacing", spacing, "a length in m, or two (hx, hy)")
        if not all(math.isfinite(h) and h > 0 for h in (hx, hy)):
            raise CaseError(f"grid.spacing: {(hx, hy)} m is not a positive length")
        object.__setattr__(self, "nodes", (int(nx), int(ny)))
        object.__setattr__(self, "spacing", (float(hx), float(hy)))

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

    def _summary(self) -> list[str]:
        spacing, size = (_sides(edges) for edges in (self.spacing, self.size))
        return [f"{self.nodes[0]} × {self.nodes[1]} nodes of {spacing}, {size}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def _sides(edges: tuple[float, float]) -> str:
    return " × ".join(quantity(edge, "m") for edge in edges)


def _both(name: str, value: Any, wanted: str) -> tuple[Any, Any]:
    """`value` for both axes, if it is one number. Raises `CaseError` naming the argument."""
    along = (value, value) if isinstance(value, Real) else value
    try:
        first, second = along
    except (TypeError, ValueError):
        first = second = None
    if not all(isinstance(one, Real) and not isinstance(one, bool) for one in (first, second)):
        raise CaseError(f"grid.{name}: {shown(value)} is not {wanted}")
    return first, second


def _centres(n: int, h: float) -> NDArray[np.float64]:
    return np.asarray((np.arange(n) - n // 2) * h, dtype=np.float64)
