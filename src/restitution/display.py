"""Short descriptions of objects: the text of `repr`, and HTML for notebooks.

A class with such a description defines the method `_summary`, which returns at most three lines
without arrays. The class assigns `summary_text` to `__repr__` and `summary_html` to `_repr_html_`.
"""

from __future__ import annotations

import html
import math
import re
from collections.abc import Iterable, Sequence
from typing import Protocol

_NUMBER = re.compile(r"\d+(\.\d+)?(e[-+]?\d+)?")
_PREFIXES = {-5: "f", -4: "p", -3: "n", -2: "µ", -1: "m", 0: "", 1: "k", 2: "M", 3: "G", 4: "T"}


class _Summarised(Protocol):
    def _summary(self) -> Sequence[str]: ...


def summary_text(self: _Summarised) -> str:
    """Return the class name and the lines of `_summary`; lines after the first are indented."""
    return f"{type(self).__name__}: " + "\n  ".join(self._summary())


def summary_html(self: _Summarised) -> str:
    """Return the class name and the lines of `_summary` as HTML."""
    lines = "<br>".join(map(html.escape, self._summary()))
    return f"<div><b>{type(self).__name__}</b>: {lines}</div>"


def quantity(value: float | None, unit: str) -> str:
    """Format an SI value with four digits and a suitable prefix: 2.5e-4, "m" gives "250 µm"."""
    if value is None or math.isnan(value):
        return "unknown"
    if value == 0 or math.isinf(value):
        return f"{value:g} {unit}".replace("inf", "∞")
    if unit == "kg":
        value, unit = 1e3 * value, "g"
    step = 6 if unit == "m²" else 3  # prefixes of areas are squared: 1 µm² = 1e-12 m²
    rounded = float(f"{value:.4g}")
    order = math.floor(math.log10(abs(rounded)) / step + 1e-12)
    smallest = -3 if unit == "m" else min(_PREFIXES)  # 0.3 nm, not 300 pm
    order = max(smallest, min(max(_PREFIXES), order))
    return f"{value / 10.0 ** (step * order):.4g} {_PREFIXES[order]}{unit}"


def with_error(value: float, error: float, unit: str) -> str:
    """Format a value with its error to two digits, and one prefix: "91.6 ± 4.8 mm/s"."""
    if not (math.isfinite(error) and error > 0 and value != 0):
        return quantity(value, unit) + (" ± unknown" if math.isnan(error) else "")
    number, prefixed = quantity(value, unit).split()
    scale = value / float(number)
    digits = 1 - math.floor(math.log10(error / scale))
    digits = max(digits, 0)
    return f"{value / scale:.{digits}f} ± {error / scale:.{digits}f} {prefixed}"


def duration(seconds: float) -> str:
    """Format a time for people: "20 s", "3 min", "5 h"."""
    if seconds < 100:
        return f"{max(seconds, 1.0):.0f} s"
    return f"{seconds / 60:.0f} min" if seconds < 6000 else f"{seconds / 3600:.0f} h"


def counted(number: int, noun: str) -> str:
    """Format a number with its noun, in the singular or plural: "1 warning", "2 warnings"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def without_numbers(text: str) -> str:
    """Replace each number in `text` by #. Texts that differ only in numbers become equal."""
    return _NUMBER.sub("#", text)


def some_of(names: Iterable[str], most: int = 6) -> str:
    """Join the first `most` distinct names with commas; add, for example, "and 3 more"."""
    distinct = list(dict.fromkeys(filter(None, names)))
    more = f" and {len(distinct) - most} more" if len(distinct) > most else ""
    return ", ".join(distinct[:most]) + more
