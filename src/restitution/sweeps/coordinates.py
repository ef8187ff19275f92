"""Convert the swept values of a study to coordinates of `study.nc`, in SI units."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

from restitution.case.quantities import read_quantity

# Units of quantities in a case file, and the same units in the notation of netCDF.
_UNITS = {
    "m": "m",
    "Pa": "Pa",
    "kg/m^3": "kg m-3",
    "N": "N",
    "J/m^2": "J m-2",
    "m/s": "m s-1",
    "rad": "rad",
    "rad/s": "rad s-1",
}
AS_WRITTEN = "as_written"
"""Name of the attribute with the values as written in the study file (a JSON list of texts)."""


def as_text(value: Any) -> str:
    """Format a swept value as written in the study file: "0.1 um", 3, true, [1, 2]."""
    if isinstance(value, str):
        return value
    return json.dumps(value, ensure_ascii=False, default=str)


def coordinate(values: Sequence[Any]) -> tuple[list[Any], dict[str, str]]:
    """Convert the values of a swept key to a coordinate; return its values and attributes.

    Quantities of one kind ("0.1 um") become numbers in SI units, with the attribute `units`.
    Numbers stay numbers. All other values become text as written in the study file.
    """
    texts = [as_text(value) for value in values]
    attributes = {AS_WRITTEN: json.dumps(texts, ensure_ascii=False)}
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return list(values), attributes
    for unit, written in _UNITS.items():
        try:
            return [read_quantity(value, unit) for value in values], {
                "units": written,
                **attributes,
            }
        except ValueError:
            continue
    return texts, attributes
