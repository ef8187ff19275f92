"""The same surface on a finer grid: its waves, and no others, between the nodes."""

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
    periodic = is_periodic(surface)
    height = surface.height
    for _ in range(2):
        height = _between(height, factor, periodic=periodic).T
    return Surface(
        np.ascontiguousarray(height),
        divided(surface.grid, factor),
        {
            **surface.provenance,
            "refined": factor,
            "refinement": f"zero-padded spectrum, {'periodic' if periodic else 'mirrored'}",
        },
    )


def divided(grid: Grid, factor: int) -> Grid:
    """`grid` with every cell divided into `factor` along either axis."""
    return Grid(
        (factor * grid.nodes[0], factor * grid.nodes[1]),
        (grid.spacing[0] / factor, grid.spacing[1] / factor),
    )


def _between(height: Array, factor: int, *, periodic: bool) -> Array:
    """Values along the first axis at `factor` times as many nodes."""
    from scipy.fft import irfft, rfft

    n = height.shape[0]
    first = n // 2 - (factor * n // 2) / factor  # of the new nodes, in old cells
    values = height if periodic else np.concatenate([height, height[::-1]])
    period = values.shape[0]
    modes = rfft(values, axis=0)
    if period % 2 == 0:
        modes[-1] *= 0.5  # the shortest wave is no longer its own mirror image
    number = np.arange(modes.shape[0])[:, None]
    modes *= factor * np.exp(2j * np.pi * number * first / period)
    finer: Array = irfft(modes, n=factor * period, axis=0)
    return finer[: factor * n]
