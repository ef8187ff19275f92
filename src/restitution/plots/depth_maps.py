"""Maps of the contact pressure at several depths, side by side."""

from __future__ import annotations

import numpy as np
import xarray as xr

from restitution.display import quantity
from restitution.plots.figure import Axis, Figure, Map

_SHOWN = 4  # number of depths that are drawn
_RIM = 4  # number of nodes between the contact and each edge of its map


def depth_maps_figure(maps: xr.Dataset, title: str, *, downwards: bool = False) -> Figure:
    """Draw the pressure at up to four depths of `maps` (from `maps.nc`), on one part of the grid.

    `downwards` says whether y increases towards the bottom.
    """
    pressure = maps["pressure"]
    along = str(pressure.dims[0])
    touched = np.argwhere(pressure.values.any(axis=0))
    if not touched.size:
        return Figure(title, [])
    low, high = np.maximum(touched.min(axis=0) - _RIM, 0), touched.max(axis=0) + _RIM + 1
    x, y = (slice(*ends) for ends in zip(low, high, strict=True))
    X, Y = 1e6 * maps["x"].values[x], 1e6 * maps["y"].values[y]
    count = maps.sizes[along]
    panels = []
    for number in np.unique(np.linspace(0, count - 1, _SHOWN).round().astype(int)):
        values = 1e-6 * pressure.values[number, x, y]
        depth = quantity(float(maps[along][number]), "m")
        shown = np.where(values != 0, values, np.nan)
        axis = Axis("pressure", "MPa")
        panels.append(Map(X, Y, shown, axis, title=f"at {depth}", downwards=downwards))
    return Figure(title, panels)
