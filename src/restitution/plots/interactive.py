"""Panels of figures for pages, drawn by Plotly, which lets readers zoom and read values."""

from __future__ import annotations

import math
from typing import Any, Literal

import numpy as np
from plotly.graph_objects import Figure as Plot

from restitution.plots.figure import (
    BLUE,
    GREY,
    Array,
    Axis,
    Band,
    Chart,
    Dash,
    Figure,
    Line,
    Map,
    Mark,
    Points,
    has_error,
    has_open,
    legend_entries,
)
from restitution.plots.ticks import LINEAR, Labels, digits_within, label, labels_of, power

_MOST_PIXELS = 320  # largest number of pixels of a map along each axis; a larger map is thinned
# Kept are: zoom, pan, the whole figure again, and an image file.
_BUTTONS = {"remove": ["lasso2d", "select2d", "zoomIn2d", "zoomOut2d", "autoScale2d"]}
_TICKS = 7  # largest number of labels of an axis
_LAYERS = (Band, Line, Points)  # drawing order of the series, from bottom to top


_NO_TEMPLATE = {"data": {"scatter": [{"type": "scatter"}]}}


def draw(panel: Chart | Map, figure: Figure) -> Plot:
    """Draw one panel of `figure` without titles, because the page shows the titles."""
    return Plot(**contents(panel, figure))


def contents(panel: Chart | Map, figure: Figure) -> dict[str, Any]:
    """The `data` and the `layout` of a panel; `draw` checks them, which takes 4 times as long."""
    layout: dict[str, Any] = {
        "template": _NO_TEMPLATE,
        "paper_bgcolor": "rgba(0,0,0,0)",
        "plot_bgcolor": "rgba(0,0,0,0)",
        "margin": {"l": 70, "r": 20, "t": 28, "b": 60},
        "legend": {
            "orientation": "h",
            "y": -0.28,
            "yanchor": "top",
            "title": {"text": _escaped(figure.legend_title), "side": "top"},
            "tracegroupgap": 0,
        },
        "font": {"family": "system-ui, sans-serif", "size": 13},
        "hovermode": "closest",
        "modebar": _BUTTONS | {"bgcolor": "rgba(0,0,0,0)", "color": GREY, "activecolor": BLUE},
    }
    if isinstance(panel, Map):
        return {"data": [_heatmap(panel)], "layout": layout | _map_axes(panel)}
    marks = [part for part in panel.series if isinstance(part, Mark)]
    layout["shapes"] = [_mark_line(mark) for mark in marks]
    layout["annotations"] = [_mark_text(mark) for mark in marks if mark.text or mark.subscript]
    return {"data": _all_traces(panel), "layout": layout | _chart_axes(panel)}


def shown_step(panel: Map) -> int:
    """Return the number n such that every n-th node along x and along y is drawn."""
    return math.ceil(max(panel.x.size, panel.y.size) / _MOST_PIXELS)


def _chart_axes(chart: Chart) -> dict[str, Any]:
    axes = {
        "xaxis": _axis(chart.x, _numbers(chart, "x")),
        "yaxis": _axis(chart.y, _numbers(chart, "y")),
    }
    if chart.right is None:
        return axes
    right = {
        **_axis(chart.right, _numbers(chart, "y", right=True)),
        "overlaying": "y",
        "side": "right",
        "showgrid": False,
        "tickmode": "auto",  # ticks independent of those of the left axis
    }
    return axes | {"yaxis2": right, "margin": {"l": 70, "r": 70, "t": 28, "b": 60}}


def _numbers(chart: Chart, name: Literal["x", "y"], *, right: bool = False) -> Array:
    """All numbers of the series along one axis."""
    parts = []
    for part in chart.series:
        if isinstance(part, Band):
            parts += [part.x] if name == "x" else [part.low, part.high]
        elif isinstance(part, Line | Points):
            on_right = isinstance(part, Line) and part.right
            parts += [getattr(part, name)] if name == "x" or on_right == right else []
    return np.concatenate([np.ravel(part) for part in parts]) if parts else np.empty(0)


def _all_traces(chart: Chart) -> list[dict[str, Any]]:
    """Make the traces of all series, from bottom to top. The legend shows each label once."""
    ranks = {label: rank for rank, label in enumerate(legend_entries(chart), 1)}
    seen: set[str] = set()
    traces = []
    for layer in _LAYERS:
        for part in chart.series:
            for trace in _traces(part, chart) if isinstance(part, layer) else ():
                entry = trace.pop("entry")
                trace |= {"type": "scatter", "legendgroup": _escaped(entry)}
                trace |= {"legendrank": ranks.get(entry, 0)}
                traces.append(trace | {"showlegend": bool(entry) and entry not in seen})
                seen.add(entry)
    return traces


def _traces(part: Band | Line | Points, chart: Chart) -> list[dict[str, Any]]:
    """Make the traces of one series. The key `entry` of a trace holds its legend text."""
    if isinstance(part, Band):
        line = {"width": 1, "color": part.color, "dash": _dashes(part.dash, 1.0)}
        edge = {"x": part.x, "mode": "lines", "line": line, "hoverinfo": "skip"}
        return [
            {**edge, "y": part.low, "entry": ""},
            {
                **edge,
                "y": part.high,
                "fill": "tonexty",
                "fillcolor": _faint(part.color),
                "name": _escaped(part.label),
                "entry": part.label,
            },
        ]
    name = _escaped(part.name or part.label)
    y = chart.right if isinstance(part, Line) and part.right else chart.y
    trace: dict[str, Any] = {
        "x": part.x,
        "y": part.y,
        "name": _escaped(part.label) or name,
        "entry": part.label,
        "hovertemplate": f"%{{x:.4g}} {_escaped(chart.x.unit)}<br>"
        f"%{{y:.4g}} {_escaped((y or chart.y).unit)}<extra>{name}</extra>",
    }
    if isinstance(part, Line):
        line = {
            "color": part.color,
            "width": part.width + 0.3,
            "dash": _dashes(part.dash, part.width + 0.3),
        }
        trace |= {"mode": "lines" if np.size(part.x) > 1 else "markers", "line": line}
        trace |= {"line_shape": "hvh"} if part.step else {}
        return [trace | ({"yaxis": "y2"} if part.right else {})]
    hollow = np.zeros(np.shape(part.x), bool) if part.open is None else part.open
    closed = {"symbol": part.symbol, "size": 7, "color": part.color}
    trace |= {
        "mode": "lines+markers" if part.joined else "markers",
        "line": {"color": part.color, "width": 1.5},
        "marker": closed
        | {"symbol": [f"{part.symbol}-open" if h else part.symbol for h in hollow]},
    }
    traces = [trace]
    if part.joined and part.via is not None:
        # Its own trace, so that the markers keep their numbers.
        along, up = part.line()
        line = {"x": along, "y": up, "mode": "lines", "line": trace["line"], "hoverinfo": "skip"}
        traces.insert(0, line | {"name": name, "entry": ""})
        trace["line"] = {"color": part.color, "width": 0}
    if part.error is not None and has_error(part):
        below, above = np.broadcast_to(part.error, (2, np.size(part.y)))
        trace["error_y"] = {
            "array": above,
            "arrayminus": below,
            "symmetric": False,
            "thickness": 1,
            "width": 3,
        }
    if has_open(part) and not hollow.all():
        # By default the legend shows the marker of the first point, which may be open. Show a
        # closed marker instead.
        traces.insert(0, _legend_only(part.label, closed, mode=trace["mode"], line=trace["line"]))
    if has_open(part):
        traces.append(_legend_only(part.open_label, closed | {"symbol": f"{part.symbol}-open"}))
    if has_error(part):
        bar = {"symbol": "line-ns-open", "size": 12, "color": part.color}
        traces.append(_legend_only(part.error_label, bar))
    return traces


def _legend_only(
    label: str,
    marker: dict[str, Any],
    *,
    mode: str = "markers",
    line: dict[str, Any] | None = None,
) -> dict[str, Any]:
    """Make a trace without points, which appears only in the legend."""
    return {
        "x": [None],
        "y": [None],
        "mode": mode,
        "line": line or {},
        "marker": marker,
        "name": _escaped(label),
        "entry": label,
    }


def _mark_line(mark: Mark) -> dict[str, Any]:
    other = "y" if mark.axis == "x" else "x"
    ends: dict[str, Any] = {f"{mark.axis}0": mark.value, f"{mark.axis}1": mark.value}
    ends |= {f"{mark.axis}ref": mark.axis, f"{other}0": 0, f"{other}1": 1}
    line = {"color": "#8c959f", "dash": "dot", "width": 1}
    return {"type": "line", **ends, f"{other}ref": f"{other} domain", "line": line}


def _mark_text(mark: Mark) -> dict[str, Any]:
    """The text of a mark, at the lower end of a vertical and at one end of a horizontal line."""
    text = _escaped(mark.text) + (f"<sub>{mark.subscript}</sub>" if mark.subscript else "")
    made = {"text": text, "showarrow": False, "yanchor": "bottom"}
    if mark.axis == "x":
        beside = "left" if mark.side == "right" else "right"
        where = {"x": mark.value, "y": 0, "xref": "x", "yref": "y domain", "xanchor": beside}
    else:
        end = 1 if mark.side == "right" else 0
        where = {"x": end, "y": mark.value, "xref": "x domain", "yref": "y", "xanchor": mark.side}
    return made | where


def _heatmap(part: Map) -> dict[str, Any]:
    step, unit = shown_step(part), _escaped(part.quantity.unit)
    return {
        "type": "heatmap",
        "x": part.x[::step].astype(np.float32),
        "y": part.y[::step].astype(np.float32),
        "z": part.values[::step, ::step].T.astype(np.float32),
        "colorscale": part.colours,
        "colorbar": {"title": {"text": unit}, "thickness": 18},
        "hovertemplate": "x %{x:.4g} µm, y %{y:.4g} µm<br>"
        f"{_escaped(part.quantity.label)} %{{z:.4g}} {unit}<extra></extra>",
    }


def _map_axes(part: Map) -> dict[str, Any]:
    x = _axis(Axis("x", "µm"), part.x) | {"constrain": "domain"}
    y = _axis(Axis("y", "µm"), part.y) | {"scaleanchor": "x", "constrain": "domain"}
    if part.downwards:
        y["autorange"] = "reversed"
    return {"xaxis": x, "yaxis": y}


def _axis(axis: Axis, numbers: Array) -> dict[str, Any]:
    settings: dict[str, Any] = {
        "title": {"text": _escaped(axis.title)},
        "type": axis.scale,
        "showline": True,
        "ticks": "outside",
        "automargin": True,
        "nticks": _TICKS,
    }
    ends = [
        math.log10(end) if end is not None and axis.scale == "log" else end
        for end in (axis.low, axis.high)
    ]
    if None not in ends:
        settings["range"] = ends
    elif ends != [None, None]:  # Plotly loses a range with one fixed end when the page is resized
        settings["autorangeoptions"] = dict(zip(("minallowed", "maxallowed"), ends, strict=True))
    known = numbers[np.isfinite(numbers) & ((numbers > 0) | (axis.scale != "log"))]
    low, high = (float(known.min()), float(known.max())) if known.size else (1.0, 1.0)
    low, high = (low if axis.low is None else axis.low), (high if axis.high is None else axis.high)
    return settings | _tick_labels(axis, low, high)


def _tick_labels(axis: Axis, low: float, high: float) -> dict[str, Any]:
    labels = labels_of(axis, low, high)
    settings: dict[str, Any] = {"exponentformat": "none"}
    if labels == "prefixes":
        settings = {"exponentformat": "SI", "minexponent": 0, "ticksuffix": _escaped(axis.unit)}
    elif labels == "powers":
        settings = {"exponentformat": "power"}
    span = math.log10(high / low) if axis.scale == "log" else 0.0
    if span >= LINEAR:
        # Explicit, because Plotly draws the labels between powers of ten in another size.
        step = math.ceil(span / _TICKS)
        decades = range(math.floor(math.log10(low)) - 1, math.ceil(math.log10(high)) + 2, step)
        digits = digits_within(span)
        values = [float(f"{digit}e{k}") for k in decades for digit in digits]
        settings |= {"tickvals": values, "ticktext": [_tick(v, labels, axis.unit) for v in values]}
    return settings


def _tick(value: float, labels: Labels, unit: str) -> str:
    if labels != "powers":
        return _escaped(label(value, labels, unit))
    exponent, digits = power(value)
    times = "" if digits == "1" else f"{digits}×"
    return f"{times}10<sup>{exponent}</sup>".replace("-", "−")


def _dashes(dash: Dash, width: float) -> str:
    return ",".join(f"{length * width:.3g}px" for length in dash) or "solid"


def _faint(color: str) -> str:
    red, green, blue = (int(color[k : k + 2], 16) for k in (1, 3, 5))
    return f"rgba({red},{green},{blue},0.2)"


def _escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")
