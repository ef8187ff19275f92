"""`restitution fit`: its files, what it prints, and what it refuses."""

import csv
import json
import re

import pytest

from restitution.case.case_file import read_case
from restitution.fit.measured import read_measured
from tolerance import approx

CASE = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "1500 MPa"
[grid]
nodes = 48
spacing = "0.8 um"
[indentation]
values = ["50 nm"]
[unloading]
curves = 0
"""
# Of smooth spheres that yield at 900 MPa (`restitution run`), rounded.
MEASURED = "velocity_m_per_s,restitution\n0.02,0.8\n0.05,0.7\n0.1,0.63\n0.05,0.71\n"


@pytest.fixture
def files(tmp_path):
    """The case and the table, in files."""
    (tmp_path / "case.toml").write_text(CASE)
    (tmp_path / "m.csv").write_text(MEASURED)
    return tmp_path


def call(cli, folder, free="yield_pressure", **changes):
    given = {"case": folder / "case.toml", "out": folder / "out", **changes}
    table = folder / "m.csv"
    return cli("fit", table, "--case", given["case"], "--free", free, "-o", given["out"])


def test_one_point_is_said_in_the_singular(cli, files):
    (files / "m.csv").write_text("velocity_m_per_s,restitution,restitution_std\n0.05,0.7,0.01\n")
    status, said, _ = call(cli, files)
    assert status == 0
    assert "\n1 point, rms residual of COR" in said


def test_one_combined_interval_comes_first_and_keys_are_whole(cli, files, monkeypatch):
    from restitution.cli import console

    (files / "m.csv").write_text(MEASURED + "0.01,1.0035\n")
    monkeypatch.setattr(console.answers, "_width", 80)
    status, said, _ = call(cli, files)
    assert status == 0
    lines = said.splitlines()
    found = json.loads((files / "out" / "fit.json").read_text())["parameters"][0]
    first, second = (
        [1e6 * float(word) for word in re.findall(r"(\S+) MPa", line)] for line in lines[:2]
    )
    assert lines[0].startswith("interface.yield_pressure = ")
    assert lines[0].endswith("(data and model)")
    assert first == approx([found["value"], found["low"], found["high"]], rel=1e-3)
    assert lines[1].startswith("  of the data alone: ")
    assert second == approx([found["low_from_data"], found["high_from_data"]], rel=1e-3)
    assert first[1] < second[0] < second[1] < first[2]
    assert "no column restitution_std: every point is assumed to have the standard" in said
    assert "1 of the measured COR are above 1; they are not cut" in said


def test_files_belong_together_and_the_fitted_case_runs(cli, files):
    status, said, _ = call(cli, files)
    out = files / "out"
    assert status == 0
    assert {path.name for path in out.iterdir()} == {
        "fit.json",
        "fit.csv",
        "fit.png",
        "case.toml",
        "SHA256SUMS",
    }
    found = json.loads((out / "fit.json").read_text())
    (parameter,) = found["parameters"]
    assert parameter["key"] == "interface.yield_pressure"
    assert parameter["low"] < parameter["value"] < parameter["high"]
    assert parameter["written"] in said
    assert found["case"] == CASE
    case, _ = read_case(out / "case.toml")
    assert case.interface.yield_pressure == approx(parameter["value"])
    assert case.depths() == [0.02, 0.05, 0.1]
    # The table of the fit is one of measured values, too.
    again = read_measured(out / "fit.csv")
    assert again.velocity == approx([0.02, 0.05, 0.05, 0.1])
    status, said, _ = cli("run", out / "case.toml", "-o", files / "run")
    assert status == 0
    fitted, computed = (
        [float(row[column]) for row in csv.DictReader(path.read_text().splitlines())]
        for path, column in (
            (out / "fit.csv", "fitted_restitution"),
            (files / "run" / "curve.csv", "restitution"),
        )
    )
    assert computed == approx([fitted[0], fitted[1], fitted[3]], rel=0.005)


@pytest.mark.parametrize(
    ("free", "table", "words"),
    [
        ("xyz", MEASURED, "--free: xyz is not a key of the case"),
        (",", MEASURED, "--free: names no key"),
        ("yield_pressure", "velocity,restitution\n1,0.5\n", "column velocity_m_per_s"),
        ("yield_pressure", MEASURED.replace("0.8", "1.8"), "is above 1.06"),
        (
            "yield_pressure",
            MEASURED[:38],
            "the noise cannot be estimated from residuals",
        ),
    ],
)
def test_bad_input_is_refused_in_one_line(refused, files, free, table, words):
    (files / "m.csv").write_text(table)
    case, out = files / "case.toml", files / "out"
    assert words in refused("fit", files / "m.csv", "--case", case, "--free", free, "-o", out)
    assert not out.exists()


def test_a_case_without_density_is_refused(refused, files):
    (files / "case.toml").write_text(CASE.replace('density = "7850 kg/m^3"', ""))
    said = refused(
        "fit", files / "m.csv", "--case", files / "case.toml", "--free", "rms", "-o", files / "out"
    )
    assert "rms is not a key" in said
    said = refused(
        *("fit", files / "m.csv", "--case", files / "case.toml"),
        *("--free", "yield_pressure", "-o", files / "out"),
    )
    assert "first.density: is missing" in said


def test_nothing_is_overwritten(refused, files):
    out = files / "out"
    out.mkdir()
    (out / "mine").write_text("")
    arguments = ("--case", files / "case.toml", "--free", "yield_pressure", "-o", out)
    assert "is not empty" in refused("fit", files / "m.csv", *arguments)
    assert (out / "mine").exists()


INDENTS = "depth_nm,hardness_GPa\n" + "".join(
    f"{h},{1.2 * (1 + 400 / h) ** 0.5:.5g}\n" for h in (60, 100, 200, 400, 1000, 3000)
)


def test_indents_give_the_size_effect(cli, files):
    (files / "h.csv").write_text(INDENTS)
    out = files / "out"
    status, said, _ = cli("fit", files / "h.csv", "--case", files / "case.toml", "-o", out)
    assert status == 0
    assert "H0 = 1.2 GPa, 95 % interval 1.2 GPa to 1.2 GPa" in said
    assert 'In [interface] of a case: yield_pressure = "1.2 GPa", size_effect = "0.4 um"' in said
    found = json.loads((out / "fit.json").read_text())
    assert found["size_effect_m"]["value"] == approx(400e-9, rel=1e-3)
    assert found["size_effect_m"]["low"] <= 400.2e-9
    case, _ = read_case(out / "case.toml")
    assert case.yielding().size_effect == approx(400e-9, rel=1e-3)
    assert case.yielding().hardness == approx(1.2e9, rel=1e-3)


@pytest.mark.parametrize(
    ("more", "words"),
    [(("--free", "rms"), "leave --free out"), ((), "rises with depth, from 1.5 GPa to 5.5 GPa")],
)
def test_indents_that_cannot_be_fitted(refused, files, more, words):
    rising = "".join(f"{100 * k},{k}\n" for k in range(1, 7))
    (files / "h.csv").write_text("depth_nm,hardness_GPa\n" + rising)
    assert words in refused("fit", files / "h.csv", *more, "-o", files / "out")
    assert not (files / "out").exists()


@pytest.mark.parametrize("given", ["--case", "--free"])
def test_restitution_needs_a_case_and_keys(refused, files, given):
    more = {"--case": ("--free", "rms"), "--free": ("--case", files / "case.toml")}[given]
    said = refused("fit", files / "m.csv", *more, "-o", files / "out")
    assert f"{given}: is missing" in said
