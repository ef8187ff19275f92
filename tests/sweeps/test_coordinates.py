"""Swept values as coordinates: quantities with their units, numbers, and text."""

import json

import pytest
import xarray as xr

from restitution.sweeps.sweep import coordinate
from tolerance import approx


@pytest.mark.parametrize(
    ("values", "units", "numbers"),
    [
        (["0.1 um", "200 nm"], "m", [1e-7, 2e-7]),
        (["1 GPa", "2e9 Pa"], "Pa", [1e9, 2e9]),
        (["2.5 g/cm^3"], "kg m-3", [2500.0]),
        (["10 mN"], "N", [0.01]),
        (["0 J/m^2", "50 mN/m"], "J m-2", [0.0, 0.05]),
        (["10 cm/s"], "m s-1", [0.1]),
        (["180 deg"], "rad", [3.141592653589793]),
    ],
)
def test_quantities_are_numbers_with_units(values, units, numbers):
    found, attributes = coordinate(values)
    assert found == approx(numbers, rel=1e-12, abs=0)
    assert attributes["units"] == units
    assert json.loads(attributes["as_written"]) == values


@pytest.mark.parametrize(
    ("values", "stored"),
    [
        ([1, 2], [1, 2]),
        ([0.2, 1], [0.2, 1]),
        (["seed", "hertzian"], ["seed", "hertzian"]),
        (["2.8 Y", "hardness"], ["2.8 Y", "hardness"]),
        (["1 GPa", "hardness"], ["1 GPa", "hardness"]),
        (["1 um", "1 N"], ["1 um", "1 N"]),
        ([True, False], ["true", "false"]),
        ([["1 um", "2 um"]], ['["1 um", "2 um"]']),
        ([2, "auto"], ["2", "auto"]),
    ],
)
def test_numbers_stay_numbers_and_the_rest_text(values, stored, tmp_path):
    found, attributes = coordinate(values)
    assert found == stored
    assert "units" not in attributes
    data = xr.Dataset(coords={"key": ("key", found, attributes)})
    data.to_netcdf(tmp_path / "study.nc", engine="netcdf4")
    with xr.open_dataset(tmp_path / "study.nc") as read:
        assert read["key"].values.tolist() == stored
