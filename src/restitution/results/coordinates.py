"""Coordinates of stored results, by which xarray selects and draws."""

from __future__ import annotations

import numpy as np
import xarray as xr

# For each dimension, the variable whose values become its index.
_INDEX = {
    "indentation_max": "indentation",
    "depth": "indentation",
    "unloading": "unloading_from",
    "smooth": "smooth_indentation",
}
# Coordinates without an index; they may be NaN, and depend on several dimensions.
_OTHERS = (
    "impact_velocity",
    "smooth_impact_velocity",
    "nominal_pressure",
    "unloading_indentation",
    "binned_pressure",
)


def with_coordinates(results: xr.Dataset) -> xr.Dataset:
    """Make depth, velocity, nominal pressure and the points of unloading curves coordinates.

    A dimension whose variable is missing, or depends on other dimensions, stays without an index.
    """
    index = {
        dimension: (dimension, results[name].values, results[name].attrs)
        for dimension, name in _INDEX.items()
        if name in results and results[name].dims == (dimension,)
    }
    if "unloading_step" in results.sizes:
        steps = np.arange(results.sizes["unloading_step"])
        words = {"units": "1", "long_name": "point of the unloading curve, from the deepest"}
        index["unloading_step"] = ("unloading_step", steps, words)
    others = [name for name in _OTHERS if name in results]
    if "indentation" in results and results["indentation"].ndim > 1:  # a study
        others.append("indentation")
    return results.assign_coords(index).set_coords(others)
