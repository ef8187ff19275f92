"""From the pixels of a scan to the cells of the contact's grid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.surface import Surface

# Lengths that differ by less than this part of themselves are the same length, rounded.
_ROUNDING = 1e-9


def place_on_grid(surface: Surface, grid: Grid) -> Surface:
    """Take the centred part of `surface` onto `grid`; heights at cell centres, shape `grid.nodes`.

    Both keep their origin (see `Grid`). With equal spacings the cells coincide: pixels are cropped
    and no height changes. Otherwise a cubic spline through the pixel centres is evaluated at the
    cell centres. Along an axis with coarser cells the waves that these cannot carry (shorter than
    two of them) are taken out first: they would come back as longer ones. Beyond the outermost
    pixel centres, where a grid as large as the scan has a rim of cells less than a pixel wide, the
    height is held and not extrapolated.

    The provenance gains `placement` (how), and `pixel_x_m`, `pixel_y_m`: the coarsest pixel the
    heights have passed through, so that a caller can tell a grid finer than its data.

    Raises `SurfaceError` when `grid` is larger than the surface.
    """
    _check_covers(surface.grid, grid)
    if _same_spacing(surface.grid, grid):
        height = _crop(surface.height, grid.nodes)
        changed = surface.grid.nodes != grid.nodes
        placement = (
            f"cropped from {_nodes(surface.grid)} to {_nodes(grid)} pixels"
            if changed
            else "pixels taken as they are"
        )
    else:
        height, had = surface.height, surface.grid
        for at, to in ((had.x, grid.x), (had.y, grid.y)):
            height = _interpolate_rows(_carried(height, at, to), at, to).T
        placement = _describe_interpolation(surface.grid, grid)
    pixel = {
        key: max(h, float(surface.provenance.get(key, 0.0)))
        for key, h in zip(("pixel_x_m", "pixel_y_m"), surface.grid.spacing, strict=True)
    }
    provenance = {**surface.provenance, "placement": placement, **pixel}
    if not np.allclose(grid.size, surface.grid.size, rtol=_ROUNDING, atol=0):
        provenance.pop("periodicity", None)  # a part does not match at opposite edges
    return replace(surface, height=np.ascontiguousarray(height), grid=grid, provenance=provenance)


def _check_covers(scan: Grid, grid: Grid) -> None:
    if any(g > s * (1 + _ROUNDING) for g, s in zip(grid.size, scan.size, strict=True)):
        raise SurfaceError(
            f"grid: its {_micrometres(grid.size)} um reach beyond the surface of "
            f"{_micrometres(scan.size)} um; use a smaller grid.nodes or grid.spacing, a larger "
            "scan, or roughness.extend"
        )


def _same_spacing(scan: Grid, grid: Grid) -> bool:
    return all(
        math.isclose(g, s, rel_tol=_ROUNDING)
        for g, s in zip(grid.spacing, scan.spacing, strict=True)
    )


def _crop(height: NDArray[np.float64], nodes: tuple[int, int]) -> NDArray[np.float64]:
    # `Grid` has its origin at node n // 2, so these are the same point.
    i, j = (have // 2 - want // 2 for have, want in zip(height.shape, nodes, strict=True))
    return height[i : i + nodes[0], j : j + nodes[1]]


def _carried(
    height: NDArray[np.float64], at: NDArray[np.float64], to: NDArray[np.float64]
) -> NDArray[np.float64]:
    """What cells at coordinates `to` can carry of heights at `at` (m), along the first axis."""
    from scipy.fft import dst, idst

    n = at.size
    if min(n, to.size) < 3 or to[1] - to[0] <= (at[1] - at[0]) * (1 + _ROUNDING):
        return height
    # Less the straight line from end to end, and continued with the opposite sign on either side,
    # heights have neither steps nor kinks at the ends. Sine k then has a wave length of 2(n − 1)/k
    # pixels.
    line = height[:1] + (height[-1:] - height[:1]) * np.linspace(0.0, 1.0, n)[:, None]
    modes = dst((height - line)[1:-1], type=1, axis=0)
    modes[math.floor((n - 1) * (at[1] - at[0]) / (to[1] - to[0]) * (1 + _ROUNDING)) :] = 0.0
    carried = line.copy()
    carried[1:-1] += idst(modes, type=1, axis=0)
    return carried


def _interpolate_rows(
    height: NDArray[np.float64], at: NDArray[np.float64], to: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Spline along the first axis, from coordinates `at` to coordinates `to` (m)."""
    from scipy.interpolate import make_interp_spline

    if at.size == 1:
        return np.repeat(height, to.size, axis=0)
    spline = make_interp_spline(at, height, k=min(3, at.size - 1), axis=0)
    held: NDArray[np.float64] = spline(np.clip(to, at[0], at[-1]))
    return held


def _describe_interpolation(scan: Grid, grid: Grid) -> str:
    coarser = any(g > s * (1 + _ROUNDING) for g, s in zip(grid.spacing, scan.spacing, strict=True))
    if coarser:
        nyquist = _micrometres((2 * grid.spacing[0], 2 * grid.spacing[1]))
        return (
            f"sampled every {_micrometres(grid.spacing)} um from pixels of "
            f"{_micrometres(scan.spacing)} um, once waves shorter than {nyquist} um were taken out"
        )
    return (
        f"interpolated from {_micrometres(scan.spacing)} um to {_micrometres(grid.spacing)} um "
        "by cubic spline"
    )


def _micrometres(lengths: tuple[float, float]) -> str:
    return " x ".join(f"{length * 1e6:g}" for length in lengths)


def _nodes(grid: Grid) -> str:
    return " x ".join(str(n) for n in grid.nodes)
