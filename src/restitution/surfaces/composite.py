"""Composite roughness: two rough bodies are replaced by one rough and one smooth body."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

from restitution.arguments import typed
from restitution.errors import SurfaceError
from restitution.surfaces.surface import Surface, is_periodic

# For each provenance entry, the function that combines the values of the parts. The rms heights of
# the waves that were removed from the parts are added in quadrature. `removed_slope` is relative to
# the slope of the original surface, so the largest value of the parts is an upper bound.
_COMBINED: dict[str, Callable[[list[Any]], str | float]] = {
    "file": lambda files: ", ".join(map(str, files)),
    "y_axis": lambda axes: axes[0],  # direction in which y is drawn (`scan.Y_DOWN`)
    "pixel_x_m": max,
    "pixel_y_m": max,
    "shortest_carried_m": max,
    "removed_rms_m": lambda heights: math.hypot(*heights),
    "removed_slope": max,
}


@typed
def composite(surfaces: Sequence[Surface]) -> Surface:
    """Sum the heights of surfaces on one grid, each positive towards the other body.

    Args:
        surfaces: Surfaces on the same grid, with the x and y axes of the contact.

    Returns:
        Sum of the surfaces, with the provenance of each part; a single surface itself.

    Raises:
        SurfaceError: `surfaces` is empty, or the grids differ.
    """
    if not surfaces:
        raise SurfaceError("surfaces: the sequence is empty; give at least one surface")
    first = surfaces[0]
    if len(surfaces) == 1:
        return first
    if any(surface.grid != first.grid for surface in surfaces):
        raise SurfaceError("surfaces: are on different grids; place all of them on one grid")
    provenances = [surface.provenance for surface in surfaces]
    whole: dict[str, str | float] = {"source": "composite", "kind": f"sum of {len(surfaces)}"}
    for key, combine in _COMBINED.items():
        if values := [p[key] for p in provenances if key in p]:
            whole[key] = combine(values)
    if "refined" in provenances[0]:
        whole["refined"] = provenances[0]["refined"]  # the same for all parts
    if all(is_periodic(surface) for surface in surfaces):
        whole["periodicity"] = "periodic over the domain"
    if notices := [str(p["notice"]) for p in provenances if "notice" in p]:
        whole["notice"] = "; ".join(notices)
    for number, provenance in enumerate(provenances, 1):
        whole.update({f"part_{number}_{key}": value for key, value in provenance.items()})
    height = sum((surface.height for surface in surfaces[1:]), start=first.height)
    return Surface(height, first.grid, whole)
