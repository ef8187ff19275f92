"""Stored numbers in words: names for people, and SI prefixes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

from restitution.case.labels import LABELS
from restitution.display import quantity
from restitution.pages.page import Cell, PageTable

_UNITS = {
    "_J_per_m2": "J/m²",
    "_m_per_s": "m/s",
    "_per_m": "1/m",
    "_Pa": "Pa",
    "_kg": "kg",
    "_rad": "rad",
    "_m2": "m²",
    "_m": "m",
    "_N": "N",
    "_J": "J",
    "_s": "s",
}
_LENGTHS = {"spacing"}  # keys of lengths without a suffix


def split_unit(key: str) -> tuple[str, str]:
    """Split a key with the suffix of a unit: "rms_height_m" gives "rms height" and "m"."""
    for suffix, unit in _UNITS.items():
        if key.endswith(suffix):
            return key.removesuffix(suffix).replace("_", " "), unit
    return key.replace("_", " "), "m" if key in _LENGTHS else ""


def label_of(key: str) -> str:
    return LABELS[key][0] if key in LABELS else split_unit(key)[0]


def value_of(key: str, value: Any) -> str:
    """A stored value in words; the suffix of its `key` states the unit."""
    unit = split_unit(key)[1]
    if value is None or (isinstance(value, float) and math.isnan(value)):
        return "–"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list):
        return (" × " if unit else ", ").join(value_of(key, one) for one in value) or "–"
    if isinstance(value, Mapping):
        inner = (f"{split_unit(k)[0]} {value_of(k, one)}" for k, one in value.items())
        return ", ".join(inner) or "none"
    if not isinstance(value, (int, float)):
        return str(value)
    if unit == "rad":
        return f"{math.degrees(value):.4g}°"
    if unit == "1/m":
        return f"1/({quantity(1 / value, 'm')})" if value else "0"
    if key == "expected_pull_off_error":
        return f"{100 * value:.3g} %"
    return quantity(value, unit) if unit else f"{value:.4g}"


def table_of(title: str, group: Mapping[str, Any]) -> PageTable:
    """A table of stored values with their names."""
    rows: list[list[Cell]] = [[label_of(key), value_of(key, value)] for key, value in group.items()]
    return PageTable(title, ["quantity", "value"], rows)


def si(value: float | None, unit: str) -> str:
    """A number with its unit and an SI prefix; "–" if it is unknown."""
    return "–" if value is None or math.isnan(value) else quantity(value, unit)


def share(value: float) -> str:
    """A fraction in percent; "–" if it is unknown."""
    return "–" if math.isnan(value) else f"{100 * value:.3g} %"


def e_in_words(e: float, error: float) -> str:
    """COR and its error to as many digits, "0.52 ± 0.02"; the last digit is at most the error."""
    if math.isnan(error):
        return f"{e:.2f} ± unknown"
    digits = 3 if error < 0.0095 else 2
    return f"{e:.{digits}f} ± {max(error, 10.0**-digits):.{digits}f}"


_PREFIXES = {-3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G"}


def column_unit(values: Iterable[float], unit: str) -> tuple[float, str]:
    """A factor from SI for a column of `values`, and their unit with the prefix of the largest."""
    largest = max((abs(v) for v in values if math.isfinite(v)), default=0.0)
    order = math.floor(math.log10(largest) / 3 + 1e-9) if largest else 0
    order = min(max(order, min(_PREFIXES)), max(_PREFIXES))
    return 10.0 ** (-3 * order), _PREFIXES[order] + unit
