"""How much memory a case takes, before it is made.

Measured as the largest resident size of whole processes on grids of 512² to 2048² nodes, with
contact over up to 90 % of them, and rounded up: the estimate is above what is taken, by
a factor of up to 1.5.
"""

from __future__ import annotations

import math

from restitution.numerics import memory
from restitution.numerics.grid import Grid

_PROCESS = 250e6  # the program with its libraries, and figures
_SURFACE = 75.0  # bytes per node: a generated surface
_SKEWED = 115.0  # with adjusted heights
_MARGIN = 60.0  # per node of the enlarged grid that a surface without periodicity is cut out of
_ENLARGED = 4.0  # that grid over the grid, at most
_SCAN = 60.0  # per pixel of a scan: read, levelled, its spectrum
_TWIN = 75.0  # per node
_BAND = 90.0  # per node of the finest band of a twin that is adjusted
_DESCRIBED = 150.0  # autocorrelation, spectrum and page of `restitution surface`
_MODELS = {"none": 115.0, "equilibrium": 140.0, "expanding-cavity": 190.0, "truncated": 190.0}
_ADHESIVE = 150.0


def nodes_of(grid: Grid) -> int:
    """Nodes of `grid` in all."""
    return math.prod(grid.nodes)


def require(needed: float, grid: Grid) -> None:
    """Raise `CaseError` where `grid` takes more memory than there is."""
    nx, ny = grid.nodes
    memory.require(
        needed,
        f"grid: {nx} x {ny} nodes",
        "use fewer nodes, a smaller refine, or a machine with more memory",
    )


def run_bytes(grid: Grid, *, plasticity: str, adhesive: bool) -> float:
    """Memory of a run on `grid`, once the surface is there; `plasticity` "none" is elastic."""
    per_node = max(_MODELS[plasticity], _ADHESIVE if adhesive else 0.0)
    return _PROCESS + per_node * nodes_of(grid)


def described_bytes(grid: Grid) -> float:
    """Memory of `restitution surface` on `grid`."""
    return _PROCESS + _DESCRIBED * nodes_of(grid)


def generated_bytes(grid: Grid, *, normal: bool, periodic: bool) -> float:
    """Memory of making a generated surface on `grid`."""
    per_node = _SURFACE if normal else _SKEWED
    if not periodic:
        per_node = max(per_node, _ENLARGED * (_MARGIN if normal else _SKEWED))
    return _PROCESS + per_node * nodes_of(grid)


def measured_bytes(grid: Grid, scan: Grid, *, twin: bool) -> float:
    """Memory of placing a scan with the pixels of `scan` on `grid`, or of making its twin there."""
    size = _PROCESS + _SURFACE * nodes_of(grid) + _SCAN * nodes_of(scan)
    return size + _BAND * _band_nodes(grid, scan) if twin else size


def _band_nodes(grid: Grid, scan: Grid) -> float:
    """Nodes of the finest band of a twin that is adjusted (see `surfaces.twin`), at most."""
    repeats = [max(1.0, s / g) for s, g in zip(scan.size, grid.size, strict=True)]
    ratio = min(h / pixel for h, pixel in zip(grid.spacing, scan.spacing, strict=True))
    coarser = 2.0 ** max(math.floor(math.log2(ratio)), 0)
    wanted, whole = (
        math.prod(
            r * g / (pixel * c)
            for r, g, pixel in zip(repeats, grid.size, scan.spacing, strict=True)
        )
        for c in (coarser, 1.0)
    )
    return max(wanted, min(whole, 2.0**20))
