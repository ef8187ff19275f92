"""What does not belong to a surface, taken out of its scan: a margin, and spikes."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.errors import SurfaceError
from restitution.numerics.grid import Grid
from restitution.surfaces.fill import fill_harmonically
from restitution.surfaces.surface import Surface

Range = tuple[float, float]

_NEIGHBOURHOOD = 5  # pixels across
_SIGMA = 1.4826  # of a normal distribution, over the median of its deviations
_MOST = 0.1  # of the pixels: what is more frequent is no outlier


def crop(surface: Surface, *, x: Range | None = None, y: Range | None = None) -> Surface:
    """The pixels of `surface` whose centres lie within the ranges `x` and `y` (m).

    Coordinates are those of `surface.grid`, zero in the middle, as its maps show them; the part
    gets its own zero in its middle. Raises `SurfaceError` for a range that holds no pixel.
    """
    part, nodes = [], []
    for name, within, centres in (("x", x, surface.grid.x), ("y", y, surface.grid.y)):
        inside = np.arange(centres.size)
        if within is not None:
            inside = np.flatnonzero((within[0] <= centres) & (centres <= within[1]))
        if inside.size == 0:
            raise SurfaceError(
                f"crop: no pixel of the scan has its {name} between "
                f"{_um(*(within or (0.0, 0.0)))}; it reaches from {_um(centres[0], centres[-1])}"
            )
        part.append(slice(int(inside[0]), int(inside[-1]) + 1))
        nodes.append(int(inside.size))
    size_x, size_y = (n * h for n, h in zip(nodes, surface.grid.spacing, strict=True))
    return Surface(
        np.ascontiguousarray(surface.height[part[0], part[1]]),
        Grid((nodes[0], nodes[1]), surface.grid.spacing),
        {
            **surface.provenance,
            "cropped": f"{nodes[0]} x {nodes[1]} of {surface.grid.nodes[0]} x "
            f"{surface.grid.nodes[1]} pixels",
            "size_x_m": size_x,
            "size_y_m": size_y,
        },
    )


def remove_outliers(surface: Surface, threshold: float) -> Surface:
    """Replace pixels that stand out from their neighbourhood, harmonically from those around them.

    A pixel stands out where it differs from the median of the 5 x 5 pixels around it by more than
    `threshold` standard deviations of such differences; their standard deviation is taken from the
    median of their absolute values, on which outliers have no hold. 6 to 10 takes dust, spikes and
    slipped scan lines; less takes summits. The provenance gains how many there were and the
    largest step. Raises `SurfaceError` for a threshold that is not positive and where more than
    10 % of the pixels stand out.
    """
    from scipy.ndimage import median_filter

    if not (math.isfinite(threshold) and threshold > 0):
        raise SurfaceError(f"outliers: {threshold:g} is not a positive number of deviations")
    height = surface.height
    step = np.abs(height - median_filter(height, _NEIGHBOURHOOD, mode="reflect"))
    deviation = _SIGMA * float(np.median(step))
    # A surface most of whose pixels are the median of their neighbours has no scale of its own.
    out = step > threshold * deviation if deviation > 0 else np.zeros(height.shape, bool)
    count = int(np.count_nonzero(out))
    if count > _MOST * out.size:
        raise SurfaceError(
            f"outliers: {count / out.size:.0%} of the pixels differ from their neighbourhood by "
            f"more than {threshold:g} standard deviations; that many belong to the surface, so "
            "give a larger number, or leave it out"
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


def _um(low: float, high: float) -> str:
    return f"{1e6 * low:.4g} and {1e6 * high:.4g} um"
