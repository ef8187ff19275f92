"""Extend a scan beyond the measured area, by mirror images or by a statistical twin."""

from __future__ import annotations

import math
from typing import Literal, get_args

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.resample import (
    carried,
    left_out,
    place_on_grid,
    same_spacing,
    spline,
)
from restitution.surfaces.surface import Array, Surface, noted
from restitution.surfaces.twin import twin

Extension = Literal["twin", "mirror"]


@typed
def extend(
    surface: Surface, to: Grid | tuple[float, float], how: Extension, *, seed: int | None = None
) -> Surface:
    """Extend a scan to a larger area.

    Args:
        surface: Scan to extend.
        to: Grid of the new surface, or the edge lengths along x and y (m), with the pixels of the
            scan.
        how: `twin`, a random surface with the spectrum, the distribution of heights and the rms
            slope of the scan; or `mirror`, tiles of the scan and its mirror images, whose slopes
            jump where tiles meet.
        seed: Seed of the random phases; for a twin only.

    Returns:
        Extended surface, without waves too short for its cells; a `notice` says it is not the scan.

    Raises:
        SurfaceError: An argument is invalid, or the scan has no twin: it is flat, has fewer than 16
            pixels along an axis, or has an edge that is not longer than two cells of the grid.
    """
    if how not in get_args(Extension):
        raise SurfaceError(f"how={how!r} is unknown; choose 'twin' or 'mirror'")
    grid = to if isinstance(to, Grid) else _with_pixels_of(surface, to)
    if how == "twin":
        if seed is None or seed < 0:
            raise SurfaceError("seed: a twin needs a seed; give a whole number from 0 up")
        return twin(surface, grid, seed)
    if seed is not None:
        raise SurfaceError("seed: does not apply to how='mirror'; leave it out")
    return _mirrored(surface, grid)


def _with_pixels_of(surface: Surface, size: tuple[float, float]) -> Grid:
    if not all(math.isfinite(edge) and edge > 0 for edge in size):
        raise SurfaceError(f"argument `to`: {size} m are not two positive lengths")
    nx, ny = (
        math.ceil(edge / h * (1 - 1e-9)) for edge, h in zip(size, surface.grid.spacing, strict=True)
    )
    return Grid((nx, ny), surface.grid.spacing)


def _mirrored(scan: Surface, grid: Grid) -> Surface:
    """Tile `grid` with the scan in the middle and its mirror images; a part of a larger scan."""
    if all(g <= s * (1 + 1e-9) for g, s in zip(grid.size, scan.grid.size, strict=True)):
        return place_on_grid(scan, grid)
    axes = zip((grid.x, grid.y), scan.grid.nodes, scan.grid.spacing, strict=True)
    at = [_pixel(along, n, h) for along, n, h in axes]
    kept = carried(scan, grid.spacing, mirrored=True)
    if same_spacing(scan.grid, grid):
        height = kept[np.ix_(*(np.rint(a).astype(int) for a in at))]
    else:
        height = spline(kept, [np.arange(n, dtype=float) for n in kept.shape], at)
    tiles = " x ".join(f"{g / s:.3g}" for g, s in zip(grid.size, scan.grid.size, strict=True))
    return Surface(
        height,
        grid,
        {
            **noted(
                scan.provenance,
                f"{scan.provenance.get('file', 'the scan')}: the surface consists of {tiles} tiles "
                "of the scan and its mirror images, so it repeats itself",
            ),
            "source": "mirrored",
            "extension": f"mirrored tiling, {tiles} times the scan",
            "placement": "tiles of the scan, with the waves that the grid carries",
            **left_out(scan, kept, grid.spacing),
        },
    )


def _pixel(along: Array, n: int, h: float) -> Array:
    """Fractional pixel indices in the scan of coordinates `along` (m) one axis of the tiles."""
    from_edge = np.mod(along / h + n // 2 + 0.5, 2 * n)
    folded: Array = np.minimum(from_edge, 2 * n - from_edge) - 0.5
    return np.clip(folded, 0.0, n - 1.0)
