"""From a run to a law to the input of a DEM code, with the commands of a user."""

import csv
import math
from dataclasses import replace

import numpy as np
import pytest

from restitution.dem.export import ADHESIVE, CODES, export
from restitution.laws.law_files import read_law, write_law
from tolerance import approx

CASE = """
title = "Rough glass on rough glass"
[first]
material = "glass"
radius = "300 um"
[interface]
yield_pressure = "1 GPa"
[roughness]
kind = "gaussian"
rms = "10 nm"
correlation_length = "8 um"
seed = 1
[grid]
nodes = 64
spacing = "0.8 um"
[impact]
from = "0.05 m/s"
to = "2 m/s"
steps = 7
[unloading]
curves = 1
"""


@pytest.fixture
def folder(cli, tmp_path):
    """The folder of a law made with the commands of a user."""
    (tmp_path / "case.toml").write_text(CASE)
    assert cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    status, said, _ = cli("fit-law", tmp_path / "out", "-o", tmp_path / "law")
    assert status == 0
    assert "7 velocities, 0.05 to 2 m/s" in said
    assert "restitution export" in said
    return tmp_path / "law"


@pytest.fixture
def stored(law, tmp_path):
    """Store an artificial law; return its folder."""

    def make(name, *arguments, **values):
        write_law(law(*arguments, **values), tmp_path / name)
        return tmp_path / name

    return make


def test_lammps_rebounds_as_the_law_of_the_run_says(folder, cli, lammps, tmp_path):
    found = read_law(folder)
    for k, V in enumerate(np.geomspace(found.lowest * 1.001, found.highest * 0.999, 5)):
        out = tmp_path / f"lammps-{k}"
        status, said, _ = cli(
            "export", folder, "--to", "lammps", "--velocity", f"{V} m/s", "-o", out
        )
        assert status == 0
        asked = found.at(V).restitution
        assert f"COR {asked:.4f} ± " in said
        assert lammps.pair(out, 1, 1) == approx(asked, rel=0.01)


def test_the_table_of_all_pairs(stored, law, cli, tmp_path):
    small = replace(law().first, radius=2e-4)
    folders = [stored("a"), stored("b", small), stored("c", small, small)]
    status, _, _ = cli("export", *folders, "--to", "csv", "-o", tmp_path / "all")
    assert status == 0
    with open(tmp_path / "all" / "restitution.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert {(row["type_1"], row["type_2"]) for row in rows} == {("1", "1"), ("1", "2"), ("2", "2")}
    assert len(rows) == 3 * len(law().points)
    cli("export", *folders, "--to", "csv", "--velocity", "1 m/s", "-o", tmp_path / "one")
    with open(tmp_path / "one" / "restitution.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["restitution"]) for row in rows] == approx([law().at(1.0).restitution] * 3)
    assert all(row["end_of_contact"] and row["yield_pressure_convention"] for row in rows)
    assert all(float(row["restitution_error"]) > 0 for row in rows)


@pytest.mark.parametrize("code", [code for code in CODES if code not in ADHESIVE])
def test_nothing_is_exported_beyond_the_velocities_computed(law, code):
    from restitution.errors import DomainError

    for velocity in (0.001, 11.0):
        with pytest.raises(DomainError, match="nothing is extrapolated"):
            export([law()], code, velocity)


@pytest.mark.parametrize("code", [code for code in CODES if code not in ("csv", *ADHESIVE)])
def test_what_is_not_resolved_is_said_in_the_files(law, code):
    base = law()
    points = tuple(replace(point, resolved=False) for point in base.points)
    warning = "13 of 13 depths are not resolved; refine the grid"
    coarse = replace(base, points=points, warnings=(warning,))
    for name, text in export([coarse], code, 1.0).items():
        assert "WARNING: unresolved" in text, name
        joined = " ".join(line.lstrip("#/ ") for line in text.splitlines())
        assert warning in joined, name


def test_refusals(stored, law, refused, cli, tmp_path):
    small = replace(law().first, radius=2e-4)
    one, unlike = stored("one"), stored("unlike", small)

    def said(*arguments):
        return refused("export", *arguments, "-o", tmp_path / "x")

    assert "takes one coefficient of restitution for each pair" in said(one, "--to", "lammps")
    assert "has no unit" in said(one, "--to", "yade", "--velocity", "1")
    assert "not a velocity" in said(one, "--to", "yade", "--velocity", "1 m")
    assert "nothing is extrapolated" in said(one, "--to", "edem", "--velocity", "20 m/s")
    message = said(unlike, "--to", "lammps", "--velocity", "1 m/s")
    assert "needs a separate law for every pair of particle types" in message
    other = stored("other", at=2.0)
    assert "two laws are given" in said(one, other, "--to", "csv")
    assert "holds no law" in said(tmp_path, "--to", "csv")
    assert not (tmp_path / "x").exists()
    assert cli("export", one, "--to", "csv", "-o", tmp_path / "y")[0] == 0
    assert "is not overwritten" in refused("export", one, "--to", "csv", "-o", tmp_path / "y")


@pytest.mark.parametrize(("code", "note"), [("drake", "time_step=0"), ("mujoco", "1/200")])
def test_the_limit_of_a_code_is_printed(stored, cli, tmp_path, code, note):
    _, said, _ = cli(
        "export", stored("a"), "--to", code, "--velocity", "1 m/s", "-o", tmp_path / "x"
    )
    assert note in said
    assert f"restitution_{code}" in said


def test_an_unresolved_velocity_is_warned_of(stored, law, cli, tmp_path):
    points = tuple(replace(point, resolved=False) for point in law().points)
    folder = stored("coarse", points=points)
    _, _, said = cli("export", folder, "--to", "edem", "--velocity", "1 m/s", "-o", tmp_path / "e")
    assert "the grid does not resolve the contact at 1 m/s" in said


def test_the_contact_time_is_that_of_a_hertzian_impact(law):
    """½ m* V² = ½ m* v² + (8/15) E* √R* δ^(5/2), integrated from touch to touch."""
    from scipy.integrate import quad

    from restitution.dem.pair import contact_time

    found = law()
    deepest = (15 * found.mass / (16 * found.contact_modulus * found.radius**0.5)) ** 0.4
    # The substitution δ = δ_max sin^0.8 θ removes the singularity at the turning point.
    share, _ = quad(lambda t: 0.8 * math.sin(t) ** -0.2, 0, math.pi / 2)
    assert contact_time(found) == approx(2 * deepest * share, rel=2e-3)


def test_the_comment_names_e_at_twice_the_velocity_up_to_the_end_of_the_law(law):
    """Stored velocities differ from the prescribed ones in the last digits."""
    text = export([law()], "lammps", 5.0 * (1 + 1e-8))["restitution_lammps.txt"]
    assert " at 10 m/s" in text


@pytest.mark.parametrize("code", [code for code in CODES if code not in ("csv", *ADHESIVE)])
def test_the_comment_has_a_title_only_if_the_case_has_one(law, code):
    for title in ("Beads on a plate", ""):
        text = "".join(export([law(title=title)], code, 1.0).values())
        assert ("title:" in text) == bool(title)
