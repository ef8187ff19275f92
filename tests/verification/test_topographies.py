"""Every scan, real or made here, does what is expected of it through the command line."""

import csv
from pathlib import Path

import pytest

from restitution.surfaces import read_surface

CASE = """
title = "{file}"
[first]
radius = "{radius}"
youngs_modulus = "70 GPa"
poissons_ratio = 0.2
density = "2500 kg/m^3"
[interface]
yield_pressure = "3 GPa"
[roughness]
kind = "measured"
file = "{file}"
{more}
[indentation]
from = "{first}"
to = "{last}"
steps = 5
[unloading]
curves = 1
"""


@pytest.fixture
def case(request, tmp_path):
    def write(name, more='detrend = "curvature"', radius="100 um", first="20 nm", last="200 nm"):
        own = isinstance(name, Path)
        file = name if own else request.getfixturevalue("topographies") / name
        text = CASE.format(file=file, more=more, radius=radius, first=first, last=last)
        (tmp_path / "case.toml").write_text(text)
        return tmp_path / "case.toml"

    return write


def expect_a_curve(cli, case, out):
    status, _, said = cli("run", case, "-o", out)
    assert status == 0, said
    with open(out / "curve.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 5
    for row in rows:
        assert 0.05 < float(row["restitution"]) <= 1
        assert float(row["residual"]) <= 1e-8


@pytest.mark.parametrize("name", ["mi-1.mi", "nid-1.nid", "di-3.di", "matrix-3.txt"])
def test_an_afm_scan_gives_a_curve_of_restitution(cli, case, tmp_path, name):
    expect_a_curve(cli, case(name), tmp_path / "out")


@pytest.mark.parametrize("suffix", [".npz", ".x3p"])
def test_a_scan_of_our_own_gives_a_curve_of_restitution(
    cli, case, own_scan, write_scan, tmp_path, suffix
):
    scan = read_surface(own_scan)
    file = write_scan(tmp_path / f"scan{suffix}", scan.height, scan.grid.size)
    expect_a_curve(cli, case(file), tmp_path / "out")


def test_an_optical_scan_has_undefined_pixels(refused, case, tmp_path):
    message = refused("run", case("sur-2.sur"), "-o", tmp_path / "out")
    assert "sur-2.sur" in message
    assert "undefined" in message
    assert 'undefined = "interpolate"' in message


def test_an_optical_scan_once_filled_is_too_coarse(cli, case, tmp_path):
    more = 'detrend = "tilt"\nundefined = "interpolate"'
    status, _, said = cli("check", case("sur-2.sur", more, radius="500 um"))
    assert status == 0
    assert "use a finer grid or scan" in said
    assert "the spacing 3.48 um" in said


def test_a_tactile_scan_is_far_too_coarse(refused, case, tmp_path):
    message = refused("run", case("tmd-1.tmd", radius="500 um"), "-o", tmp_path / "out")
    assert "tmd-1.tmd" in message or "spacing" in message
    assert "um" in message


def test_a_channel_that_is_no_height_map(refused, case, tmp_path):
    message = refused("run", case("mi-1.mi", "channel = 1"), "-o", tmp_path / "out")
    assert "mi-1.mi" in message
    assert "channel" in message


@pytest.mark.parametrize("name", ["di_corrupted.di", "nonsense_txt_file.txt"])
def test_a_file_that_is_no_topography(refused, case, tmp_path, name):
    assert name in refused("run", case(name), "-o", tmp_path / "out")
