"""How the ticks of an axis are labelled, in files and on pages."""

from __future__ import annotations

import math
from typing import Literal

from restitution.display import quantity
from restitution.plots.figure import Axis

Labels = Literal["plain", "prefixes", "powers"]
"""0.002, 0.005, 0.01; 1 µN, 10 µN, 100 µN; or powers of ten."""

LINEAR = 0.5
"""A logarithmic axis that spans fewer decades has linear ticks."""

# Pairs (decades, digits). If a logarithmic axis spans at most `decades` decades, it has labels at
# `digits` times powers of ten.
_DIGITS: tuple[tuple[float, tuple[int, ...]], ...] = ((1.0, (1, 2, 3, 5, 7)), (3.0, (1, 2, 5)))
_PREFIXED = ("m/s", "N", "m", "Pa", "J")  # units that take an SI prefix
_PLAIN = (0.9e-3, 1e4)  # a logarithmic axis within this range has plain numbers
_LARGEST = (1e-2, 1e4)  # and a linear one whose largest number is within this range


def labels_of(axis: Axis, low: float, high: float) -> Labels:
    """The labels of an axis that spans `low` to `high`."""
    if axis.scale == "log":
        plain = _PLAIN[0] <= low and high <= _PLAIN[1]
    else:
        plain = _LARGEST[0] <= max(abs(low), abs(high)) <= _LARGEST[1]
    if plain:
        return "plain"
    return "prefixes" if axis.unit in _PREFIXED else "powers"


def digits_within(decades: float) -> tuple[int, ...]:
    """The digits that labels of a logarithmic axis of this length begin with."""
    return next((digits for most, digits in _DIGITS if decades <= most), (1,))


def label(value: float, labels: Labels, unit: str) -> str:
    """The label of one tick with `labels` other than "powers"."""
    if labels == "prefixes" and value:
        return quantity(value, unit)
    return f"{value:g}"


def power(value: float) -> tuple[int, str]:
    """The exponent of ten of a positive number, and the digits before it."""
    exponent = math.floor(math.log10(value) + 1e-9)
    return exponent, f"{value / 10**exponent:.3g}"
