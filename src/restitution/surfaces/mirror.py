"""Tile a grid with a scan and its mirror images."""

from __future__ import annotations

import numpy as np

from restitution.numerics.grid import Grid
from restitution.surfaces.resample import (
    carried,
    left_out,
    place_on_grid,
    same_spacing,
    spline,
)
from restitution.surfaces.surface import Array, Surface, noted


def mirrored(scan: Surface, grid: Grid) -> Surface:
    """Cover `grid` with tiles: the scan in the middle, surrounded by its mirror images.

    If the scan is at least as large as the grid, no mirror images are needed, and the surface is a
    part of the scan. Waves that are too short for the cells of `grid` are removed. A cubic spline
    interpolates the heights between pixels.
    """
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
    """Convert coordinates (m) on the tiled surface to fractional pixel indices in the scan.

    `along` are coordinates along one axis, x or y. The scan has `n` pixels with the spacing `h` (m)
    along this axis.
    """
    from_edge = np.mod(along / h + n // 2 + 0.5, 2 * n)
    folded: Array = np.minimum(from_edge, 2 * n - from_edge) - 0.5
    return np.clip(folded, 0.0, n - 1.0)
