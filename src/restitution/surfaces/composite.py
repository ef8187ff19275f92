"""Two rough bodies seen as one rough and one smooth body: the sum of their heights."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from restitution.errors import SurfaceError
from restitution.surfaces.surface import Surface, is_periodic


def composite(surfaces: Sequence[Surface]) -> Surface:
    """The sum of the heights of `surfaces`, all on one grid: the gap they leave is that of both.

    Both surfaces are taken with their summits up and with the axes of the contact: where the
    orientation of two scans to each other matters, one is to be handed over turned or mirrored.
    The provenance holds that of the parts, numbered from 1, and of the whole what the rest of the
    program asks for: the files, the coarsest pixel, what the grid does not carry and whether all
    are periodic. Raises `SurfaceError` for none and for different grids.
    """
    if not surfaces:
        raise SurfaceError("composite: there is no surface to add; give at least one")
    first = surfaces[0]
    if len(surfaces) == 1:
        return first
    if any(surface.grid != first.grid for surface in surfaces):
        raise SurfaceError("composite: the surfaces are on different grids; place them on one")
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
        whole["refined"] = provenances[0]["refined"]  # of all parts, as they are on one grid
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
    """What the grid does not carry of the parts: the worst of them, and the rms of all."""
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
