"""Labels of ticks, the same in files and on pages."""

import numpy as np
import pytest

from restitution.plots import interactive, static
from restitution.plots.figure import Axis, Chart, Figure, Line


def both(axis, low, high):
    """The labels of an x axis from `low` to `high` in a file and on a page."""
    line = Line(np.array([low, high]), np.array([1.0, 2.0]))
    chart = Chart(axis, Axis("y"), [line])
    figure = Figure("", [chart])
    drawing = static.draw(figure)
    drawing.canvas.draw()
    (axes,) = drawing.axes
    ticks = zip(axes.get_xticks(), axes.get_xticklabels(), strict=True)
    in_file = [text.get_text() for at, text in ticks if low * 0.999 <= at <= high * 1.001]
    drawn = interactive.draw(chart, figure).layout.xaxis
    shown = zip(drawn.tickvals, drawn.ticktext, strict=True)
    on_page = [text for at, text in shown if low * 0.999 <= at <= high * 1.001]
    return in_file, on_page


@pytest.mark.parametrize(
    ("unit", "low", "high", "expected"),
    [
        ("m/s", 0.002, 0.05, ["0.002", "0.005", "0.01", "0.02", "0.05"]),
        ("m/s", 1e-4, 5e-3, ["100 µm/s", "200 µm/s", "500 µm/s", "1 mm/s", "2 mm/s", "5 mm/s"]),
        ("N", 1e-6, 1e-1, ["1 µN", "10 µN", "100 µN", "1 mN", "10 mN", "100 mN"]),
        ("m/s", 0.1, 0.9, ["0.1", "0.2", "0.3", "0.5", "0.7"]),
        ("µm", 0.01, 10, ["0.01", "0.02", "0.05", "0.1", "0.2", "0.5", "1", "2", "5", "10"]),
    ],
)
def test_logarithmic_axes_have_the_same_labels_in_files_and_on_pages(unit, low, high, expected):
    assert both(Axis("x", unit, "log", low, high), low, high) == (expected, expected)


def test_units_without_prefixes_have_powers_of_ten():
    axis = Axis("x", "1/GPa", "log", 1e-5, 1e-3)
    in_file, on_page = both(axis, 1e-5, 1e-3)
    assert (in_file[0], on_page[0]) == ("$10^{-5}$", "10<sup>−5</sup>")
    assert (in_file[1], on_page[1]) == (r"$2\times10^{-5}$", "2×10<sup>−5</sup>")


def test_small_forces_on_linear_axes_have_prefixes():
    line = Line(np.array([1.0, 2.0]), np.array([0.0, 3e-5]))
    chart = Chart(Axis("x"), Axis("force", "N", low=0.0, high=3e-5), [line])
    drawing = static.draw(Figure("", [chart]))
    drawing.canvas.draw()
    assert [text.get_text() for text in drawing.axes[0].get_yticklabels()][:2] == ["0", "10 µN"]
    axis = interactive.draw(chart, Figure("", [chart])).layout.yaxis
    assert (axis.exponentformat, axis.ticksuffix) == ("SI", "N")
    plain = Chart(Axis("x"), Axis("force", "N", low=0.0, high=0.3), [line])
    axis = interactive.draw(plain, Figure("", [plain])).layout.yaxis
    assert (axis.exponentformat, axis.ticksuffix) == ("none", None)
