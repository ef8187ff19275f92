"""What a figure shows, as data: one description for files (`static`) and pages (`interactive`).

Texts are plain texts; whoever draws them escapes what the drawing library would read as markup.
Numbers are in the units that the axes name. Colours are names that CSS and matplotlib share.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Colours = Literal["viridis", "cividis", "magma"]  # of maps, from low to high
Dash = tuple[float, ...]  # lengths of dashes and gaps by turns, in line widths

SOLID: Dash = ()
DASHED: Dash = (4, 2)
DOTTED: Dash = (1, 2)
DASH_DOTTED: Dash = (6, 2, 1, 2)

PALETTE = (
    "#1f77b4",
    "#ff7f0e",
    "#2ca02c",
    "#d62728",
    "#9467bd",
    "#8c564b",
    "#e377c2",
    "#7f7f7f",
    "#bcbd22",
    "#17becf",
)
BLUE, ORANGE = PALETTE[:2]
GREY = "#7d858e"  # of references: can be read on light and dark paper


@dataclass(frozen=True)
class Axis:
    """An axis: what it shows, in which unit, and from where to where (None: as the data ask)."""

    label: str
    unit: str = ""
    scale: Literal["linear", "log"] = "linear"
    low: float | None = None
    high: float | None = None

    @property
    def title(self) -> str:
        """Label and unit."""
        return f"{self.label} ({self.unit})" if self.unit else self.label


@dataclass(frozen=True, eq=False)
class Line:
    """A line through `y` at `x`; NaN interrupts it.

    Series of one figure with the same `label` share one entry of the legend; without a label there
    is none. `name` tells them apart where a page shows the value under the pointer. `step` draws
    one level for each `x`; `right` takes the scale of the right axis.
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
    """Markers at `x` and `y`, `joined` by a line, with bars of ± `error`.

    Markers are open where `open` is true; `open_label` and `error_label` are entries of the legend.
    """

    x: Array
    y: Array
    label: str = ""
    name: str = ""
    color: str = BLUE
    joined: bool = False
    error: Array | None = None
    error_label: str = ""
    open: NDArray[np.bool_] | None = None
    open_label: str = ""


@dataclass(frozen=True, eq=False)
class Band:
    """The area between `low` and `high`."""

    x: Array
    low: Array
    high: Array
    label: str = ""
    color: str = BLUE


@dataclass(frozen=True)
class Mark:
    """A dotted line across the figure where `axis` has `value`, with a text beside it."""

    axis: Literal["x", "y"]
    value: float
    text: str = ""
    subscript: str = ""
    side: Literal["left", "right"] = "right"


Series = Line | Points | Band | Mark


@dataclass(frozen=True)
class Chart:
    """Series on two axes, or three: lines with `right` take the one on the right."""

    x: Axis
    y: Axis
    series: Sequence[Series]
    title: str = ""
    right: Axis | None = None


@dataclass(frozen=True, eq=False)
class Map:
    """Values (nx, ny) on nodes at `x` and `y` (µm) as colours; NaN is left blank.

    `downwards`: y increases towards the foot of the map.
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
    """The texts of the legend of one panel, in the order of the series, each once."""
    if isinstance(panel, Map):
        return []
    found: dict[str, None] = {}
    for each in panel.series:
        if isinstance(each, Mark):
            continue
        found[each.label] = None
        if isinstance(each, Points):
            if has_open(each):
                found[each.open_label] = None
            if has_error(each):
                found[each.error_label] = None
    return [label for label in found if label]


def has_open(points: Points) -> bool:
    """Whether any marker is open."""
    return points.open is not None and bool(points.open.any())


def has_error(points: Points) -> bool:
    """Whether any point has a bar."""
    return points.error is not None and bool(np.isfinite(points.error).any())
