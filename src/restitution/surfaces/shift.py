"""Move a scan so that the particle touches it at another place."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.surfaces.surface import Surface, noted

# Steps along x and y of an additive recurrence with low discrepancy: for any N, its first N points
# fill a square evenly. The steps are 1/ρ and 1/ρ², where ρ is the plastic number (ρ³ = ρ + 1).
_STEPS = 1 / 1.324717957244746, 1 / 1.324717957244746**2


def place_of(surface: Surface, number: int) -> Surface:
    """Move `surface`, continued by mirror images, to a point of a fixed sequence.

    Point 0 is the middle itself. The first N points fill the surface evenly.
    """
    if number == 0:
        return surface
    cells = [
        round((math.fmod(number * step + 0.5, 1.0) - 0.5) * n)
        for step, n in zip(_STEPS, surface.grid.nodes, strict=True)
    ]
    height = surface.height
    for cell in cells:
        n = height.shape[0]
        height = np.roll(np.concatenate([height, height[::-1]]), -cell, axis=0)[:n].T
    x, y = (cell * h for cell, h in zip(cells, surface.grid.spacing, strict=True))
    moved = {"place": number, "place_x_m": float(x), "place_y_m": float(y)}
    return replace(surface, height=height, provenance={**surface.provenance, **moved})


def note_mirrored_part(surface: Surface) -> Surface:
    """Add a `notice` if part of a moved and placed `surface` is a mirror image."""
    origin = surface.provenance
    if not origin.get("place") or "extension" in origin:
        return surface
    measured = 1.0
    for axis, edge in zip("xy", surface.grid.size, strict=True):
        scan, moved = float(origin[f"size_{axis}_m"]), abs(float(origin[f"place_{axis}_m"]))
        measured *= min(1.0, (0.5 * scan - moved) / edge + 0.5)
    if measured > 1 - 1e-6:
        return surface
    notice = (
        f"{origin.get('file', 'the scan')}: place {origin['place']} is near an edge of the scan, "
        f"so the mirror image of the scan covers {1 - measured:.0%} of the grid; a smaller grid "
        "avoids this"
    )
    return replace(surface, provenance=noted(origin, notice))
