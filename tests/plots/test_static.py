"""Figures as files."""

import numpy as np
import pytest

from restitution.plots.figure import (
    SYMBOLS,
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
from tolerance import approx

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


@pytest.mark.parametrize(
    ("low", "high", "expected"),
    [
        (0.02, 5.0, ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5"]),
        (1.0, 9.0, ["1", "2", "3", "5", "7"]),
        (10.0, 20.0, ["10", "12", "14", "16", "18", "20"]),
        (1e-9, 1.2e-8, [r"$10^{-9}$", r"$2\times10^{-9}$", r"$5\times10^{-9}$", r"$10^{-8}$"]),
        (1e-3, 1e3, ["0.001", "0.01", "0.1", "1", "10", "100", "1000"]),
    ],
)
def test_logarithmic_axes_have_labels_at_any_length(low, high, expected):
    line = Line(np.array([low, high]), X[:2])
    drawing = draw(Figure("", [Chart(Axis("x", "", "log", low, high), Axis("y"), [line])]))
    drawing.canvas.draw()
    (axes,) = drawing.axes
    ticks = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
    inside = [text.get_text() for at, text in ticks if low * 0.999 <= at <= high * 1.001]
    assert inside == expected
    assert not any(text.get_text() for text in axes.get_xticklabels(minor=True))


def test_series_are_told_apart_without_colours():
    points = [Points(X, X + k, f"{k}", symbol=SYMBOLS[k]) for k in (0, 1)]
    drawing = draw(Figure("", [Chart(Axis("x"), Axis("y"), points)]))
    assert [line.get_marker() for line in drawing.axes[0].lines] == ["o", "s"]
    (legend,) = drawing.legends
    assert [line.get_marker() for line in legend.get_lines()] == ["o", "s"]


def test_a_long_legend_stands_at_the_side():
    many = [Line(X, k * X, f"line {k}") for k in range(20)]
    drawing = draw(Figure("", [Chart(Axis("x"), Axis("y"), many)]))
    drawing.canvas.draw()
    (legend,) = drawing.legends
    assert legend.get_window_extent().x0 > drawing.axes[0].get_window_extent().x1
    assert legend.get_window_extent().y0 >= 0


def test_a_png_has_300_pixels_per_inch(tmp_path):
    content = write_figure(tmp_path / "a", FIGURE, "png").read_bytes()
    width = int.from_bytes(content[16:20], "big")
    assert width == approx(300 * draw(FIGURE).get_figwidth(), abs=1)
    at = content.index(b"pHYs") + 4  # pixels per metre
    assert int.from_bytes(content[at : at + 4], "big") == approx(300 / 0.0254, abs=1)
