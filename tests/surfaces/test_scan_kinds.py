"""The table of `docs/scan-files.md`: reasons of refusals, and the number of kinds."""

import re
import zipfile
from pathlib import Path

import pytest

from restitution.surfaces.reading.signatures import _SIGNATURES

pytest.importorskip("SurfaceTopography", reason="the extra 'measured' is not installed")

PAGE = Path(__file__).parents[2] / "docs" / "scan-files.md"
ROWS = re.findall(r"^\| (?!kind|-)(.*?) \|.*\| (.*?) \|$", PAGE.read_text("utf-8"), re.MULTILINE)
REFUSED = {what.removeprefix("refused: ") for _, what in ROWS if what.startswith("refused: ")}
ARCHIVES = {
    "meta.yml": "is a contact.engineering container; unpack it",
    "header.properties": "holds force curves (JPK)",
    "readme.txt": "is an archive (zip) of 1 files, such as readme.txt; unpack it",
}


def test_there_are_many_kinds():
    assert len({kind for kind, _ in ROWS}) >= 60


@pytest.mark.parametrize("signature", _SIGNATURES, ids=lambda each: f"{each[1][:12]}")
@pytest.mark.parametrize("suffix", [".dat2", ".sur"])
def test_a_kind_without_reader_is_named(tmp_path, refusal, signature, suffix):
    offset, magic, what, remedy = signature
    path = tmp_path / f"a{suffix}"
    path.write_bytes(bytes(offset) + magic + bytes(range(1, 200)))
    assert refusal(path).startswith(f"{what}; {remedy}")
    assert what in REFUSED


@pytest.mark.parametrize("name", ARCHIVES)
def test_archives_are_named(tmp_path, refusal, name):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr(name, "x: 1")
    said = refusal(tmp_path / "a.zip")
    assert said.startswith(ARCHIVES[name])
    assert any(said.startswith(what) for what in REFUSED)
