"""Panels of figures for pages."""

import numpy as np

from restitution.plots.figure import Axis, Band, Chart, Figure, Line, Map, Mark, Points
from restitution.plots.interactive import draw, shown_step

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


def test_large_maps_are_thinned():
    part = Map(np.arange(700.0), np.arange(10.0), np.zeros((700, 10)), Axis("height", "nm"))
    assert shown_step(part) == 3
    plot = draw(part, Figure("", [part]))
    assert np.shape(plot.data[0].z) == (4, 234)
