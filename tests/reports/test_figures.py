import numpy as np
import pytest
import xarray as xr

from restitution.reports.figures import figures, surface_map, write_figure
from tolerance import approx


@pytest.fixture
def results(cli, case_text, tmp_path):
    text = case_text.replace("A small rough contact", "costs $5 & $\\\\alpha_{ <b>")
    (tmp_path / "case.toml").write_text(text.replace('"20 nm"', '"1 nm"'))
    assert cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    with xr.open_dataset(tmp_path / "out" / "results.nc") as stored:
        return stored.load()


def test_figures_show_the_stored_numbers(results):
    drawn = dict(figures(results))
    assert list(drawn) == [
        "load-displacement", "restitution-indentation", "restitution-velocity", "pressure",
    ]  # fmt: skip
    loading = drawn["load-displacement"].axes[0].lines[0]
    assert loading.get_xdata()[1:] == approx(1e6 * results["indentation"].values)
    assert loading.get_ydata()[1:] == approx(results["force"].values)
    image = drawn["pressure"].axes[0].images[0].get_array()
    assert np.nanmax(image) == approx(1e-6 * float(results["pressure"].max()))
    for figure in drawn.values():
        assert figure.axes[0].get_xlabel()
        assert figure.axes[0].get_ylabel()


def test_unresolved_depths_have_open_markers(results):
    axes = dict(figures(results))["restitution-velocity"].axes[0]
    few = results["median_patch_nodes"].values < 20
    assert few.any()
    open_markers = [line for line in axes.lines if line.get_markerfacecolor() == "white"]
    assert len(open_markers) == 1
    assert open_markers[0].get_xdata() == approx(results["impact_velocity"].values[few])


def test_a_hostile_title_is_drawn_as_text(results):
    for _, figure in figures(results):
        figure.canvas.draw()
        assert figure.axes[0].get_title() == r"costs \$5 & \$\alpha_{ <b>"


def test_the_first_scan_line_of_a_file_is_drawn_at_the_top():
    height = xr.DataArray(
        np.arange(6.0).reshape(3, 2), {"x": [0.0, 1e-6, 2e-6], "y": [0.0, 2e-6]}, ("x", "y")
    )
    axes = surface_map(height, "", "down").axes[0]
    assert axes.get_ylim() == approx((3.0, -1.0))
    assert surface_map(height, "").axes[0].get_ylim() == approx((-1.0, 3.0))


def test_the_smooth_contact_of_the_same_model_is_drawn_beside_another_model(results):
    drawn = dict(figures(results))
    for name in ("restitution-indentation", "restitution-velocity", "load-displacement"):
        labels = drawn[name].axes[0].get_legend_handles_labels()[1]
        assert "smooth, same model" in labels
        assert "smooth, Thornton–Ning (truncated pressure)" in labels
    axes = drawn["restitution-velocity"].axes[0]
    line = next(line for line in axes.lines if line.get_label() == "smooth, same model")
    assert line.get_ydata() == approx(results["smooth_restitution"].values)
    old = results.drop_vars([name for name in results if name.startswith("smooth_")])
    assert len(dict(figures(old))) == 4


def test_unloading_from_shallow_depths_is_seen_on_logarithmic_axes(results):
    axes = dict(figures(results))["load-displacement"].axes[1]
    assert (axes.get_xscale(), axes.get_yscale()) == ("log", "log")
    unloading = [line for line in axes.lines if line.get_color() == "C1"]
    assert len(unloading) == results.sizes["unloading"]
    for line in unloading:
        assert min(line.get_ydata()) > 0
        assert axes.get_xlim()[0] < min(line.get_xdata())


def test_a_long_title_in_any_script_is_two_lines(results, tmp_path):
    results.attrs["title"] = "粒子 " * 10 + "word " * 60
    figure = dict(figures(results))["restitution-velocity"]
    write_figure(tmp_path / "figure.png", figure)  # a warning would be an error
    assert figure.axes[0].get_title().count("\n") == 1
    assert figure.axes[0].get_title().endswith(" …")


def test_the_axes_of_a_map_are_x_to_the_right_and_y_up():
    height = xr.DataArray(
        np.arange(6.0).reshape(3, 2), {"x": [0.0, 1e-6, 2e-6], "y": [0.0, 2e-6]}, ("x", "y")
    )
    image = surface_map(height, "").axes[0].images[0]
    assert image.get_extent() == approx([-0.5, 2.5, -1.0, 3.0])
    assert image.origin == "lower"
    assert image.get_array()[1, 2] == approx(5e6)  # y index 1, x index 2
