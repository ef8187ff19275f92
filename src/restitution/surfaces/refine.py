"""Resample a surface to a finer or coarser grid over the same domain, by Fourier interpolation."""

from __future__ import annotations

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Array, Surface, is_periodic

FACTORS = (1, 2, 4, 8, 16, 32, 64)  # factors of `grid.refine` in a case file


@typed
def refine(surface: Surface, factor: int) -> Surface:
    """Resample a surface to smaller cells over the same domain, without adding waves.

    Args:
        surface: Surface to refine; its mirror image extends it first if it is not periodic.
        factor: Number of new cells per old cell along each axis, at least 1.

    Returns:
        Surface on the finer grid.

    Raises:
        SurfaceError: The factor is below 1.
    """
    if factor < 1:
        raise SurfaceError(f"factor: {factor} is not a positive integer")
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
    """Resample `surface` to cells nearly `factor` times as large, a whole number of which fits.

    Waves that are not longer than two new cells are removed. `SurfaceError` for a factor below 1.
    """
    if factor < 1:
        raise SurfaceError(f"factor: {factor} is not a positive integer")
    nx, ny = (-(-n // factor) for n in surface.grid.nodes)
    wide, long = surface.grid.size
    grid = Grid((nx, ny), (wide / nx, long / ny))
    return Surface(_resampled(surface, grid.nodes), grid, surface.provenance)


def _resampled(surface: Surface, nodes: tuple[int, int]) -> Array:
    height = surface.height
    for n in nodes:
        height = _at_nodes(height, n, periodic=is_periodic(surface)).T
    return height


def divided(grid: Grid, factor: int) -> Grid:
    """Divide every cell of `grid` into `factor` cells along each axis."""
    return Grid(
        (factor * grid.nodes[0], factor * grid.nodes[1]),
        (grid.spacing[0] / factor, grid.spacing[1] / factor),
    )


def _at_nodes(height: Array, nodes: int, *, periodic: bool) -> Array:
    from scipy.fft import irfft, rfft

    n = height.shape[0]
    # Distance from the first old node to the first new node, in old cells.
    first = n // 2 - (nodes // 2) * n / nodes
    values = height if periodic else np.concatenate([height, height[::-1]])
    period = values.shape[0]
    new_period = nodes * period // n
    modes = rfft(values, axis=0)
    if period % 2 == 0:
        modes[-1] *= 0.5  # a finer grid splits the old Nyquist mode into two conjugate modes
    if new_period < period:
        # The Nyquist mode of the new grid (a wave of two cells) is removed, too, because the grid
        # cannot represent its phase.
        modes = modes[: (new_period + 1) // 2]
    number = np.arange(modes.shape[0])[:, None]
    modes *= new_period / period * np.exp(2j * np.pi * number * first / period)
    return np.asarray(irfft(modes, n=new_period, axis=0)[:nodes])
