"""The total error of COR in a row of results, combined from its parts."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

PARTS = ("restitution_error", "discretisation_error", "surface_scatter", "material_error")


def total(row: Mapping[str, float]) -> float:
    """Root sum of squares of the known errors of a row.

    COR lies between 0 and 1, so its error cannot exceed the larger of COR and 1 − COR.
    """
    known = [error for name in PARTS if not math.isnan(error := row.get(name, math.nan))]
    return min(math.hypot(*known), max(row["restitution"], 1 - row["restitution"]))


def largest(rows: Sequence[Mapping[str, float]], name: str) -> float | None:
    """Largest value of the column `name`; None if no row has one."""
    return max((row[name] for row in rows if not math.isnan(row[name])), default=None)


def largest_part(rows: Sequence[Mapping[str, float]]) -> str:
    """Name of the part of the total error with the largest root mean square over the rows.

    Rows without a total error are ignored. A missing part counts as zero.
    """
    known = [row for row in rows if not math.isnan(row["total_error"])]

    def squares(name: str) -> float:
        errors = (row.get(name, math.nan) for row in known)
        return sum(error**2 for error in errors if not math.isnan(error))

    return max(PARTS, key=squares)
