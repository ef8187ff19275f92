"""Bad files of measured surfaces: one clear line that names the file or the remedy."""

import os
import pickle

import numpy as np
import pytest


def measured(case_text, line):
    """The small case with a measured surface instead of its own."""
    begin, end = case_text.index("[roughness]"), case_text.index("[grid]")
    return case_text[:begin] + f'[roughness]\nkind = "measured"\n{line}\n' + case_text[end:]


@pytest.mark.parametrize(
    ("name", "content", "remedy"),
    [
        ("nan.npy", np.where(np.eye(90) > 0, np.nan, 0.0), 'roughness.undefined = "interpolate"'),
        ("inf.npy", np.where(np.eye(90) > 0, np.inf, 0.0), 'roughness.undefined = "interpolate"'),
        ("line.npy", np.zeros(90), "line.npy"),
        ("cube.npy", np.zeros((9, 9, 9)), "cube.npy"),
        ("complex.npy", np.zeros((90, 90), complex), "complex.npy"),
        ("small.npy", np.zeros((20, 20)), "grid"),
    ],
)
def test_an_array_that_is_no_surface(refused, case_text, tmp_path, name, content, remedy):
    np.save(tmp_path / name, content)
    edge = "4 um" if name == "small.npy" else "45 um"
    line = f'file = "{name}"\nsize = ["{edge}", "{edge}"]'
    (tmp_path / "case.toml").write_text(measured(case_text, line))
    assert remedy in refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")


@pytest.mark.parametrize("name", ["x" * 300 + ".npy", "a\\u0000b.npy"])
def test_a_name_that_no_file_has(refused, case_text, tmp_path, name):
    line = f'file = "{name}"\nsize = "45 um"'
    (tmp_path / "case.toml").write_text(measured(case_text, line))
    assert "check the path" in refused("check", tmp_path / "case.toml")


def test_a_ragged_text_matrix(refused, case_text, tmp_path):
    (tmp_path / "ragged.csv").write_text("0,0,0\n0,0\n")
    line = 'file = "ragged.csv"\nsize = "45 um"'
    (tmp_path / "case.toml").write_text(measured(case_text, line))
    assert "ragged.csv" in refused("surface", tmp_path / "case.toml", "-o", tmp_path / "out")


class Bomb:
    """Leaves a mark when unpickled."""

    def __init__(self, mark):
        self.mark = mark

    def __reduce__(self):
        return os.mkdir, (str(self.mark),)


def test_a_pickled_array_is_refused_and_nothing_in_it_runs(refused, case_text, tmp_path):
    np.save(tmp_path / "bomb.npy", np.array([Bomb(tmp_path / "mark")], dtype=object))
    (tmp_path / "raw.npy").write_bytes(pickle.dumps(Bomb(tmp_path / "mark")))
    for name in ("bomb.npy", "raw.npy"):
        line = f'file = "{name}"\nsize = "45 um"'
        (tmp_path / "case.toml").write_text(measured(case_text, line))
        assert name in refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert not (tmp_path / "mark").exists()


def test_a_damaged_array(refused, case_text, tmp_path):
    np.save(tmp_path / "whole.npy", np.zeros((90, 90)))
    (tmp_path / "cut.npy").write_bytes((tmp_path / "whole.npy").read_bytes()[:5000])
    (tmp_path / "case.toml").write_text(measured(case_text, 'file = "cut.npy"\nsize = "45 um"'))
    assert "cut.npy" in refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")


def test_a_measured_file_is_relative_to_the_case(cli, case_text, tmp_path, monkeypatch):
    (tmp_path / "data").mkdir()
    np.save(tmp_path / "data" / "flat.npy", np.zeros((90, 90)))
    text = measured(case_text, 'file = "flat.npy"\nsize = ["45 um", "54 um"]')
    (tmp_path / "data" / "case.toml").write_text(text)
    monkeypatch.chdir(tmp_path)
    assert cli("check", "data/case.toml")[0] == 0


def test_only_the_part_that_is_used_must_be_complete(cli, refused, case_text, tmp_path):
    height = np.zeros((90, 90))
    height[:20] = np.nan
    np.save(tmp_path / "rim.npy", height)
    line = 'file = "rim.npy"\nsize = ["60 um", "60 um"]\nheight_unit = "nm"\n'
    (tmp_path / "case.toml").write_text(measured(case_text, line))
    assert "set roughness.crop = { x = [" in refused("check", tmp_path / "case.toml")
    grid = 'crop = { x = ["-14 um", "29 um"] }\nextend = "mirror"'
    (tmp_path / "case.toml").write_text(measured(case_text, line + grid))
    assert cli("check", tmp_path / "case.toml")[0] == 0


@pytest.mark.parametrize(
    ("scale", "line", "remedy"),
    [
        (1.0, 'size = "45 um"', 'set roughness.height_unit = "um"'),
        (1e-15, 'size = "45 um"', 'set roughness.height_unit = "um"'),
        (1e-9, 'size = "45 um"\nheight_unit = "V"', "is not a unit of length; give m, mm, um"),
    ],
)
def test_heights_in_an_unlikely_unit(refused, case_text, tmp_path, scale, line, remedy):
    np.save(tmp_path / "a.npy", scale * np.random.default_rng(1).normal(size=(90, 90)))
    (tmp_path / "case.toml").write_text(measured(case_text, f'file = "a.npy"\n{line}'))
    assert remedy in refused("check", tmp_path / "case.toml")


def test_a_size_that_replaces_the_file_is_a_warning(cli, case_text, tmp_path):
    np.savez(tmp_path / "a.npz", height=np.zeros((90, 90)), size=np.array([80e-6, 80e-6]))
    line = 'file = "a.npz"\nsize = "45 um"'
    (tmp_path / "case.toml").write_text(measured(case_text, line))
    _, out, err = cli("check", tmp_path / "case.toml")
    assert "it is read as 45 x 45 um, because 'size' says so" in out + err
