"""Results are selected and drawn by depth, velocity and pressure."""

import shutil
import tomllib

import matplotlib as mpl
import numpy as np
import pytest
import xarray as xr

import restitution as rs
from restitution.results.checksums import CHECKSUMS
from restitution.results.coordinates import with_coordinates
from tolerance import approx


@pytest.fixture(scope="module")
def folder(case_text, tmp_path_factory):
    case = tomllib.loads(case_text) | {"total_error": False}
    case["indentation"] = {"values": ["100 nm", "200 nm", "300 nm"]}
    return rs.run(case, out=tmp_path_factory.mktemp("run") / "results").folder


def as_before(folder):
    """Take the coordinates out of `results.nc`, as in files of earlier versions."""
    path = folder / "results.nc"
    with xr.open_dataset(path) as stored:
        whole = stored.load()
    bare = whole.reset_coords(["impact_velocity", "smooth_impact_velocity"])
    bare = bare.reset_coords("unloading_indentation")
    bare = bare.drop_vars(["indentation_max", "unloading", "unloading_step", "smooth"])
    path.unlink()
    bare.to_netcdf(path)
    (folder / CHECKSUMS).unlink()


def test_depths_are_selected_by_value(folder):
    data = rs.open_results(folder).dataset
    near = data.restitution.sel(indentation_max=1.9e-7, method="nearest")
    assert float(near.indentation_max) == approx(2e-7)
    assert float(near) == float(data.restitution[1])
    assert float(near.impact_velocity) == float(data["impact_velocity"][1])
    back = data.unloading_force.sel(unloading=3e-7, method="nearest")
    assert float(back.sel(unloading_step=0)) == approx(float(data.force[-1]))
    assert data.smooth_force["smooth"].values == approx(data["smooth_indentation"].values)
    assert "smooth_impact_velocity" in data.smooth_restitution.coords
    assert all("units" in data[name].attrs for name in data.variables)


def test_the_file_alone_has_the_coordinates(folder):
    with xr.open_dataset(folder / "results.nc") as data:
        assert float(data.force.sel(indentation_max=2e-7, method="nearest")) > 0
        assert "impact_velocity" in data.coords


def test_a_plot_is_drawn_against_depth_and_velocity(folder):
    mpl.use("Agg")
    data = rs.open_results(folder).dataset
    (line,) = data.restitution.plot()
    assert line.get_xdata() == approx([1e-7, 2e-7, 3e-7])
    assert line.axes.get_xlabel() == "maximum indentation [m]"
    (line,) = data.restitution.plot(x="impact_velocity")
    assert line.get_xdata() == approx(data["impact_velocity"].values)


def test_files_without_coordinates_get_them(folder, tmp_path):
    old = tmp_path / "old"
    shutil.copytree(folder, old)
    as_before(old)
    xr.testing.assert_identical(rs.open_results(old).dataset, rs.open_results(folder).dataset)


def test_unknown_velocities_and_equal_depths_are_kept():
    data = with_coordinates(
        xr.Dataset(
            {
                "indentation": ("indentation_max", [1e-7, 1e-7]),
                "impact_velocity": ("indentation_max", [np.nan, 0.1]),
                "restitution": ("indentation_max", [0.0, 0.9]),
            }
        )
    )
    assert data.restitution.sel(indentation_max=1e-7).values.tolist() == [0.0, 0.9]
    assert np.isnan(data["impact_velocity"].values[0])
    assert with_coordinates(xr.Dataset({"status": 1})).sizes == {}


def test_depths_and_velocities_of_a_study_are_coordinates():
    cells = ("roughness.rms", "depth")
    values = np.array([[1e-7, 2e-7], [1e-7, np.nan]])
    data = with_coordinates(
        xr.Dataset(dict.fromkeys(("indentation", "impact_velocity", "force"), (cells, values)))
    )
    assert set(data.force.coords) == {"indentation", "impact_velocity"}
    assert not data.indexes
