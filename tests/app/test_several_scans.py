"""Several scans of one surface on the live page."""

import io
import json
import re
import zipfile

import pytest

from app_client import Client
from app_page import expect
from restitution.app.content import content_of, problems_in, scans_of
from restitution.app.grid import with_grid
from restitution.app.session import Session
from restitution.case.case_file import parse_toml
from virtual_instruments import KnownSurface

KNOWN = KnownSurface()
HEADER = "# Width: {0:g} µm\n# Height: {0:g} µm\n# Value units: nm\n"
EDGES = {"optical.txt": 100.0, "afm.txt": 15.0}


def matrix(name, seed):
    heights = KNOWN.scan(1e-6 * EDGES[name], 64, seed).height
    rows = "\n".join(" ".join(f"{1e9 * z:.4f}" for z in line) for line in heights.T)
    return HEADER.format(EDGES[name]) + rows + "\n"


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("several")
    for seed, name in enumerate(EDGES):
        (folder / name).write_text(matrix(name, seed), encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def client(tmp_path_factory):
    pytest.importorskip("starlette", reason='the extra "app" is not installed')
    pytest.importorskip("uvicorn", reason='the extra "app" is not installed')
    running = Client(tmp_path_factory.mktemp("app"))
    yield running
    running.end()


def joined(*names):
    return {
        "first": {"material": "steel", "radius": "250 um"},
        "interface": {"work_of_adhesion": "0 J/m^2", "yield_pressure": "2.8 Y"},
        "impact": {"velocity": ["0.1 m/s", "0.3 m/s"]},
        "unloading": {"curves": 0},
        "roughness": [{"kind": "joined", "seed": 1, "scan": [{"file": name} for name in names]}],
    }


@pytest.mark.parametrize("name", ["/etc/hostname", "../case.toml", "*", "absent.txt", "a/b"])
@pytest.mark.parametrize("key", ["scans", "scan"])
def test_only_scans_of_the_page_are_joined(tmp_path, name, key):
    value = f'scans = ["{name}"]' if key == "scans" else f'scan = [{{ file = "{name}" }}]'
    (tmp_path / "known.txt").write_text("1\n")
    text = (
        'first = { material = "steel", radius = "250 um" }\nimpact = { velocity = "1 m/s" }\n'
        'grid = { nodes = 64, spacing = "1 um" }\n'
        f'[roughness]\nkind = "joined"\nseed = 1\n{value}\n'
    )
    assert "is not a scan of this page" in problems_in(text, tmp_path)["roughness.file"]


def test_patterns_of_a_case_file_become_files_of_the_page(files):
    text = (
        'first = { material = "steel", radius = "250 um" }\nimpact = { velocity = "1 m/s" }\n'
        '[roughness]\nkind = "joined"\nseed = 1\nscans = ["*.txt"]\n'
    )
    session = Session(content_of(text), files)
    try:
        assert [table["file"] for table in scans_of(session.content)] == ["afm.txt", "optical.txt"]
        assert sorted(path.name for path in session.scans.iterdir()) == ["afm.txt", "optical.txt"]
    finally:
        session.close()


def test_the_program_chooses_a_grid_for_joined_scans(files):
    from restitution.app.content import text_of

    text, grid = with_grid(text_of(joined(*EDGES)), files)
    assert grid["nodes"] >= 64
    assert parse_toml(text)["grid"] == grid


def test_uploaded_scans_give_a_curve(client, files):
    for name in EDGES:
        status, _, text = client.upload(name, (files / name).read_bytes())
        assert (status, json.loads(text)["name"]) == (200, name)
    *_, line = client.post("curve", tab="several", content=joined(*EDGES))
    assert "problems" not in line
    assert "error" not in line


def test_a_container_is_read_when_it_is_uploaded(client, files):
    pytest.importorskip("yaml")
    told = "".join(f"  - {{datafile: {{original: {name}}}}}\n" for name in EDGES)
    packed = io.BytesIO()
    with zipfile.ZipFile(packed, "w") as archive:
        archive.writestr("meta.yml", f"surfaces:\n- topographies:\n{told}")
        for name in EDGES:
            archive.write(files / name, name)
    status, _, text = client.upload("wall.zip", packed.getvalue())
    assert status == 200
    assert json.loads(text)["scans"] == 2
    assert "wall.zip" in client.scans()
    damaged = packed.getvalue().replace(b"datafile", b"dotafile")
    _, _, text = client.upload("damaged.zip", damaged)
    assert "error" in json.loads(text)
    assert "damaged.zip" not in client.scans()


def test_several_files_are_joined_on_the_page(page, files):
    page.locator("#scan").set_input_files([files / name for name in EDGES])
    expect(page.locator("#field-roughness-kind")).to_have_value("joined")
    expect(page.locator("#field-roughness-seed")).to_have_value("1")
    expect(page.locator("#status")).to_have_text(re.compile("complete in|depths in"))
