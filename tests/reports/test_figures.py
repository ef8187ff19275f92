import numpy as np
import pytest
import xarray as xr

from restitution.reports.figures import figures, surface_map


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
    assert loading.get_xdata()[1:] == pytest.approx(1e6 * results["indentation"].values)
    assert loading.get_ydata()[1:] == pytest.approx(results["force"].values)
    image = drawn["pressure"].axes[0].images[0].get_array()
    assert np.nanmax(image) == pytest.approx(1e-6 * float(results["pressure"].max()))
    for figure in drawn.values():
        assert figure.axes[0].get_xlabel()
        assert figure.axes[0].get_ylabel()


def test_unresolved_depths_have_open_markers(results):
    axes = dict(figures(results))["restitution-velocity"].axes[0]
    few = results["largest_patch_nodes"].values < 10
    assert few.any()
    open_markers = [line for line in axes.lines if line.get_markerfacecolor() == "white"]
    assert len(open_markers) == 1
    assert open_markers[0].get_xdata() == pytest.approx(results["impact_velocity"].values[few])


def test_a_hostile_title_is_drawn_as_text(results):
    for _, figure in figures(results):
        figure.canvas.draw()
        assert figure.axes[0].get_title() == r"costs \$5 & \$\alpha_{ <b>"


def test_the_axes_of_a_map_are_x_to_the_right_and_y_up():
    height = xr.DataArray(
        np.arange(6.0).reshape(3, 2), {"x": [0.0, 1e-6, 2e-6], "y": [0.0, 2e-6]}, ("x", "y")
    )
    image = surface_map(height, "").axes[0].images[0]
    assert image.get_extent() == pytest.approx([-0.5, 2.5, -1.0, 3.0])
    assert image.origin == "lower"
    assert image.get_array()[1, 2] == pytest.approx(5e6)  # y index 1, x index 2
