"""Estimates of the memory that a case needs, made before any array is allocated.

The constants were measured as peak resident sizes of whole processes on grids of 512² to 2048²
nodes, with up to 90 % of the nodes in contact. They are rounded up, so an estimate can be up to 1.5
times the true size.
"""

from __future__ import annotations

import math

from restitution.numerics import memory
from restitution.numerics.grid import Grid

_PROCESS = 340e6  # bytes for the program, its libraries and its plots

# Bytes per node of the grid, unless stated otherwise. A twin is a random surface with the
# statistics of a scan (see `surfaces.twin`).
_SURFACE = 75.0  # a generated surface
_SKEWED = 115.0  # a generated surface with skewness or kurtosis
_MARGIN = 60.0  # per node of the enlarged grid from which a non-periodic surface is cut
_SCAN = 60.0  # per pixel, to read and level a scan and compute its spectrum
_BAND = 90.0  # per node of the finest grid on which the waves of a twin are adjusted
_DESCRIBED = 150.0  # `restitution surface`: autocorrelation, spectrum and HTML page

_MAPS = 16.0  # per node and depth: a map of pressure and one of plastic displacement

# A non-periodic surface is cut from a surface on an enlarged grid (`generate._enlarged`). The
# number of nodes along each axis is at most doubled and then rounded up to a fast FFT length. The
# enlarged grid therefore has at most about _ENLARGED times as many nodes as the surface.
_ENLARGED = 4.0


def nodes_of(grid: Grid) -> int:
    """Number of nodes of `grid`."""
    return math.prod(grid.nodes)


def require(needed: float, grid: Grid) -> None:
    """Raise `CaseError` if the `needed` bytes for `grid` exceed the available memory."""
    memory.require(
        needed,
        f"grid: {grid.nodes[0]} x {grid.nodes[1]} nodes",
        "use fewer nodes, a smaller refine, or a machine with more memory",
    )


def run_bytes(grid: Grid, per_node: float) -> float:
    """Memory (bytes) of a run on `grid` whose models need `per_node` (bytes)."""
    return _PROCESS + per_node * nodes_of(grid)


def maps_bytes(grid: Grid, depths: int, *, yields: bool) -> float:
    """Size (bytes) of the maps of `depths` depths: pressure and, if bodies yield, displacement."""
    return (_MAPS if yields else 0.5 * _MAPS) * depths * nodes_of(grid)


def require_maps(needed: float, depths: int) -> None:
    """Raise `CaseError` if a run that keeps maps of `depths` depths needs too much memory."""
    memory.require(
        needed,
        f'maps = "all": the maps of {depths} depths and the run',
        "leave out maps, or use fewer depths or nodes",
    )


def described_bytes(grid: Grid) -> float:
    """Memory (bytes) of `restitution surface` on `grid`."""
    return _PROCESS + _DESCRIBED * nodes_of(grid)


def generated_bytes(grid: Grid, *, normal: bool, periodic: bool) -> float:
    """Memory (bytes) for generating a surface on `grid`; `normal` means Gaussian heights."""
    per_node = _SURFACE if normal else _SKEWED
    if not periodic:
        per_node = max(per_node, _ENLARGED * (_MARGIN if normal else _SKEWED))
    return _PROCESS + per_node * nodes_of(grid)


def measured_bytes(grid: Grid, scan: Grid, *, twin: bool) -> float:
    """Memory (bytes) for placing a scan (`scan`: its pixels) on `grid`, or for its `twin`."""
    size = _PROCESS + _SURFACE * nodes_of(grid) + _SCAN * nodes_of(scan)
    return size + _BAND * _band_nodes(grid, scan) if twin else size


def _band_nodes(grid: Grid, scan: Grid) -> float:
    """Nodes of the finest grid on which a twin is adjusted (`surfaces.twin`), at most."""
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
