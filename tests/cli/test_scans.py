"""What a case may ask of a scan: a part of it, without spikes, larger, added to others."""

import json
import re

import numpy as np
import pytest

from restitution import Grid, generate_surface
from tolerance import approx

HEAD = """
title = "From a scan"
[first]
radius = "50 um"
youngs_modulus = "70 GPa"
poissons_ratio = 0.2
density = "2500 kg/m^3"
[interface]
yield_pressure = "3 GPa"
{tables}
[indentation]
from = "20 nm"
to = "100 nm"
steps = 2
"""
SCAN = """[roughness]
kind = "measured"
file = "scan.npy"
size = "9.6 um"
{more}
{grid}
"""
GRID = '[grid]\nnodes = {nodes}\nspacing = "0.1 um"'


@pytest.fixture
def scan(tmp_path):
    """The heights, and a file of them."""
    surface = generate_surface(
        Grid((128, 128), (0.1e-6, 0.1e-6)),
        kind="gaussian",
        rms=20e-9,
        correlation_length=1e-6,
        seed=5,
    )
    height = surface.height[:96, :96]
    np.save(tmp_path / "scan.npy", height)
    return height


@pytest.fixture
def case(scan, tmp_path):
    def write(more="", grid="", tables=None):
        tables = SCAN.format(more=more, grid=grid) if tables is None else tables
        (tmp_path / "case.toml").write_text(HEAD.format(tables=tables))
        return tmp_path / "case.toml"

    return write


@pytest.fixture
def surface(cli, case, tmp_path):
    """Statistics and provenance of the surface of a case, and what was said."""

    def call(*arguments, **more):
        status, out, err = cli("surface", case(*arguments, **more), "-o", tmp_path / "out")
        assert status == 0, err
        return json.loads((tmp_path / "out" / "statistics.json").read_text()), out + err

    return call


def test_the_curvature_that_was_subtracted_is_printed(surface, scan, tmp_path):
    x = 0.1e-6 * np.arange(96)
    bowed = scan - np.add.outer((x - 5e-6) ** 2, (x - 5e-6) ** 2) / (2 * 80e-6)
    np.save(tmp_path / "scan.npy", bowed)
    found, printed = surface('detrend = "curvature"')
    assert found["provenance"]["subtracted_radius_m"] == approx(80e-6, rel=0.1)
    radius = f"{1e6 * found['provenance']['subtracted_radius_m']:.4g} µm"
    assert f"a sphere with a radius of {radius}" in " ".join(printed.split())


def test_a_sphere_left_in_the_scan_is_named_by_every_verb(cli, case, scan, tmp_path):
    x = 0.1e-6 * (np.arange(96) - 48)
    np.save(tmp_path / "scan.npy", scan - np.add.outer(x**2, x**2) / (2 * 50e-6) + 0.05 * x)
    for verb, *more in (
        ("check",),
        ("surface", "-o", tmp_path / "s"),
        ("run", "-o", tmp_path / "r"),
    ):
        status, out, err = cli(verb, case(), *more)
        assert status == 0
        words = " ".join((out + err).split())
        assert "scan.npy: the scan is curved like a sphere with a radius of" in words
        assert "R* = 25 µm contains: set roughness.detrend" in words
    saved = json.loads((tmp_path / "s" / "statistics.json").read_text())
    assert any("the scan is curved" in line for line in saved["warnings"])


def test_spikes_are_named_by_every_verb_and_no_finer_grid_is_advised(cli, case, scan, tmp_path):
    spoiled = scan.copy()
    spoiled[8::16, 8::16] += 0.4e-6
    np.save(tmp_path / "scan.npy", spoiled)
    for verb, *more in (
        ("check",),
        ("surface", "-o", tmp_path / "s"),
        ("run", "-o", tmp_path / "r"),
    ):
        status, out, err = cli(verb, case(), *more)
        assert status == 0
        words = " ".join((out + err).split())
        assert "scan.npy: 36 spikes of up to 4" in words
        assert "roughness.outliers = 8" in words
        assert "converge" not in words
        assert "rms slope of the surface" not in words
    _, out, err = cli("check", case("outliers = 8"))
    assert "spikes of up to" not in out + err


def test_heights_in_a_wrong_unit_are_refused(refused, cli, case, scan, tmp_path):
    np.save(tmp_path / "scan.npy", 100 * scan)
    message = refused("check", case())
    assert "and half-space theory means nothing above 3" in message
    assert re.search(r"check the unit of the heights in \S*scan\.npy and roughness\.size", message)
    status, _, err = cli("surface", case(), "-o", tmp_path / "s")
    assert status == 0
    assert "check the unit of the heights in" in " ".join(err.split())


def test_lengths_of_a_surface_have_prefixes(cli, case, tmp_path):
    _, out, _ = cli("surface", case(), "-o", tmp_path / "s")
    assert re.search(r"root mean square height Sq +\d\d\.\d+ +nm", out)
    assert re.search(r"rms curvature +[\d.]+ +1/µm", out)
    assert "_m" not in out.split("In ")[0]


def test_a_part_of_a_scan(surface, scan):
    found, _ = surface('crop = { x = ["-2 um", "3.05 um"] }')
    assert found["provenance"]["cropped"] == "51 x 96 of 96 x 96 pixels"
    part = scan[28:79]
    assert found["Sq_m"] == approx(part.std())


def test_spikes_are_taken_out(surface, scan, tmp_path):
    spoiled = scan.copy()
    spoiled[40, 41] = 1e-6
    np.save(tmp_path / "scan.npy", spoiled)
    found, printed = surface("outliers = 8")
    assert found["provenance"]["outliers"] == 1
    assert "scan.npy: 1 outlier replaced" in printed
    assert found["Sz_m"] < 2e-7


def test_a_twin_is_run_and_labelled(cli, case, tmp_path):
    file = case('extend = "twin"\nseed = 3', GRID.format(nodes=200))
    status, _, said = cli("run", file, "-o", tmp_path / "out")
    assert status == 0
    assert "statistical twin (seed 3) of the scan of 9.6 x 9.6 um, not the scan itself" in said
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert any("not the scan itself" in line for line in summary["warnings"])
    assert summary["surface"]["extension"] == "statistical twin"
    assert summary["surface"]["scan_Sq_m"] == approx(summary["surface_statistics"]["Sq_m"], rel=0.1)


def test_twins_make_an_ensemble(cli, case, tmp_path):
    file = case('extend = "twin"\nseed = 3\nrealisations = 2', GRID.format(nodes=200))
    status, said, _ = cli("run", file, "-o", tmp_path / "out")
    assert status == 0
    assert "2 depths of 2 curves" in said
    assert (tmp_path / "out" / "realisation-2" / "curve.csv").exists()


def test_the_channel_and_the_other_height_channels_are_named(surface, topographies):
    pytest.importorskip("SurfaceTopography")
    file = (topographies / "di-3.di").as_posix()
    tables = SCAN.format(more="", grid="").replace("scan.npy", file)
    _, printed = surface(tables=re.sub("size = .*", "", tables))
    words = "those of channel 0 ('ZSensor'); roughness.channel selects another height channel: 3"
    assert words in " ".join(printed.split())


def test_mirrored_tiles_are_labelled(cli, case):
    status, _, said = cli("check", case('extend = "mirror"', GRID.format(nodes=200)))
    assert status == 0
    assert "2.08 x 2.08 tiles of the scan and its mirror images" in said


def test_two_surfaces_are_added(surface, tmp_path, scan):
    np.save(tmp_path / "other.npy", 2 * scan)
    one = SCAN.format(more="", grid="").replace("[roughness]", "[[roughness]]")
    found, _ = surface(tables=one + one.replace("scan.npy", "other.npy") + GRID.format(nodes=96))
    assert found["Sq_m"] == approx(3 * scan.std())
    assert found["provenance"]["file"].count("npy") == 2


def test_a_scan_and_a_generated_surface_are_added(surface, scan):
    one = SCAN.format(more="", grid="").replace("[roughness]", "[[roughness]]")
    two = '[[roughness]]\nkind = "gaussian"\nrms = "30 nm"\nseed = 1\ncorrelation_length = "2 um"\n'
    found, _ = surface(tables=one + two + GRID.format(nodes=96))
    assert found["Sq_m"] == approx(np.hypot(scan.std(), 30e-9), rel=0.1)


def test_a_scan_may_be_refined_on_its_own_pixels(surface, scan):
    found, _ = surface(grid="[grid]\nrefine = 2")
    assert found["provenance"]["refined"] == 2
    assert found["Sq_m"] == approx(scan.std(), rel=0.02)


@pytest.mark.parametrize(
    ("more", "grid", "words"),
    [
        ('extend = "twin"', GRID.format(nodes=200), "needs a seed"),
        ('extend = "wrap"', GRID.format(nodes=200), 'roughness.extend: "wrap" should be'),
        (
            'extend = "mirror"\nseed = 1',
            GRID.format(nodes=200),
            'seed applies only to extend = "twin"',
        ),
        (
            'extend = "twin"\nseed = 1\nplace = 2',
            GRID.format(nodes=200),
            "remove place, or vary seed",
        ),
        ("realisations = 0", "", "roughness.realisations: 0 should be greater than or equal to 1"),
        ('extend = "mirror"', "", "because roughness.extend does not"),
        ('extend = "mirror"', "[grid]\nrefine = 2", "grid: nodes and spacing are missing"),
        ("", '[grid]\nspacing = "1 um"', 'the key "nodes" is missing'),
        ("", GRID.format(nodes=200), "a larger scan, or roughness.extend"),
        (
            "",
            "[grid]\nrefine = 3",
            "grid.refine: 3 should be 1, 2, 4, 8, 16, 32 or 64, a list of these",
        ),
        ("outliers = -1", "", "roughness.outliers: -1 should be greater than 0"),
        ("outliers = 0.1", "", "roughness.outliers: "),
        ('crop = { x = ["1 um"] }', "", "roughness.crop.x: ['1 um'] should be a list of two"),
        ('crop = { x = ["2 um", "1 um"] }', "", "the first of the two positions must be smaller"),
        (
            'crop = { x = ["20 um", "30 um"] }',
            "",
            "roughness.crop.x: the range from 20 to 30 um extends beyond the scan",
        ),
        (
            'extend = "twin"\nseed = 1',
            '[grid]\nnodes = 20\nspacing = "5 um"',
            "cells of 5 um cannot resolve any wave of a scan of 9.6 x 9.6 um; use a smaller "
            "grid.spacing",
        ),
        (
            'extend = "twin"\nseed = 1\ncrop = { y = ["0 um", "1 um"] }',
            GRID.format(nodes=200),
            'at least 16 x 16, or set roughness.extend = "mirror"',
        ),
        ('crop = { z = ["1 um", "2 um"] }', "", "roughness.crop.z: unknown key; known keys: x, y"),
        ("crop = { x = [1, 2] }", "", "1 has no unit"),
    ],
)
def test_what_cannot_be_asked_of_a_scan(refused, case, more, grid, words):
    assert words in refused("check", case(more, grid))


def test_a_flat_scan_has_no_twin(refused, case, tmp_path):
    np.save(tmp_path / "scan.npy", np.zeros((96, 96)))
    message = refused("check", case('extend = "twin"\nseed = 1', GRID.format(nodes=200)))
    assert 'leave roughness.extend out, or set roughness.extend = "mirror"' in message


def test_a_scan_without_size_asks_for_the_key(refused, case, tmp_path):
    tables = SCAN.format(more="", grid="").replace('size = "9.6 um"\n', "")
    message = refused("check", case(tables=tables))
    assert 'such as roughness.size = ["10 um", "10 um"]' in message


def test_several_surfaces_need_a_grid_and_one_number_of_realisations(refused, case):
    one = SCAN.format(more="", grid="").replace("[roughness]", "[[roughness]]")
    assert "only a single measured surface defines" in refused("check", case(tables=one * 2))
    table = '[[roughness]]\nkind = "gaussian"\nrms = "30 nm"\nseed = 1\ncorrelation_length = "2 um"'
    two = f"{table}\nrealisations = 2\n{table}\nrealisations = 3\n" + GRID.format(nodes=96)
    assert "roughness.realisations: differs" in refused("check", case(tables=two))
    file = case()
    file.write_text(
        file.read_text().replace("[first]", "roughness = 3\n[first]", 1).split("[rough")[0]
    )
    assert "roughness: 3 should be a table" in refused("check", file)


def test_a_wrong_key_of_the_second_surface_is_named_with_its_number(refused, case):
    table = '[[roughness]]\nkind = "gaussian"\nrms = "{}"\nseed = 1\ncorrelation_length = "{}"\n'
    good = table.format("30 nm", "2 um")
    for wrong, words in (
        (table.format("30", "2 um"), "roughness[2].rms: "),
        (table.format("30 nm", "20 um"), "table 2 of [[roughness]]: roughness.correlation_length"),
    ):
        assert words in refused("check", case(tables=good + wrong + GRID.format(nodes=96)))


@pytest.mark.parametrize(("nodes", "mirrored"), [(20, None), (96, "covers 30% of the grid")])
def test_the_mirror_image_at_a_place_near_an_edge_is_noted(surface, nodes, mirrored):
    """The middle of the grid is 2 and 27 of 96 pixels away from the middle of the scan."""
    found, printed = surface("place = 4", GRID.format(nodes=nodes))
    notice = found["provenance"].get("notice")
    assert (notice is None) == (mirrored is None)
    if mirrored:
        assert mirrored in notice
        assert mirrored in " ".join(printed.split())
