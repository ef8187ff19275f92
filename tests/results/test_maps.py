"""Maps of pressure and plastic displacement at every depth."""

import tomllib

import numpy as np
import pytest
import xarray as xr

import restitution as rs
from restitution.case.case_file import parse_case
from restitution.errors import CaseError, OutputError
from restitution.numerics import memory
from restitution.pages.report import write_report
from restitution.plots.run import depth_maps_figure
from restitution.results.maps import DepthMaps
from tolerance import approx


def case_of(text, **more):
    case = tomllib.loads(text) | {"total_error": False, "maps": "all"}
    case["indentation"] = {"values": ["100 nm", "200 nm", "300 nm"]}
    return case | more


@pytest.fixture(scope="module")
def results(case_text, tmp_path_factory):
    return rs.run(case_of(case_text), out=tmp_path_factory.mktemp("run") / "out")


def test_the_maps_carry_the_force_and_the_plastic_displacement_of_each_depth(results):
    maps, data = results.maps, results.dataset
    assert maps["pressure"].dims == ("indentation_max", "x", "y")
    assert maps["indentation_max"].values == approx([1e-7, 2e-7, 3e-7])
    assert "impact_velocity" in maps["pressure"].coords
    area = float(maps["x"][1] - maps["x"][0]) * float(maps["y"][1] - maps["y"][0])
    force = area * maps["pressure"].sum(("x", "y"))
    assert force.values == approx(data["force"].values)
    for name in ("pressure", "plastic_displacement"):
        deepest = maps[name].sel(indentation_max=3e-7, method="nearest")
        assert (deepest.values == data[name].values).all()
        assert maps[name].attrs["units"] == data[name].attrs["units"]
    assert (np.diff(maps["plastic_displacement"].max(("x", "y"))) > 0).all()
    assert maps["x"].values == approx(data["x"].values)


def test_the_page_draws_some_depths(results):
    page = write_report(results.folder).read_text()
    assert "Contact pressure at several depths" in page
    assert "All 3 depths are in maps.nc." in page
    panels = depth_maps_figure(results.maps, "").panels
    assert [panel.title for panel in panels] == ["at 100 nm", "at 200 nm", "at 300 nm"]
    force = [np.nansum(panel.values) for panel in panels]
    assert force == approx((1e-6 * results.maps["pressure"].sum(("x", "y"))).values.tolist())


def test_the_checksums_include_the_maps(results):
    assert "maps.nc" in (results.folder / "SHA256SUMS").read_text()


def test_without_the_key_only_the_deepest_map_is_stored(case_text, tmp_path):
    found = rs.run(case_of(case_text, maps="deepest"), out=tmp_path / "out")
    assert not (tmp_path / "out" / "maps.nc").exists()
    with pytest.raises(OutputError, match='write maps = "all" at the top of the case file'):
        found.maps  # noqa: B018


def test_depths_on_different_grids_share_the_finest(case_text, tmp_path):
    case = case_of(case_text)
    case["grid"]["refine"] = [2, 1, 1]
    found = rs.run(case, out=tmp_path / "out")
    maps, data = found.maps, found.dataset
    assert maps["pressure"].shape == (3, 144, 128)
    area = float(maps["x"][1] - maps["x"][0]) * float(maps["y"][1] - maps["y"][0])
    force = area * maps["pressure"].sum(("x", "y")).values
    assert force == approx(data["force"].values, rel=1e-12)
    coarse = maps["pressure"][2].sel(x=data["x"], y=data["y"], method="nearest")
    assert (coarse.values == data["pressure"].values).all()


@pytest.mark.parametrize("nodes", [(6, 8), (7, 5)])
def test_a_node_of_a_finer_grid_takes_the_value_of_its_cell(nodes):
    coarse, fine = rs.Grid(nodes, 2e-6), rs.Grid((2 * nodes[0], 2 * nodes[1]), 1e-6)
    values = np.random.default_rng(1).normal(size=nodes)
    box = slice(0, nodes[0]), slice(0, nodes[1])
    found = DepthMaps(coarse, (box, values), (box, values)).on("pressure", fine)
    stored = xr.DataArray(values, {"x": coarse.x, "y": coarse.y}, ("x", "y"))
    # On the border of two cells, the upper one counts.
    nearest = stored.sel(x=fine.x + 1e-9, y=fine.y + 1e-9, method="nearest")
    assert (found == nearest.values).all()


def test_maps_of_a_periodic_contact(tmp_path):
    case = {
        "first": "steel",
        "maps": "all",
        "interface": {"yield_pressure": "elastic"},
        "roughness": {"kind": "self-affine", "rms": "0.1 um", "hurst": 0.8, "seed": 1},
        "grid": {"nodes": 32, "spacing": "0.5 um", "periodic": True},
        "pressure": {"values": ["0.2 GPa", "1 GPa"]},
    }
    case["roughness"]["shortest"] = "4 um"
    found = rs.run(case, out=tmp_path / "out")
    mean = found.maps["pressure"].mean(("x", "y"))
    assert mean.values == approx([0.2e9, 1e9])
    assert found.maps["nominal_pressure"].values == approx(mean.values)
    assert mean.dims == ("depth",)
    assert not found.maps["plastic_displacement"].any()


def test_the_memory_is_estimated_and_stated(case_text, cli, tmp_path, monkeypatch):
    case = parse_case('maps = "all"\n' + case_text)
    grid = case.grid.grid()
    assert case.maps_bytes(grid) == 4 * 72 * 64 * 16
    one = case.run_bytes(grid) - case.maps_bytes(grid)
    assert parse_case(case_text).run_bytes(grid) == one
    (tmp_path / "case.toml").write_text('maps = "all"\n' + case_text)
    status, said, _ = cli("check", tmp_path / "case.toml")
    assert status == 0
    assert "maps of all depths, at most" in said
    monkeypatch.setattr(memory, "available", lambda: one + 1)
    with pytest.raises(CaseError, match='maps = "all": the maps of 4 depths and the run take'):
        case.contact(tmp_path)
    refined = parse_case(
        'maps = "all"\n' + case_text.replace("[grid]", "[grid]\nrefine = [4, 2, 1, 1]")
    )
    assert refined.maps_bytes(grid) == 4 * 16 * 72 * 64 * 16
