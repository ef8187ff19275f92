"""Composite roughness: two rough bodies are replaced by one rough and one smooth body."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from restitution.errors import SurfaceError
from restitution.surfaces.surface import Surface, is_periodic


def composite(surfaces: Sequence[Surface]) -> Surface:
    """Add the heights of surfaces to one surface.

    The gap between rough bodies depends only on the sum of their heights.

    Positive heights of each surface point towards the other body, and all surfaces share the axes
    of the contact. If the relative orientation of two scans matters, rotate or mirror one of them
    first.

    The provenance of the sum contains the provenance of each part, with the prefixes `part_1_`,
    `part_2_`, … It also states the files, the largest pixel size, the waves that are too short for
    the grid, and whether all parts are periodic.

    Args:
        surfaces: Surfaces on one grid.

    Returns:
        Sum of the surfaces; the surface itself if there is only one.

    Raises:
        SurfaceError: `surfaces` is empty, or the grids differ.
    """
    if not surfaces:
        raise SurfaceError("surfaces: is empty; give at least one surface")
    first = surfaces[0]
    if len(surfaces) == 1:
        return first
    if any(surface.grid != first.grid for surface in surfaces):
        raise SurfaceError("surfaces: are on different grids; place all of them on one grid")
    provenances = [surface.provenance for surface in surfaces]
    whole: dict[str, str | float] = {"source": "composite", "kind": f"sum of {len(surfaces)}"}
    files = [str(p["file"]) for p in provenances if "file" in p]
    if files:
        whole["file"] = ", ".join(files)
    for axis in "xy":
        pixels = [float(p[f"pixel_{axis}_m"]) for p in provenances if f"pixel_{axis}_m" in p]
        if pixels:
            whole[f"pixel_{axis}_m"] = max(pixels)
    if "refined" in provenances[0]:
        whole["refined"] = provenances[0]["refined"]  # the same for all parts
    whole.update(_removed(provenances))
    if all(is_periodic(surface) for surface in surfaces):
        whole["periodicity"] = "periodic over the domain"
    notices = [str(p["notice"]) for p in provenances if "notice" in p]
    if notices:
        whole["notice"] = "; ".join(notices)
    for number, provenance in enumerate(provenances, 1):
        whole.update({f"part_{number}_{key}": value for key, value in provenance.items()})
    height = sum((surface.height for surface in surfaces[1:]), start=first.height)
    return Surface(height, first.grid, whole)


def _removed(provenances: Sequence[Mapping[str, str | float]]) -> dict[str, float]:
    """Return the provenance entries on the waves that are too short for the grid.

    The rms heights of the parts are added in quadrature. Each other entry is the largest value of
    all parts.
    """
    known = [p for p in provenances if "removed_slope" in p]
    if not known:
        return {}

    def values(key: str) -> list[float]:
        return [float(p[key]) for p in known]

    return {
        "shortest_carried_m": max(values("shortest_carried_m")),
        "removed_rms_m": math.hypot(*values("removed_rms_m")),
        "removed_slope": max(values("removed_slope")),
    }
