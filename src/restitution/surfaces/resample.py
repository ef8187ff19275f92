"""From the pixels of a scan to the cells of the contact's grid."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.describe import rms_slope
from restitution.surfaces.surface import Surface

Array = NDArray[np.float64]

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

    The provenance gains `placement` (how) and what was left out (`left_out`), so that a caller can
    tell a grid finer or coarser than its data.

    Raises `SurfaceError` when `grid` is larger than the surface.
    """
    _check_covers(surface.grid, grid)
    kept = carried(surface, grid.spacing)
    if same_spacing(surface.grid, grid):
        height = crop_to(kept, grid.nodes)
        changed = surface.grid.nodes != grid.nodes
        placement = (
            f"cropped from {_nodes(surface.grid)} to {_nodes(grid)} pixels"
            if changed
            else "pixels taken as they are"
        )
    else:
        height, had = kept, surface.grid
        for at, to in ((had.x, grid.x), (had.y, grid.y)):
            height = spline(height, at, to).T
        placement = _describe_interpolation(surface.grid, grid)
    provenance = {
        **surface.provenance,
        "placement": placement,
        **left_out(surface, kept, grid.spacing),
    }
    if not np.allclose(grid.size, surface.grid.size, rtol=_ROUNDING, atol=0):
        provenance.pop("periodicity", None)  # a part does not match at opposite edges
    return replace(surface, height=np.ascontiguousarray(height), grid=grid, provenance=provenance)


def carried(surface: Surface, spacing: tuple[float, float], *, mirrored: bool = False) -> Array:
    """The heights of `surface` without the waves that cells of `spacing` (m) cannot carry.

    Along either axis these are the ones shorter than two cells. The surface is continued beyond its
    edges with the opposite sign, less the straight line from end to end, or `mirrored`.
    """
    height = surface.height
    keep = _carried_mirrored if mirrored else _carried
    for axis in range(2):
        ratio = surface.grid.spacing[axis] / spacing[axis]
        if ratio < 1 - _ROUNDING and height.shape[0] > 2:
            height = keep(height, ratio * (1 + _ROUNDING))
        height = height.T
    return height


def left_out(surface: Surface, kept: Array, spacing: tuple[float, float]) -> dict[str, float]:
    """Provenance of a surface of which cells of `spacing` (m) carry the heights `kept`.

    `removed_rms_m` and `removed_slope`: of the waves taken out, the slope as a part of the
    surface's own; `shortest_carried_m`: the shortest wave there is now; `pixel_x_m`, `pixel_y_m`:
    the coarsest pixel the heights have passed through.
    """
    before = surface.provenance
    pixel = [
        max(h, float(before.get(f"pixel_{axis}_m", 0.0)))
        for axis, h in zip("xy", surface.grid.spacing, strict=True)
    ]
    had_rms, had_slope = (float(before.get(f"removed_{key}", 0.0)) for key in ("rms_m", "slope"))
    rms = slope = 0.0
    if kept is not surface.height and (whole := rms_slope(surface)) > 0:
        taken = Surface(surface.height - kept, surface.grid)
        rms, slope = float(np.std(taken.height)), rms_slope(taken) / whole
    return {
        "pixel_x_m": pixel[0],
        "pixel_y_m": pixel[1],
        "shortest_carried_m": 2 * max(*spacing, *pixel),
        "removed_rms_m": math.hypot(had_rms, rms),
        # What is left of the slope was 1 − had² of its mean square.
        "removed_slope": math.sqrt(had_slope**2 + max(1 - had_slope**2, 0.0) * slope**2),
    }


def _check_covers(scan: Grid, grid: Grid) -> None:
    if any(g > s * (1 + _ROUNDING) for g, s in zip(grid.size, scan.size, strict=True)):
        raise SurfaceError(
            f"grid: its {_micrometres(grid.size)} um reach beyond the surface of "
            f"{_micrometres(scan.size)} um; use a smaller grid.nodes or grid.spacing, a larger "
            "scan, or roughness.extend"
        )


def same_spacing(scan: Grid, grid: Grid) -> bool:
    """Whether two grids have the same cells, but for rounding."""
    return all(
        math.isclose(g, s, rel_tol=_ROUNDING)
        for g, s in zip(grid.spacing, scan.spacing, strict=True)
    )


def crop_to(height: Array, nodes: tuple[int, int]) -> Array:
    """The part of `height` with so many `nodes` about the same origin."""
    # `Grid` has its origin at node n // 2, so these are the same point.
    i, j = (have // 2 - want // 2 for have, want in zip(height.shape, nodes, strict=True))
    return height[i : i + nodes[0], j : j + nodes[1]]


def _carried(height: Array, ratio: float) -> Array:
    """Heights along the first axis without the waves shorter than 2/ratio pixels."""
    from scipy.fft import dst, idst

    n = height.shape[0]
    # Less the straight line from end to end, and continued with the opposite sign on either side,
    # heights have neither steps nor kinks at the ends. Sine k then has a wave length of 2(n − 1)/k
    # pixels.
    line = height[:1] + (height[-1:] - height[:1]) * np.linspace(0.0, 1.0, n)[:, None]
    modes = dst((height - line)[1:-1], type=1, axis=0)
    modes[math.floor((n - 1) * ratio) :] = 0.0
    line[1:-1] += idst(modes, type=1, axis=0)
    return line


def _carried_mirrored(height: Array, ratio: float) -> Array:
    """The same of heights that are continued by their mirror image."""
    from scipy.fft import dct, idct

    modes = dct(height, type=2, axis=0)  # cosine k has a wave length of 2n/k pixels
    modes[math.floor(height.shape[0] * ratio) + 1 :] = 0.0
    kept: Array = idct(modes, type=2, axis=0)
    return kept


def spline(height: Array, at: Array, to: Array) -> Array:
    """Cubic spline along the first axis, from coordinates `at` to `to`, held beyond the ends."""
    from scipy.interpolate import make_interp_spline

    if at.size == 1:
        return np.repeat(height, to.size, axis=0)
    through = make_interp_spline(at, height, k=min(3, at.size - 1), axis=0)
    held: Array = through(np.clip(to, at[0], at[-1]))
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
