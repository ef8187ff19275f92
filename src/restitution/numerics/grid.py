"""Uniform rectangular grid; arrays are indexed `[i, j]` along x and y, values at cell centres."""

from __future__ import annotations

import math
from dataclasses import dataclass
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError, shown


@typed
@dataclass(frozen=True, init=False)
class Grid:
    """Uniform rectangular grid of cells.

    The origin is the centre of cell (nx // 2, ny // 2), so the nodes of grids with equal spacing
    coincide.

    Args:
        nodes: Number of nodes (nx, ny), or one number for both axes.
        spacing: Cell size (hx, hy) (m), or one number for both axes.

    Attributes:
        nodes: Number of nodes (nx, ny).
        spacing: Cell size (hx, hy) (m).

    Raises:
        CaseError: The numbers of nodes are not positive integers, or a spacing is not a positive
            length.
    """

    nodes: tuple[int, int]
    spacing: tuple[float, float]

    def __init__(self, nodes: int | tuple[int, int], spacing: float | tuple[float, float]) -> None:
        nx, ny = _both("nodes", nodes, "a whole number, or two (nx, ny)")
        if not all(isinstance(n, Integral) or n == math.floor(n) for n in (nx, ny)):
            raise CaseError(f"nodes: {nodes!r} is not possible; give whole numbers of nodes")
        if min(nx, ny) < 1:
            raise CaseError(f"nodes: {(nx, ny)} is too small; give at least 1 x 1 nodes")
        hx, hy = _both("spacing", spacing, "a length in m, or two (hx, hy)")
        if not all(math.isfinite(h) and h > 0 for h in (hx, hy)):
            raise CaseError(f"spacing: {(hx, hy)} m is not a positive length")
        object.__setattr__(self, "nodes", (int(nx), int(ny)))
        object.__setattr__(self, "spacing", (float(hx), float(hy)))

    @property
    def cell_area(self) -> float:
        """Area of one cell (m²)."""
        return self.spacing[0] * self.spacing[1]

    @property
    def size(self) -> tuple[float, float]:
        """Edge lengths of the domain (m), number of nodes times spacing."""
        return self.nodes[0] * self.spacing[0], self.nodes[1] * self.spacing[1]

    @property
    def x(self) -> NDArray[np.float64]:
        """Cell centres along the first axis (m), shape (nx,); zero at index nx // 2."""
        return _centres(self.nodes[0], self.spacing[0])

    @property
    def y(self) -> NDArray[np.float64]:
        """Cell centres along the second axis (m), shape (ny,); zero at index ny // 2."""
        return _centres(self.nodes[1], self.spacing[1])

    def _summary(self) -> list[str]:
        spacing, size = (_sides(edges) for edges in (self.spacing, self.size))
        return [f"{self.nodes[0]} × {self.nodes[1]} nodes of {spacing}, {size}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def _sides(edges: tuple[float, float]) -> str:
    return " × ".join(quantity(edge, "m") for edge in edges)


def _both(name: str, value: Any, wanted: str) -> tuple[Any, Any]:
    """The two items of `value`, or one number twice; else `CaseError` that asks for `wanted`."""
    along = (value, value) if isinstance(value, Real) else value
    try:
        first, second = along
    except (TypeError, ValueError):
        first = second = None
    if not all(isinstance(edge, Real) and not isinstance(edge, bool) for edge in (first, second)):
        raise CaseError(f"{name}: give {wanted}, not {shown(value)}")
    return first, second


def _centres(n: int, h: float) -> NDArray[np.float64]:
    return np.asarray((np.arange(n) - n // 2) * h, dtype=np.float64)
