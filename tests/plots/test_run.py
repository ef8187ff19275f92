"""Figures of a run: what is described, and what both libraries draw of it."""

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from restitution import Grid
from restitution.case.case_file import parse_case
from restitution.plots import interactive
from restitution.plots.cor import cor_axis
from restitution.plots.figure import (
    BLUE,
    ORANGE,
    SOLID,
    Band,
    Figure,
    Line,
    Mark,
    Points,
    legend_entries,
)
from restitution.plots.run import run_figures
from restitution.plots.static import draw, write_figure
from restitution.plots.surface import surface_map
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import run_realisations
from restitution.surfaces import Surface
from tolerance import approx


@pytest.fixture(scope="module")
def stored(case_text, tmp_path_factory):
    text = case_text.replace("A small rough contact", "costs $5 & $\\\\alpha_{ <b>")
    text = text.replace('"20 nm"', '"1 nm"')
    out = tmp_path_factory.mktemp("run") / "out"
    run_realisations(parse_case(text), text, out.parent, ResultsFolder(out))
    with xr.open_dataset(out / "results.nc") as dataset:
        return dataset.load()


@pytest.fixture
def results(stored):
    return stored.copy(deep=True)


def figures(results):
    """Every figure, drawn by matplotlib."""
    return {name: draw(figure) for name, figure in run_figures(results)}


def labels(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_figures_show_the_stored_numbers(results):
    drawn = figures(results)
    assert list(drawn) == [
        "load-displacement",
        "restitution-indentation",
        "restitution-velocity",
        "pressure",
    ]
    loading = drawn["load-displacement"].axes[0].lines[0]
    assert loading.get_xdata()[1:] == approx(1e6 * results["indentation"].values)
    assert loading.get_ydata()[1:] == approx(results["force"].values)
    image = drawn["pressure"].axes[0].images[0].get_array()
    assert np.nanmax(image) == approx(1e9 * float(results["plastic_displacement"].max()))
    for figure in drawn.values():
        assert figure.axes[0].get_xlabel()
        assert figure.axes[0].get_ylabel()


def test_unresolved_depths_have_open_markers(results):
    axes = figures(results)["restitution-velocity"].axes[0]
    few = results["median_patch_nodes"].values < 20
    assert few.any()
    open_markers = [line for line in axes.lines if line.get_markerfacecolor() == "white"]
    assert len(open_markers) == 1
    assert open_markers[0].get_xdata() == approx(results["impact_velocity"].values[few])


def test_a_hostile_title_is_drawn_as_text(results):
    for _, figure in figures(results).items():
        figure.canvas.draw()
        assert figure.get_suptitle() == r"costs \$5 & \$\alpha_{ <b>"


def test_the_smooth_contact_of_the_same_model_is_drawn_beside_another_model(results):
    drawn = figures(results)
    for name in ("restitution-indentation", "restitution-velocity", "load-displacement"):
        assert "smooth, same model" in labels(drawn[name])
        assert "smooth, Thornton–Ning (truncated pressure)" in labels(drawn[name])
    (chart,) = dict(run_figures(results))["restitution-velocity"].panels
    line = next(line for line in chart.series if line.label == "smooth, same model")
    assert line.y == approx(results["smooth_restitution"].values)
    old = results.drop_vars([name for name in results if name.startswith("smooth_")])
    assert len(figures(old)) == 4


def test_unloading_from_shallow_depths_is_seen_on_logarithmic_axes(results):
    axes = figures(results)["load-displacement"].axes[1]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    unloading = [line for line in axes.lines if line.get_color() == ORANGE]
    assert len(unloading) == results.sizes["unloading"]
    for line in unloading:
        x, y = line.get_data()
        assert min(y) > 0
        assert axes.get_xlim()[0] < min(x[y > axes.get_ylim()[0]])


def test_a_long_title_in_any_script_is_two_lines(results, tmp_path):
    results.attrs["title"] = "粒子 " * 10 + "word " * 60
    described = dict(run_figures(results))["restitution-velocity"]
    write_figure(tmp_path / "figure", described)  # a warning would be an error
    figure = draw(described)
    assert figure.get_suptitle().count("\n") == 1
    assert figure.get_suptitle().endswith(" …")


def test_a_map_has_x_to_the_right_and_y_up_or_down_as_the_file_has_it():
    height = 1e-9 * np.arange(6.0).reshape(3, 2)
    grid = Grid((3, 2), (1e-6, 2e-6))
    axes = draw(surface_map(Surface(height, grid, {}))).axes[0]
    (image,) = axes.images
    x, y = 1e6 * grid.x, 1e6 * grid.y
    assert image.get_extent() == approx([x[0] - 0.5, x[-1] + 0.5, y[0] - 1, y[-1] + 1])
    assert image.origin == "lower"
    assert image.get_array()[1, 2] == approx(2.5)  # y index 1, x index 2, above the mean
    assert axes.get_ylim() == approx((y[0] - 1, y[-1] + 1))
    down = surface_map(Surface(height, grid, {"y_axis": "down"}))
    assert draw(down).axes[0].get_ylim() == approx((y[-1] + 1, y[0] - 1))
    plot = interactive.draw(down.panels[0], down)
    assert plot.layout.yaxis.autorange == "reversed"
    assert np.asarray(plot.data[0].z)[1, 2] == approx(2.5)


def test_beside_the_pressure_is_the_plastic_displacement_where_there_is_any(results):
    results["pressure"][:] = results["pressure"] * (results["x"] > 0)  # no longer uniform
    pressure, depth = dict(run_figures(results))["pressure"].panels
    assert pressure.quantity.title == "pressure (MPa)"
    assert np.nanmax(pressure.values) == approx(1e-6 * float(results["pressure"].max()))
    assert depth.quantity.title == "plastic displacement (nm)"
    assert np.nanmax(depth.values) == approx(1e9 * float(results["plastic_displacement"].max()))
    assert depth.values.shape == pressure.values.shape == (depth.x.size, depth.y.size)
    results["plastic_displacement"][:] = 0
    (pressure,) = dict(run_figures(results))["pressure"].panels
    assert pressure.quantity.title == "pressure (MPa)"


def test_a_pressure_that_is_the_same_everywhere_is_not_drawn_but_stated(results):
    (depth,) = dict(run_figures(results))["pressure"].panels
    assert depth.quantity.label == "plastic displacement"
    assert "97.4 % of the contact at the yield pressure, 750 MPa" in depth.title
    pressure = results["pressure"].values
    assert np.mean(pressure[pressure != 0] > 742.5e6) == approx(0.974, abs=5e-4)
    touched = (pressure != 0) | (results["plastic_displacement"].values != 0)
    assert np.count_nonzero(np.isfinite(depth.values)) == np.count_nonzero(touched)


def test_bars_end_at_the_limits_of_restitution_and_within_the_axes(results):
    results["total_error"][:] = [2.0, 0.01, 0.02, 0.0]
    (chart,) = dict(run_figures(results))["restitution-velocity"].panels
    points = next(each for each in chart.series if isinstance(each, Points))
    assert points.error_label == "total error (cut at 0 and 1)"
    below, above = points.error
    assert (points.y - below)[0] == approx(0.0)
    assert (points.y + above)[0] == approx(1.0)
    assert below[1:] == approx([0.01, 0.02, 0.0])
    axes = figures(results)["restitution-velocity"].axes[0]
    low, high = axes.get_ylim()
    assert low <= (points.y - below).min()
    assert high >= (points.y + above).max()


def test_the_axis_of_restitution_holds_the_data_and_little_else():
    line = Line(np.array([1.0, 2.0]), np.array([0.73, 0.87]))
    axis = cor_axis([line])
    assert (axis.low, axis.high) == (approx(0.7), approx(0.9))
    axis = cor_axis([replace(line, y=np.array([0.0, 1.0])), Mark("x", 1.0)])
    assert axis.low < 0
    assert axis.high > 1
    assert cor_axis([replace(line, y=np.full(2, np.nan))]).high > 1


def test_both_libraries_draw_the_same_points_and_legend_entries(results):
    for name, figure in run_figures(results):
        drawing = draw(figure)
        for panel, axes in zip(figure.panels, drawing.axes, strict=False):
            plot = interactive.draw(panel, figure)
            assert axes.get_xlabel() == plot.layout.xaxis.title.text
            assert axes.get_ylabel() == plot.layout.yaxis.title.text
            assert axes.get_xscale() == plot.layout.xaxis.type
            shown = [trace for trace in plot.data if trace.showlegend]
            shown.sort(key=lambda trace: trace.legendrank)
            assert [trace.name for trace in shown] == legend_entries(panel)
            assert set(legend_entries(panel)) <= set(labels(drawing) if drawing.legends else ())
        if name.startswith("restitution"):
            points = next(trace for trace in plot.data if trace.error_y.array is not None)
            assert points.y == approx(results["restitution"].values)
            open_markers = [symbol == "circle-open" for symbol in points.marker.symbol]
            assert open_markers == (results["resolved"].values == 0).tolist()


def test_the_axes_of_load_and_displacement_fit_the_contact(results):
    linear, _ = figures(results)["load-displacement"].axes
    assert linear.get_xlim() == approx((0, 1.05e6 * float(results["indentation"].max())))
    assert linear.get_ylim() == approx((0, 1.05 * float(results["force"].max())))


def test_no_legend_lies_over_data(results):
    for figure in figures(results).values():
        figure.canvas.draw()
        for legend in figure.legends:
            box = legend.get_window_extent()
            assert not any(box.overlaps(axes.get_window_extent()) for axes in figure.axes)


def test_the_error_of_the_model_is_a_band_and_the_total_error_bars(results):
    (chart,) = dict(run_figures(results))["restitution-velocity"].panels
    (band,) = (part for part in chart.series if isinstance(part, Band))
    cor, model = results["restitution"].values, results["model_error"].values
    assert band.label == "± error of the model"
    assert band.low == approx(np.clip(cor - model, 0, 1))
    assert band.high == approx(np.clip(cor + model, 0, 1))
    assert (band.color, band.dash) != (BLUE, SOLID)
    assert any(entry.startswith("total error") for entry in legend_entries(chart))
    results["model_error"][:] = 0
    (chart,) = dict(run_figures(results))["restitution-velocity"].panels
    assert not any(isinstance(part, Band) for part in chart.series)


@pytest.mark.parametrize("name", ["restitution-velocity", "restitution-indentation"])
def test_the_curve_rises_at_the_sticking_velocity_like_the_law(results, name):
    V = results["impact_velocity"].values
    sticks = 0.9 * V[2]
    results["restitution"][:] = np.sqrt(np.clip(1 - (sticks / V) ** 2, 0, 1))
    (chart,) = dict(run_figures(results))[name].panels
    points = next(part for part in chart.series if isinstance(part, Points))
    x, e = points.line()
    assert points.y == approx(results["restitution"].values)
    if name == "restitution-velocity":
        above = x > 1.0001 * sticks
        assert e[above] == approx(np.sqrt(1 - (sticks / x[above]) ** 2), rel=2e-2)
        assert x[e > 0].min() < 1.001 * sticks
        assert not e[x < 0.999 * sticks].any()
    plot = interactive.draw(chart, Figure("", [chart]))
    drawn = [trace for trace in plot.data if trace.name == "this contact" and len(trace.x) > 1]
    line, markers = drawn
    assert line.y == approx(e)
    assert markers.y == approx(points.y)
    lines = draw(Figure("", [chart])).axes[0].lines
    assert any(np.size(one.get_xdata()) == x.size for one in lines)


def test_a_curve_without_sticking_is_joined_point_by_point(results):
    (chart,) = dict(run_figures(results))["restitution-velocity"].panels
    points = next(part for part in chart.series if isinstance(part, Points))
    assert points.via is None
