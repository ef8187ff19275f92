"""`restitution new`: starting files that are valid, run, and never replace a file."""

import re

import numpy as np
import pytest

from restitution.case.case_file import read_case
from restitution.sweeps.sweep import read_study
from tolerance import approx


def small(text):
    """The case in `text` on a quarter of the nodes, at two depths."""
    for nodes in ("200", "256"):
        text = text.replace(f"nodes = {nodes}", "nodes = 64")
    text = text.replace('spacing = "0.5 um"', 'spacing = "2 um"')
    text = text.replace("correlation_length = ", "correlation_length = '12 um' # ")
    return text.replace("steps = 8", "steps = 2").replace("curves = 8", "curves = 2")


@pytest.mark.parametrize("option", [[], ["--dem"], ["--study"]], ids=["case", "dem", "study"])
def test_a_new_file_is_valid_as_it_stands(cli, tmp_path, option):
    file = tmp_path / "new.toml"
    status, said, _ = cli("new", *option, "-o", file)
    assert status == 0
    assert f"Next: restitution check {file}" in said
    status, said, warned = cli("check", file)
    assert status == 0
    assert "is valid." in said
    assert not warned


@pytest.mark.parametrize("option", [[], ["--dem"]], ids=["case", "dem"])
def test_a_new_case_runs(cli, tmp_path, option):
    file = tmp_path / "new.toml"
    cli("new", *option, "-o", file)
    file.write_text(small(file.read_text()))
    status, said, warned = cli("run", file, "-o", tmp_path / "out")
    assert status == 0, warned
    assert "2 depths" in said
    assert read_case(file)[0].depths()[-1] > 0


def test_a_new_study_runs(cli, tmp_path):
    file = tmp_path / "new.toml"
    cli("new", "--study", "-o", file)
    text = small(file.read_text()).replace('["0.02 um", "0.05 um", "0.1 um"]', '["0.05 um"]')
    file.write_text(text)
    assert len(read_study(file).cases) == 2
    status, said, _ = cli("study", file, "-o", tmp_path / "out", "--workers", 1)
    assert status == 0
    assert "2 of 2 cases" in said


def test_a_new_case_with_a_scan_asks_for_the_scan(cli, refused, tmp_path):
    file = tmp_path / "new.toml"
    assert cli("new", "--scan", "-o", file)[0] == 0
    assert "scan.npy: there is no such file" in refused("check", file)
    assert file.read_text().count("# fill in") == 5
    x = np.linspace(-50e-6, 50e-6, 100)
    scan = 20e-9 * np.cos(2e5 * x[:, None]) * np.cos(3e5 * x)
    np.save(tmp_path / "scan.npy", scan - (x[:, None] ** 2 + x**2) / 1e-3)
    status, said, warned = cli("check", file)
    assert status == 0
    assert "100 x 100" in said
    assert "The case is valid." in said
    assert not warned
    status, said, warned = cli("run", file, "-o", tmp_path / "out")
    assert status == 0, warned
    assert "8 depths" in said
    velocities = read_case(file)[0].impact.velocities()
    assert (velocities[0], velocities[-1]) == approx((0.05, 1.0))


def test_the_commented_lines_of_a_case_with_a_scan_are_valid(cli, tmp_path):
    """With all lines, and a second scan, the case gives the yield strength and a grid."""
    file = tmp_path / "new.toml"
    cli("new", "--scan", "-o", file)
    text = re.sub(r"^# (?=[a-z_]+ = |\[)", "", file.read_text(), flags=re.MULTILINE)
    begin, end = text.index("[roughness]"), text.index("[grid]")
    table = text[begin:end].replace("[roughness]", "[[roughness]]", 1)
    file.write_text(text[:begin] + 2 * table + text[end:])
    case = read_case(file)[0]
    assert case.interface.yield_strength == approx(3300e6)
    assert (len(case.roughness), case.grid.nodes) == (2, (256, 256))


def test_a_new_file_has_a_name_of_its_own(cli, refused, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert cli("new")[0] == 0
    assert cli("new", "--study")[0] == 0
    assert {path.name for path in tmp_path.iterdir()} == {"case.toml", "study.toml"}
    (tmp_path / "case.toml").write_text("mine")
    assert "case.toml: already exists and is not overwritten" in refused("new")
    assert (tmp_path / "case.toml").read_text() == "mine"


def test_a_new_file_is_of_one_kind(refused, tmp_path):
    assert "--dem, --scan: choose one" in refused("new", "--dem", "--scan", "-o", tmp_path / "a")
    assert not (tmp_path / "a").exists()


def test_an_invalid_study_is_refused(cli, refused, tmp_path):
    file = tmp_path / "new.toml"
    cli("new", "--study", "-o", file)
    file.write_text(file.read_text().replace('"0.1 um"]', '"0.1 kg"]'))
    assert 'roughness.rms = "0.1 kg"' in refused("check", file)


POWDER = ("--set", "radius=2 um", "--set", "rms=1 nm", "--set", "correlation_length=0.1 um")


def test_a_powder_is_resolved_at_every_velocity(cli, tmp_path):
    file = tmp_path / "powder.toml"
    assert cli("new", "--powder", *POWDER, "-o", file)[0] == 0
    text = file.read_text()
    assert 'title = "silica, 2 um, Rq 1 nm"' in text
    status, said, warned = cli("check", file)
    assert status == 0
    assert "The case is valid." in said, warned
    low = re.search(r'from = "(.+)"', text)[1]
    text = re.sub(r"from = .*\nto = .*\nsteps = 6", f'velocity = ["{low}", "0.1 m/s"]', text)
    file.write_text("total_error = false\n" + text)
    status, said, warned = cli("run", file, "-o", tmp_path / "out")
    assert status == 0, warned
    assert "not resolved" not in warned
    assert re.findall(r" (yes|no) \n", said) == ["yes", "yes"]
    assert "pull-off force" in said


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (("--set", "diameter=2 um", "--powder"), '"diameter=2 um" should be KEY=VALUE with one of'),
        (("--set", "radius", "--powder"), "should be KEY=VALUE"),
        (("--set", "radius=5", "--powder"), '"5" has no unit'),
        (("--set", "radius=5 um"), "--set: belongs to --powder"),
        (("--powder", "--dem"), "choose one of them"),
        (
            ("--set", "radius=50 um", "--set", "rms=200 nm", "--powder"),
            "does not contain the contact",
        ),
    ],
)
def test_a_powder_that_cannot_be_is_refused(refused, tmp_path, given, words):
    assert words in refused("new", *given, "-o", tmp_path / "powder.toml")
    assert not (tmp_path / "powder.toml").exists()
