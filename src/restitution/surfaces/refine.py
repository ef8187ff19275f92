"""The same surface on a finer or a coarser grid over the same domain, by its spectrum."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface, is_periodic

Array = NDArray[np.float64]


def refine(surface: Surface, factor: int) -> Surface:
    """`surface` on cells `factor` times as small along either axis, over the same domain.

    Heights at the new nodes are those of the trigonometric polynomial through the old ones (zero
    padding of the spectrum): no wave is added. A surface that is not periodic is continued by its
    mirror image first, so that its edges do not ring. Both grids keep their origin (see `Grid`).
    Raises `SurfaceError` for a factor below 1.
    """
    if factor < 1:
        raise SurfaceError(f"refine: {factor} is not a number of cells to divide one into")
    if factor == 1:
        return surface
    how = "periodic" if is_periodic(surface) else "mirrored"
    grid = divided(surface.grid, factor)
    return Surface(
        _resampled(surface, grid.nodes),
        grid,
        {**surface.provenance, "refined": factor, "refinement": f"zero-padded spectrum, {how}"},
    )


def coarsen(surface: Surface, factor: int = 2) -> Surface:
    """`surface` on cells `factor` times as large, without the waves that these cannot carry.

    Where `factor` does not divide the number of nodes, the cells are up to one part in that number
    smaller. Waves shorter than two cells are left out, and the rest is kept to the last digit.
    Raises `SurfaceError` for a factor below 1.
    """
    if factor < 1:
        raise SurfaceError(f"coarsen: {factor} is not a number of cells to join")
    nx, ny = (-(-n // factor) for n in surface.grid.nodes)
    wide, long = surface.grid.size
    grid = Grid((nx, ny), (wide / nx, long / ny))
    return Surface(_resampled(surface, grid.nodes), grid, {**surface.provenance})


def _resampled(surface: Surface, nodes: tuple[int, int]) -> Array:
    """Heights of `surface` at the nodes of a grid with so many over the same domain."""
    height = surface.height
    for n in nodes:
        height = _at_nodes(height, n, periodic=is_periodic(surface)).T
    return np.ascontiguousarray(height)


def divided(grid: Grid, factor: int) -> Grid:
    """`grid` with every cell divided into `factor` along either axis."""
    return Grid(
        (factor * grid.nodes[0], factor * grid.nodes[1]),
        (grid.spacing[0] / factor, grid.spacing[1] / factor),
    )


def _at_nodes(height: Array, nodes: int, *, periodic: bool) -> Array:
    """Values along the first axis at another number of nodes over the same length."""
    from scipy.fft import irfft, rfft

    n = height.shape[0]
    first = n // 2 - (nodes // 2) * n / nodes  # of the new nodes, in old cells
    values = height if periodic else np.concatenate([height, height[::-1]])
    period = values.shape[0]
    new_period = nodes * period // n
    modes = rfft(values, axis=0)
    if period % 2 == 0:
        modes[-1] *= 0.5  # the shortest wave is no longer its own mirror image
    if new_period < period:
        # The wave of two new cells cannot be told from its mirror image there: it goes, too.
        modes = modes[: (new_period + 1) // 2]
    number = np.arange(modes.shape[0])[:, None]
    modes *= new_period / period * np.exp(2j * np.pi * number * first / period)
    resampled: Array = irfft(modes, n=new_period, axis=0)
    return resampled[:nodes]
