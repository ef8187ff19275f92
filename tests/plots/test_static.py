"""Figures as files."""

import numpy as np
import pytest

from restitution.plots.figure import (
    Axis,
    Band,
    Chart,
    Figure,
    Line,
    Mark,
    Points,
    legend_entries,
)
from restitution.plots.static import draw, write_figure

X = np.array([1.0, 2.0, 3.0])
CHART = Chart(
    Axis("x", "µm", "log"),
    Axis("y"),
    [
        Band(X, X - 0.1, X + 0.1, "band"),
        Line(X, X, "line"),
        Line(X, 2 * X, "line"),
        Line(X, 3 * X),
        Points(X, X, "points", error=0.1 * X, error_label="error", open=X > 2, open_label="open"),
        Mark("x", 2.0, "V", "y"),
        Mark("y", 2.0, "$5"),
        Line(X, 100 * X, "percent", right=True, step=True),
    ],
    right=Axis("share", "%", low=0.0),
)
FIGURE = Figure("A figure", [CHART])


@pytest.mark.parametrize(
    ("kind", "start"), [("png", b"\x89PNG"), ("svg", b"<?xml"), ("pdf", b"%PDF")]
)
def test_a_figure_is_written_as_png_svg_or_pdf_and_always_the_same(tmp_path, kind, start):
    first = write_figure(tmp_path / "a.b", FIGURE, kind)
    assert first.name == f"a.b.{kind}"
    content = first.read_bytes()
    assert content.startswith(start)
    assert write_figure(tmp_path / "a.b", FIGURE, kind).read_bytes() == content
    assert [path.name for path in tmp_path.iterdir()] == [first.name]


def test_series_with_one_label_share_an_entry_of_the_legend():
    names = ["band", "line", "points", "open", "error", "percent"]
    assert legend_entries(CHART) == names
    drawing = draw(FIGURE)
    assert [text.get_text() for text in drawing.legends[0].get_texts()] == names
    left, right = drawing.axes
    assert {text.get_text() for text in left.texts} == {"$V_y$", r"\$5"}
    assert right.get_ylabel() == "share (%)"
    assert right.get_ylim()[0] == 0


def test_a_long_legend_stands_at_the_side():
    many = [Line(X, k * X, f"line {k}") for k in range(20)]
    drawing = draw(Figure("", [Chart(Axis("x"), Axis("y"), many)]))
    drawing.canvas.draw()
    (legend,) = drawing.legends
    assert legend.get_window_extent().x0 > drawing.axes[0].get_window_extent().x1
    assert legend.get_window_extent().y0 >= 0
