"""What results of older versions lack or define differently."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr

from restitution.results.schema import COLUMNS

LATER = frozenset({"pull_off_error_N", "adhesive_spacing_m"})
"""Columns that older tables lack; they are read as empty."""
REQUIRED = tuple(name for name in COLUMNS if name not in LATER)


def as_now(row: dict[str, Any]) -> dict[str, Any]:
    """Bring a row of an older table up to date."""
    if "adhesion_resolved" not in row:
        return row
    resolved = row["resolved"] and row["adhesion_resolved"]  # `resolved` left adhesion out
    missing = dict.fromkeys(LATER - row.keys(), math.nan)
    return row | missing | {"resolved": resolved}


def dataset_as_now(results: xr.Dataset) -> xr.Dataset:
    depths = results.sizes.get("indentation_max", 0)
    for column in (COLUMNS[name] for name in LATER if COLUMNS[name].variable not in results):
        results[column.variable] = column.labelled("indentation_max", np.full(depths, np.nan))
    if {"resolved", "adhesion_resolved"} <= set(results):
        results["resolved"] = results["resolved"] & results["adhesion_resolved"]
    return results
