"""The content of a figure as data. `static` draws it in files, `interactive` on pages.

Texts contain no markup; the module that draws them escapes special characters. Numbers are in the
units of the axes. Colours are written so that both CSS and matplotlib understand them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Colours = Literal["viridis", "cividis", "magma"]  # colour maps, from low to high values
Dash = tuple[float, ...]  # alternating lengths of dashes and gaps, in line widths
Symbol = Literal["circle", "square", "diamond", "triangle-up", "triangle-down"]

SOLID: Dash = ()
DASHED: Dash = (4, 2)
DOTTED: Dash = (1, 2)
DASH_DOTTED: Dash = (6, 2, 1, 2)

# Colours after Okabe and Ito (2008), whose contrast with a white and with a dark page is at least
# 3:1, as WCAG 2.2, 1.4.11, requires.
PALETTE = ("#2080c8", "#d55e00", "#009e73", "#c8609a", "#b37d00", "#8a70d6")
# Symbols distinguish series that share a colour. In print without colours, they distinguish all.
SYMBOLS: tuple[Symbol, ...] = ("circle", "square", "diamond", "triangle-up", "triangle-down")
BLUE, ORANGE = PALETTE[:2]
GREY = "#7d858e"  # colour of reference curves, legible on light and dark pages


@dataclass(frozen=True)
class Axis:
    """An axis: its quantity, unit, scale and ends. An end that is None is chosen from the data."""

    label: str
    unit: str = ""
    scale: Literal["linear", "log"] = "linear"
    low: float | None = None
    high: float | None = None

    @property
    def title(self) -> str:
        """The label, with the unit in brackets."""
        return f"{self.label} ({self.unit})" if self.unit else self.label


@dataclass(frozen=True, eq=False)
class Line:
    """A line through the points (`x`, `y`), interrupted where a value is NaN.

    Series of one figure with the same `label` share one entry of the legend; a series without a
    label has no entry. A page shows `name` beside the value under the pointer. With `step`, the
    line is a staircase with one level for each `x`. With `right`, the line belongs to the axis
    on the right.
    """

    x: Array
    y: Array
    label: str = ""
    name: str = ""
    color: str = BLUE
    dash: Dash = SOLID
    width: float = 1.2
    step: bool = False
    right: bool = False


@dataclass(frozen=True, eq=False)
class Points:
    """Markers at `x` and `y` with error bars; if `joined`, a line connects the markers.

    `error` has shape (n,) for symmetric bars, or (2, n) for the lengths below and above. Markers
    are open where `open` is true. In the legend, `open_label` stands beside an open marker, and
    `error_label` beside an error bar. The connecting line also passes through the points `via`
    (x and y), in the order of x.
    """

    x: Array
    y: Array
    label: str = ""
    name: str = ""
    color: str = BLUE
    symbol: Symbol = "circle"
    joined: bool = False
    error: Array | None = None
    error_label: str = ""
    open: NDArray[np.bool_] | None = None
    open_label: str = ""
    via: tuple[Array, Array] | None = None

    def line(self) -> tuple[Array, Array]:
        """x and y of the connecting line."""
        if self.via is None:
            return np.asarray(self.x), np.asarray(self.y)
        x, y = (np.append(own, more) for own, more in zip((self.x, self.y), self.via, strict=True))
        order = np.argsort(x, kind="stable")
        return x[order], y[order]


@dataclass(frozen=True, eq=False)
class Band:
    """The area between `low` and `high`, with edges in the style of `dash`."""

    x: Array
    low: Array
    high: Array
    label: str = ""
    color: str = BLUE
    dash: Dash = SOLID


@dataclass(frozen=True)
class Mark:
    """A dotted line across the chart at `value` on `axis`, with a text beside it."""

    axis: Literal["x", "y"]
    value: float
    text: str = ""
    subscript: str = ""
    side: Literal["left", "right"] = "right"


Series = Line | Points | Band | Mark


@dataclass(frozen=True)
class Chart:
    """Series on the axes `x` and `y`; lines with `right` use a second y axis on the right."""

    x: Axis
    y: Axis
    series: Sequence[Series]
    title: str = ""
    right: Axis | None = None


@dataclass(frozen=True, eq=False)
class Map:
    """Values, shape (nx, ny), at the nodes `x` and `y` (µm), drawn as colours; NaN is left blank.

    With `downwards`, y increases towards the bottom of the map.
    """

    x: Array
    y: Array
    values: Array
    quantity: Axis
    colours: Colours = "viridis"
    title: str = ""
    downwards: bool = False


@dataclass(frozen=True)
class Figure:
    """Charts and maps side by side, under one title."""

    title: str
    panels: Sequence[Chart | Map] = field(default_factory=tuple)
    legend_title: str = ""


def legend_entries(panel: Chart | Map) -> list[str]:
    """The legend texts of one panel, in the order of the series, without repetition."""
    if isinstance(panel, Map):
        return []
    labels = []
    for series in panel.series:
        if not isinstance(series, Mark):
            labels.append(series.label)
        if isinstance(series, Points):
            labels.append(series.open_label if has_open(series) else "")
            labels.append(series.error_label if has_error(series) else "")
    return [label for label in dict.fromkeys(labels) if label]


def has_open(points: Points) -> bool:
    return points.open is not None and bool(points.open.any())


def has_error(points: Points) -> bool:
    return points.error is not None and bool(np.isfinite(points.error).any())
