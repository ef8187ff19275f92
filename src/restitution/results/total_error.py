"""The total error of COR in a row of results, combined from its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping


def total(row: Mapping[str, float]) -> float:
    """Root sum of squares of the known errors of a row.

    COR lies between 0 and 1, so its error cannot exceed the larger of COR and 1 − COR.
    """
    parts = ("restitution_error", "discretisation_error", "surface_scatter", "material_error")
    known = [error for name in parts if not math.isnan(error := row.get(name, math.nan))]
    return min(math.hypot(*known), max(row["restitution"], 1 - row["restitution"]))
