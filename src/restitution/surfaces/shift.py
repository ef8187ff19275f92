"""Move a scan so that the particle touches it at another place."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.surfaces.surface import Surface, is_periodic

# Steps along x and y of an additive recurrence with low discrepancy: for any N, its first N points
# fill a square evenly. The steps are 1/ρ and 1/ρ², where ρ is the plastic number (ρ³ = ρ + 1).
_STEPS = 1 / 1.324717957244746, 1 / 1.324717957244746**2


def place_of(surface: Surface, number: int) -> Surface:
    """Move `surface` so that point `number` of a fixed sequence is in the middle.

    Point 0 is the middle itself. For any N, the first N points of the sequence fill the surface
    evenly. A periodic surface is continued periodically beyond its edges, and any other surface by
    its mirror image.
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
        period = height if is_periodic(surface) else np.concatenate([height, height[::-1]])
        height = np.roll(period, -cell, axis=0)[:n].T
    x, y = (cell * h for cell, h in zip(cells, surface.grid.spacing, strict=True))
    moved = {"place": number, "place_x_m": float(x), "place_y_m": float(y)}
    return replace(surface, height=height, provenance={**surface.provenance, **moved})
