"""Remove margins, spikes and undefined pixels from a scan."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.level import level
from restitution.surfaces.surface import Array, Surface

Range = tuple[float, float]

_NEIGHBOURHOOD = 5  # edge length (pixels) of the square window of the local median
_SIGMA = 1.4826  # normal distribution: standard deviation divided by median absolute deviation
_MOST = 0.1  # largest fraction of pixels that may be outliers


@typed
def crop(surface: Surface, *, x: Range | None = None, y: Range | None = None) -> Surface:
    """Keep only the pixels whose centres lie within ranges of x and y, as in `surface.grid`.

    Args:
        surface: Surface to crop.
        x: Lowest and highest x (m), zero in the middle of the scan; None keeps the whole range.
        y: Lowest and highest y (m), likewise.

    Returns:
        Surface of the remaining pixels, with x and y zero in its middle.

    Raises:
        SurfaceError: A range extends beyond the scan, or no pixel lies within it.
    """
    part = []
    for name, within, centres, h in (
        ("x", x, surface.grid.x, surface.grid.spacing[0]),
        ("y", y, surface.grid.y, surface.grid.spacing[1]),
    ):
        low, high = within or (centres[0], centres[-1])
        # The scan extends half a pixel beyond the outermost centres. The range may extend another
        # half pixel: x and y are zero at the centre of a pixel, which is half a pixel away from the
        # middle of the scan if the number of pixels is even.
        if low < centres[0] - h or high > centres[-1] + h:
            raise SurfaceError(
                f"the range from {_um(low, high)} extends beyond the scan, whose pixels "
                f"lie from {_um(centres[0], centres[-1])} ({name} is zero in the middle)",
                argument=name,
            )
        inside = np.flatnonzero((low <= centres) & (centres <= high))
        if inside.size == 0:
            raise SurfaceError(
                f"no pixel lies from {_um(low, high)}; choose a wider range, because the "
                f"pixels are {1e6 * h:.4g} um apart",
                argument=name,
            )
        part.append(inside)
    grid = Grid((part[0].size, part[1].size), surface.grid.spacing)
    return Surface(
        surface.height[np.ix_(*part)],
        grid,
        {
            **surface.provenance,
            "cropped": f"{grid.nodes[0]} x {grid.nodes[1]} of {surface.grid.nodes[0]} x "
            f"{surface.grid.nodes[1]} pixels",
            "size_x_m": grid.size[0],
            "size_y_m": grid.size[1],
        },
    )


@typed
def remove_outliers(surface: Surface, threshold: float) -> Surface:
    """Replace outliers by harmonic interpolation of the pixels around them.

    Outliers differ from the median of 5 x 5 pixels, after subtraction of the least-squares
    paraboloid, by more than `threshold` standard deviations, estimated from the median absolute
    difference.

    Args:
        surface: Surface to clean.
        threshold: Number of standard deviations (dimensionless). 6 to 10 removes spikes, dust of up
            to 3 x 3 pixels and single slipped scan lines; smaller values also remove summits.

    Returns:
        Surface without outliers; the provenance states their number and largest step.

    Raises:
        SurfaceError: The threshold is not positive, or more than 10 % of the pixels are outliers.
    """
    if not (math.isfinite(threshold) and threshold > 0):
        raise SurfaceError(f"{threshold:g} is not a positive number", argument="threshold")
    height = surface.height
    signed, deviation, _ = local_steps(surface)
    step = np.abs(signed)
    # If `deviation` is zero, at least half of the pixels equal their local median. A threshold in
    # standard deviations is then meaningless, so no pixel counts as an outlier.
    out = step > threshold * deviation if deviation > 0 else np.zeros(height.shape, bool)
    count = int(np.count_nonzero(out))
    if count > _MOST * out.size:
        raise SurfaceError(
            f"{count / out.size:.0%} of the pixels deviate by more than {threshold:g} "
            f"standard deviations, but at most {_MOST:.0%} may be outliers; give a larger "
            "threshold, or do not remove outliers",
            argument="threshold",
        )
    return replace(
        surface,
        height=fill_harmonically(np.where(out, np.nan, height), surface.grid.spacing),
        provenance={
            **surface.provenance,
            "outliers": count,
            "outlier_threshold": float(threshold),
            "outlier_largest_step_m": float(step[out].max()) if count else 0.0,
        },
    )


def local_steps(surface: Surface) -> tuple[Array, float, Array]:
    """Heights minus their local median, standard deviation of these steps, and heights (m)."""
    from scipy.ndimage import median_filter

    height = level(surface, "curvature").height
    step = height - median_filter(height, _NEIGHBOURHOOD, mode="reflect")
    return step, _SIGMA * float(np.median(np.abs(step))), height


def fill_harmonically(height: Array, spacing: tuple[float, float]) -> Array:
    """Fill NaN pixels by Laplace's equation, with a normal slope of zero at the edge of the scan.

    `height` has shape (nx, ny) and at least one defined pixel; `spacing` is (hx, hy) in m. Filling
    adds no summit that could make contact.
    """
    from scipy.sparse import coo_array
    from scipy.sparse.linalg import spsolve

    unknown = ~np.isfinite(height)
    count = int(np.count_nonzero(unknown))
    if count == 0:
        return height
    number = np.full(height.shape, -1)
    number[unknown] = np.arange(count)
    at = np.nonzero(unknown)

    # The matrix is the five-point Laplacian, with one row for each unknown pixel:
    # Σ weight (z_here − z_neighbour) = 0.
    diagonal, right_side = np.zeros(count), np.zeros(count)
    rows, columns, values = [np.arange(count)], [np.arange(count)], [diagonal]
    for axis, h in enumerate(spacing):
        # The weights are proportional to 1/h²; a common factor has no effect.
        weight = (max(spacing) / h) ** 2
        for step in (1, -1):
            along = at[axis] + step
            me = np.flatnonzero((along >= 0) & (along < height.shape[axis]))
            there = tuple((along if k == axis else at[k])[me] for k in range(2))
            other = number[there]
            diagonal[me] += weight
            inside = other >= 0
            rows.append(me[inside])
            columns.append(other[inside])
            values.append(np.full(np.count_nonzero(inside), -weight))
            right_side[me[~inside]] += weight * height[there][~inside]
    laplacian = coo_array(
        (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
        shape=(count, count),
    )
    filled = height.copy()
    # This ordering of the unknowns exploits the symmetry of the matrix.
    filled[unknown] = spsolve(laplacian.tocsc(), right_side, permc_spec="MMD_AT_PLUS_A")
    return filled


def _um(low: float, high: float) -> str:
    return f"{1e6 * low:.4g} to {1e6 * high:.4g} um"
