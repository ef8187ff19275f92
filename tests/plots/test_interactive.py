"""Panels of figures for pages."""

import numpy as np

from restitution.plots.figure import Axis, Band, Chart, Figure, Line, Map, Mark, Points
from restitution.plots.interactive import draw, shown_step
from restitution.plots.library import compressed, script
from tolerance import approx

X = np.array([1.0, 2.0, 3.0])


def plot_of(*series, x=None, right=None):
    chart = Chart(x or Axis("x"), Axis("y"), series, right=right)
    return draw(chart, Figure("", [chart]))


def test_texts_of_users_are_no_markup():
    plot = plot_of(Line(X, X, "<b>a & b"), Mark("y", 1.0, "<i>"), x=Axis("<u>", "<s>"))
    assert plot.data[0].name == "&lt;b&gt;a &amp; b"
    assert "<b>" not in plot.data[0].hovertemplate
    assert "<s>" not in plot.data[0].hovertemplate
    assert plot.layout.annotations[0].text == "&lt;i&gt;"
    assert plot.layout.xaxis.title.text == "&lt;u&gt; (&lt;s&gt;)"


def test_bands_lie_below_lines_and_lines_below_points():
    plot = plot_of(Points(X, X, "points"), Line(X, X, "line"), Band(X, X, 2 * X, "band"))
    assert [trace.name for trace in plot.data if trace.showlegend] == ["band", "line", "points"]
    assert [trace.legendrank for trace in plot.data if trace.showlegend] == [3, 2, 1]


def test_limits_of_logarithmic_axes_are_exponents_and_may_be_one():
    plot = plot_of(Line(X, X), x=Axis("x", scale="log", low=0.01, high=100.0))
    assert plot.layout.xaxis.range == (-2, 2)
    plot = plot_of(Line(X, X, right=True), right=Axis("share", "%", low=0.0))
    assert plot.layout.yaxis2.autorangeoptions.minallowed == 0
    assert plot.data[0].yaxis == "y2"


def test_the_legend_shows_a_closed_marker_although_the_first_point_is_open():
    points = Points(X, X, "points", symbol="square", joined=True, open=X < 2, open_label="open")
    plot = plot_of(points)
    shown = {trace.name: trace for trace in plot.data if trace.showlegend}
    assert shown["points"].marker.symbol == "square"
    assert shown["points"].mode == "lines+markers"
    assert shown["open"].marker.symbol == "square-open"
    assert plot.data[1].marker.symbol == ("square-open", "square", "square")


def test_bars_may_differ_below_and_above():
    plot = plot_of(Points(X, X, "points", error=np.array([0.1 * X, 0.2 * X]), error_label="error"))
    assert plot.data[0].error_y.array == approx(0.2 * X)
    assert plot.data[0].error_y.arrayminus == approx(0.1 * X)


def test_large_maps_are_thinned():
    part = Map(np.arange(700.0), np.arange(10.0), np.zeros((700, 10)), Axis("height", "nm"))
    assert shown_step(part) == 3
    plot = draw(part, Figure("", [part]))
    assert np.shape(plot.data[0].z) == (4, 234)


def test_only_useful_buttons_stand_over_a_plot():
    removed = set(plot_of(Line(X, X)).layout.modebar.remove)
    assert {"lasso2d", "select2d", "zoomIn2d", "zoomOut2d", "autoScale2d"} == removed


def test_the_library_draws_the_traces_of_all_figures_and_is_small():
    assert script().startswith("/* plotly.js ")
    assert "MIT license" in script()[:100]
    assert len(compressed()) < 400_000
    part = Map(np.arange(3.0), np.arange(3.0), np.eye(3), Axis("height", "nm"))
    kinds = {draw(part, Figure("", [part])).data[0].type, plot_of(Line(X, X)).data[0].type}
    assert kinds == {"heatmap", "scatter"}  # those in plotly/bundle.mjs
