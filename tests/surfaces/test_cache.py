import os
from dataclasses import replace

import numpy as np
import pytest

from restitution.numerics.grid import Grid
from restitution.surfaces import Surface, cache

GRID = Grid((3, 4), (1e-6, 2e-6))


class Maker:
    """Makes a surface and counts the calls."""

    def __init__(self):
        self.made = 0

    def __call__(self):
        self.made += 1
        height = np.arange(12.0).reshape(3, 4) / 7
        return Surface(height, GRID, {"kind": "µ", "rms_m": 0.1, "seed": 3})


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(cache, "_LONG", -1.0)
    return tmp_path / "restitution" / "surfaces"


def test_a_surface_that_took_long_is_made_once(folder):
    make = Maker()
    one, same = (cache.kept({"seed": 1}, make) for _ in range(2))
    assert make.made == 1
    np.testing.assert_array_equal(one.height, same.height)
    assert (one.grid, dict(one.provenance)) == (same.grid, dict(same.provenance))
    cache.kept({"seed": 2}, make)
    assert make.made == 2
    assert len(list(folder.iterdir())) == 2


def test_what_is_made_quickly_or_large_is_not_kept(folder, monkeypatch):
    monkeypatch.setattr(cache, "_LARGEST", 10)
    cache.kept({}, Maker())
    monkeypatch.setattr(cache, "_LONG", 60.0)
    monkeypatch.setattr(cache, "_LARGEST", 2**20)
    cache.kept({}, Maker())
    assert not folder.exists()


def test_another_version_makes_it_anew(folder, monkeypatch):
    make = Maker()
    cache.kept({}, make)
    monkeypatch.setattr(cache, "version", lambda _: "9")
    cache.kept({}, make)
    assert make.made == 2


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 what", None])
def test_damaged_files_are_made_anew(folder, damage):
    make = Maker()
    cache.kept({}, make)
    (file,) = folder.iterdir()
    content = file.read_bytes()
    file.write_bytes(content[: len(content) // 2] if damage is None else damage)
    assert cache.kept({}, make).height[0, 1] == 1 / 7
    assert make.made == 2
    cache.kept({}, make)
    assert make.made == 2


def test_a_folder_that_cannot_be_written_is_let_be(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    monkeypatch.setattr(cache, "_LONG", -1.0)
    assert cache.kept({}, Maker()).height.shape == (3, 4)


def test_the_oldest_make_room(folder, monkeypatch):
    for number in range(3):
        cache.kept({"n": number}, Maker())
    files = sorted(folder.iterdir())
    for age, file in enumerate(files):
        os.utime(file, (1000 - age, 1000 - age))
    size = files[0].stat().st_size
    monkeypatch.setattr(cache, "_FILES", replace(cache._FILES, most=2 * size + 100))
    cache.kept({"n": 3}, Maker())
    left = set(folder.iterdir())
    assert files[0] in left  # the youngest of the three
    assert files[2] not in left
    assert sum(file.stat().st_size for file in left) <= 2 * size + 100


def test_cases_use_it(folder, case_text, tmp_path, monkeypatch):
    from restitution.case import generated, measured
    from restitution.case.case_file import parse_case

    np.save(tmp_path / "scan.npy", 1e-8 * np.random.default_rng(1).standard_normal((40, 40)))
    begin, end = case_text.index("[roughness]"), case_text.index("[grid]")
    rough = (
        '[roughness]\nkind = "measured"\nfile = "scan.npy"\nsize = "20 um"\n'
        'extend = "twin"\nseed = 1\n'
    )
    for text in (case_text, case_text[:begin] + rough + case_text[end:]):
        first = parse_case(text).surface(tmp_path)
        with monkeypatch.context() as patch:
            for module, name in ((generated, "generate_surface"), (measured, "extend")):
                patch.setattr(module, name, lambda *_, **__: pytest.fail("made again"))
            again = parse_case(text).surface(tmp_path)
        np.testing.assert_array_equal(first.height, again.height)
        assert first.provenance == again.provenance
    np.save(tmp_path / "scan.npy", 1e-8 * np.random.default_rng(2).standard_normal((40, 40)))
    assert not np.array_equal(parse_case(text).surface(tmp_path).height, first.height)
