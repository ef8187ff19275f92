"""Figures as files (PNG, SVG, PDF), drawn by matplotlib."""

from __future__ import annotations

import math
import textwrap
import warnings
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Literal

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure as Drawing
from matplotlib.lines import Line2D
from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter, ScalarFormatter

from restitution.plots.figure import (
    Array,
    Band,
    Chart,
    Figure,
    Line,
    Map,
    Mark,
    Points,
    Series,
    has_error,
    has_open,
    legend_entries,
)
from restitution.plots.figure import Axis as Described
from restitution.plots.ticks import LINEAR, Labels, digits_within, label, labels_of, power
from restitution.results.writer import replace_file

Format = Literal["png", "svg", "pdf"]

# Sizes (inches): width and height of a chart, width and height of a map, width of a further panel.
_CHART, _MAP, _SECOND = (6.4, 4.0), (5.6, 4.6), 4.6
# Sizes (inches): height of a row of the legend, width of a legend at the side.
_ROW, _SIDE = 0.2, 2.4
# Largest number of entries of a legend below the axes; a longer legend is placed at the side.
_MOST_BELOW = 8
_DPI = 300  # of PNG files, for print
_TICKS = 6  # largest number of intervals between the labels of a linear axis
_MARKERS = {
    "circle": "o",
    "square": "s",
    "diamond": "D",
    "triangle-up": "^",
    "triangle-down": "v",
}
_DATELESS: dict[Format, dict[str, Any]] = {
    "png": {},
    "svg": {"Date": None},
    "pdf": {"CreationDate": None},
}


def write_figures(
    out: Path, figures: Iterable[tuple[str, Figure]], file_format: Format = "png"
) -> list[Path]:
    return [write_figure(out / name, figure, file_format) for name, figure in figures]


def write_figure(path: Path, figure: Figure, file_format: Format = "png") -> Path:
    """Write `figure` atomically to a file, and return the path of this file.

    The file is named `path` plus the suffix of the format, for example ".png". The same figure
    gives the same bytes. Raises `OutputError` if the file cannot be written.
    """
    drawing, to_write = draw(figure), path.with_name(f"{path.name}.{file_format}")
    with warnings.catch_warnings(), matplotlib.rc_context({"svg.hashsalt": path.name}):
        matplotlib.rcParams["pdf.fonttype"] = 42  # embed TrueType fonts, as journals require

        # If the font lacks characters of a title, matplotlib draws boxes and warns.
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        replace_file(
            to_write,
            lambda to: drawing.savefig(
                to, format=file_format, dpi=_DPI, metadata=_DATELESS[file_format]
            ),
        )
    return to_write


def draw(figure: Figure) -> Drawing:
    """Draw `figure` in matplotlib, with one legend for all panels."""
    labels = list(dict.fromkeys(e for panel in figure.panels for e in legend_entries(panel)))
    columns, right_of_charts = 2 * len(figure.panels), len(labels) > _MOST_BELOW
    sizes = [_MAP if isinstance(panel, Map) else _CHART for panel in figure.panels]
    width, height = sizes[0][0] + _SECOND * (len(sizes) - 1), max(size[1] for size in sizes)
    if right_of_charts:
        width, height = width + _SIDE, max(height, _ROW * len(labels))
    else:
        height += _ROW * math.ceil(len(labels) / columns)
    drawing = Drawing(figsize=(width, height), layout="constrained")
    FigureCanvasAgg(drawing)
    handles: dict[str, Any] = {}
    for axes, panel in zip(
        drawing.subplots(1, len(figure.panels), squeeze=False)[0], figure.panels, strict=True
    ):
        if isinstance(panel, Map):
            _draw_map(drawing, axes, panel)
        else:
            _draw_chart(axes, panel, handles)
        axes.set_title(_plain(panel.title), fontsize="medium")
    if figure.title:
        drawing.suptitle(_plain(figure.title))
    if labels:
        drawing.legend(
            [handles[label] for label in labels],
            [_escaped(label) for label in labels],
            frameon=False,
            fontsize="small",
            title=figure.legend_title or None,
            handlelength=3.0,
            alignment="left",
            loc="outside right center" if right_of_charts else "outside lower center",
            ncols=1 if right_of_charts else columns,
        )
    return drawing


def _draw_chart(axes: Axes, chart: Chart, handles: dict[str, Any]) -> None:
    right = axes.twinx() if chart.right is not None else axes
    for part in chart.series:
        _draw_series(right if isinstance(part, Line) and part.right else axes, part, handles)
    x, y = chart.x, chart.y
    axes.set(xlabel=_escaped(x.title), xscale=x.scale, xlim=(x.low, x.high))
    axes.set(ylabel=_escaped(y.title), yscale=y.scale, ylim=(y.low, y.high))
    for axis, described in ((axes.xaxis, x), (axes.yaxis, y)):
        if described.scale == "log":
            _set_log_ticks(axis, described)
        else:
            _set_linear_ticks(axis, described)
    if chart.right is not None:
        y = chart.right
        right.set(ylabel=_escaped(y.title), yscale=y.scale, ylim=(y.low, y.high))


def _set_linear_ticks(axis: Axis, described: Described) -> None:
    axis.set_major_locator(MaxNLocator(_TICKS, steps=(1, 2, 5, 10)))
    if labels_of(described, *axis.get_view_interval()) == "prefixes":
        unit = described.unit
        axis.set_major_formatter(FuncFormatter(lambda value, _: label(value, "prefixes", unit)))
        return
    formatter = ScalarFormatter(useMathText=True)
    formatter.set_powerlimits((-3, 4))
    axis.set_major_formatter(formatter)


def _set_log_ticks(axis: Axis, described: Described) -> None:
    """Label the powers of ten and, if the axis spans few decades, some values between them."""
    low, high = axis.get_view_interval()
    decades = math.log10(high / low) if low > 0 else math.inf
    axis.set_minor_formatter(NullFormatter())
    if decades < LINEAR:
        axis.set_major_locator(MaxNLocator(_TICKS, steps=(1, 2, 5, 10)))
    elif len(digits := digits_within(decades)) > 1:
        axis.set_major_locator(LogLocator(subs=digits, numticks=100))
    labels, unit = labels_of(described, low, high), described.unit
    axis.set_major_formatter(FuncFormatter(lambda value, _: _number(value, labels, unit)))


def _number(value: float, labels: Labels, unit: str) -> str:
    if labels != "powers" or value <= 0:
        return label(value, labels, unit)
    exponent, digits = power(value)
    return rf"$10^{{{exponent}}}$" if digits == "1" else rf"${digits}\times10^{{{exponent}}}$"


def _draw_series(axes: Axes, part: Series, handles: dict[str, Any]) -> None:
    if isinstance(part, Mark):
        _draw_mark(axes, part)
    elif isinstance(part, Band):
        band = axes.fill_between(
            part.x,
            part.low,
            part.high,
            facecolor=(part.color, 0.2),
            edgecolor=part.color,
            lw=0.8,
            ls=(0, part.dash) if part.dash else "-",
        )
        handles.setdefault(part.label, band)
    elif isinstance(part, Line):
        (line,) = axes.plot(
            part.x,
            part.y,
            color=part.color,
            lw=part.width,
            ls=(0, part.dash) if part.dash else "-",
            marker="o" if np.size(part.x) == 1 else "",
            drawstyle="steps-mid" if part.step else "default",
        )
        handles.setdefault(part.label, line)
    else:
        _draw_points(axes, part, handles)


def _draw_points(axes: Axes, points: Points, handles: dict[str, Any]) -> None:
    x, y, color = np.asarray(points.x), np.asarray(points.y), points.color
    if has_error(points):
        bars = axes.errorbar(
            x, y, yerr=points.error, fmt="none", ecolor=color, elinewidth=1, capsize=2, zorder=2.5
        )
        handles.setdefault(points.error_label, bars)
    if points.joined:
        axes.plot(*points.line(), "-", color=color, lw=1)
    hollow = np.zeros(x.shape, bool) if points.open is None else points.open
    marker = _MARKERS[points.symbol]
    style: dict[str, Any] = {"ls": "none", "marker": marker, "ms": 4.5, "color": color, "zorder": 3}
    axes.plot(x[~hollow], y[~hollow], **style)
    face = "white" if hollow.all() else color
    entry = Line2D(
        [], [], **{**style, "ls": "-" if points.joined else "none", "lw": 1, "mfc": face}
    )
    handles.setdefault(points.label, entry)
    if has_open(points):
        (empty,) = axes.plot(x[hollow], y[hollow], mfc="white", **style)
        handles.setdefault(points.open_label, empty)


def _draw_mark(axes: Axes, mark: Mark) -> None:
    text = f"${mark.text}_{mark.subscript}$" if mark.subscript else _escaped(mark.text)
    style: dict[str, Any] = {"color": "0.45", "lw": 0.9, "ls": ":", "zorder": 0}
    sign = 1 if mark.side == "right" else -1
    if mark.axis == "x":
        axes.axvline(mark.value, **style)
        # Place the text beside the line, near its lower end.
        where, shift, transform = (mark.value, 0.03), (4 * sign, 0), axes.get_xaxis_transform()
    else:
        axes.axhline(mark.value, **style)
        end = 1.0 if sign > 0 else 0.0
        where, shift, transform = (end, mark.value), (-4 * sign, 2), axes.get_yaxis_transform()
    if text:
        axes.annotate(
            text,
            where,
            xycoords=transform,
            xytext=shift,
            textcoords="offset points",
            ha="left" if shift[0] > 0 else "right",
            va="bottom",
            color="0.3",
            fontsize="small",
            zorder=7,
            bbox={"fc": "white", "ec": "none", "pad": 0.8, "alpha": 0.8},
        )


def _draw_map(drawing: Drawing, axes: Axes, part: Map) -> None:
    hx, hy = _cell(part.x), _cell(part.y)
    extent = (part.x[0] - hx / 2, part.x[-1] + hx / 2, part.y[0] - hy / 2, part.y[-1] + hy / 2)
    image = axes.imshow(
        part.values.T, origin="lower", extent=extent, cmap=part.colours, interpolation="nearest"
    )
    axes.set(xlabel="x (µm)", ylabel="y (µm)")
    if part.downwards:
        axes.invert_yaxis()
    bar = axes.inset_axes((1.03, 0.0, 0.05, 1.0))  # a colour bar as high as the map
    drawing.colorbar(image, cax=bar, label=_escaped(part.quantity.title))


def _cell(centres: Array) -> float:
    return float(centres[1] - centres[0]) if centres.size > 1 else 1.0


def _plain(text: str) -> str:
    """Wrap `text` to a title of at most two lines, in which $ does not begin a formula."""
    whole = text.replace(" %", "\N{NO-BREAK SPACE}%")
    return _escaped("\n".join(textwrap.wrap(whole, 55, max_lines=2, placeholder=" …")))


def _escaped(text: str) -> str:
    """Escape $, which would otherwise begin a formula."""
    return text.replace("$", r"\$")
