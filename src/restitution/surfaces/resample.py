"""Resample a surface from its pixels to the cells of another grid."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from restitution.arguments import typed
from restitution.numerics.grid import Grid
from restitution.surfaces.describe import rms_slope
from restitution.surfaces.refused import RefusedSurfaceError
from restitution.surfaces.surface import Array, Surface

_ROUNDING = 1e-9  # largest relative difference of two lengths that count as equal


@typed
def place_on_grid(surface: Surface, grid: Grid) -> Surface:
    """Resample the middle of a surface to the cells of a grid with the same origin.

    With equal spacings, the surface is cropped. Otherwise a cubic spline through the pixel centres
    is evaluated, after removal of waves shorter than two cells; beyond the outermost centres
    heights are constant.

    Args:
        surface: Surface to resample, such as a scan.
        grid: Grid of the new surface, at most as large as `surface`.

    Returns:
        Surface on `grid`; the provenance states the method (`placement`) and the removed waves.

    Raises:
        SurfaceError: The grid is larger than the surface.
    """
    _check_covers(surface.grid, grid)
    kept = carried(surface, grid.spacing)
    if same_spacing(surface.grid, grid):
        height = crop_to(kept, grid.nodes)
        placement = (
            f"cropped from {_nodes(surface.grid)} to {_nodes(grid)} pixels"
            if surface.grid.nodes != grid.nodes
            else "pixels taken as they are"
        )
    else:
        height = spline(kept, (surface.grid.x, surface.grid.y), (grid.x, grid.y))
        placement = _describe_interpolation(surface.grid, grid)
    provenance = {
        **surface.provenance,
        "placement": placement,
        **left_out(surface, kept, grid.spacing),
    }
    if not np.allclose(grid.size, surface.grid.size, rtol=_ROUNDING, atol=0):
        provenance.pop("periodicity", None)  # a part of a periodic surface is not periodic
    return replace(surface, height=np.ascontiguousarray(height), grid=grid, provenance=provenance)


def carried(surface: Surface, spacing: tuple[float, float], *, mirrored: bool = False) -> Array:
    """Heights of `surface` without waves shorter than two cells of `spacing` (m) along an axis.

    The filter continues the surface by its mirror image if `mirrored`, else antisymmetrically about
    the straight line through the ends of each row or column.
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
    """Provenance entries on the waves removed for cells of `spacing` (m), and on those before.

    `kept` are the heights of `surface` without these waves. `removed_slope` is relative to the
    original surface; the pixel size is that of the largest pixels so far.
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
        # Earlier resampling removed the fraction had_slope² of the original mean square slope. The
        # new fraction `slope`² refers to the remaining mean square slope.
        "removed_slope": math.sqrt(had_slope**2 + max(1 - had_slope**2, 0.0) * slope**2),
    }


def _check_covers(scan: Grid, grid: Grid) -> None:
    if any(g > s * (1 + _ROUNDING) for g, s in zip(grid.size, scan.size, strict=True)):
        raise RefusedSurfaceError(
            "grid-beyond-surface",
            f"grid: its area of {_micrometres(grid.size)} um reaches beyond the surface of "
            f"{_micrometres(scan.size)} um",
            "use a smaller grid or a larger surface, or continue the surface with extend",
        )


def same_spacing(scan: Grid, grid: Grid) -> bool:
    """Whether two grids have cells of the same size, within rounding."""
    return all(
        math.isclose(g, s, rel_tol=_ROUNDING)
        for g, s in zip(grid.spacing, scan.spacing, strict=True)
    )


def crop_to(height: Array, nodes: tuple[int, int]) -> Array:
    """Crop `height` to the shape `nodes` (nx, ny), with the same origin."""
    # The origin of a `Grid` is node n // 2.
    i, j = (have // 2 - want // 2 for have, want in zip(height.shape, nodes, strict=True))
    return height[i : i + nodes[0], j : j + nodes[1]]


def _carried(height: Array, ratio: float) -> Array:
    """Remove waves shorter than 2/ratio pixels along the first axis; `ratio` is pixel by cell."""
    from scipy.fft import dst, idst

    n = height.shape[0]
    # The straight line between the ends is subtracted, and the remainder is continued
    # antisymmetrically. So there are neither steps nor kinks at the ends. Sine k has a wavelength
    # of 2(n − 1)/k pixels.
    line = height[:1] + (height[-1:] - height[:1]) * np.linspace(0.0, 1.0, n)[:, None]
    modes = dst((height - line)[1:-1], type=1, axis=0)
    modes[math.floor((n - 1) * ratio) :] = 0.0
    line[1:-1] += idst(modes, type=1, axis=0)
    return line


def _carried_mirrored(height: Array, ratio: float) -> Array:
    from scipy.fft import dct, idct

    modes = dct(height, type=2, axis=0)  # cosine k has a wavelength of 2n/k pixels
    modes[math.floor(height.shape[0] * ratio) + 1 :] = 0.0
    return np.asarray(idct(modes, type=2, axis=0))


def spline(height: Array, at: Sequence[Array], to: Sequence[Array]) -> Array:
    """`height` interpolated from the coordinates `at` along x and y to others; constant beyond."""
    from scipy.interpolate import make_interp_spline

    for old, new in zip(at, to, strict=True):
        if old.size == 1:
            height = np.repeat(height, new.size, axis=0).T
        else:
            through = make_interp_spline(old, height, k=min(3, old.size - 1), axis=0)
            height = through(np.clip(new, old[0], old[-1])).T
    return height


def _describe_interpolation(scan: Grid, grid: Grid) -> str:
    coarser = any(g > s * (1 + _ROUNDING) for g, s in zip(grid.spacing, scan.spacing, strict=True))
    if coarser:
        nyquist = _micrometres((2 * grid.spacing[0], 2 * grid.spacing[1]))
        return (
            f"sampled every {_micrometres(grid.spacing)} um from pixels of "
            f"{_micrometres(scan.spacing)} um, after removing waves shorter than {nyquist} um"
        )
    return (
        f"interpolated from {_micrometres(scan.spacing)} um to {_micrometres(grid.spacing)} um "
        "by cubic spline"
    )


def _micrometres(lengths: tuple[float, float]) -> str:
    return " x ".join(f"{length * 1e6:g}" for length in lengths)


def _nodes(grid: Grid) -> str:
    return " x ".join(str(n) for n in grid.nodes)
