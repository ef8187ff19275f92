"""The server of the page, asked directly: what it refuses, and how it survives a lost worker."""

import http.client
import io
import json
import os
import pickle
import re
import signal
import sys
import time
import zipfile
from pathlib import Path

import numpy as np
import pytest

from app_client import Client
from tolerance import approx

pytest.importorskip("starlette", reason='the extra "app" is not installed')
pytest.importorskip("uvicorn", reason='the extra "app" is not installed')


@pytest.fixture(scope="module")
def app(tmp_path_factory):
    running = Client(tmp_path_factory.mktemp("app"))
    yield running
    running.end()


def test_the_curve_of_the_case(app):
    *_, line = app.post("curve", tab="a", content=app.content())
    assert [row["max_indentation_m"] for row in line["curve"]] == approx([1e-7, 2e-7])
    assert all(0 < row["restitution"] < 1 for row in line["curve"])
    assert set(line["figures"]) == {"velocity", "indentation", "force"}


def test_the_page_has_a_strict_policy(app):
    status, headers, text = app.ask("GET", "/", X_Token=None)
    policy = headers["Content-Security-Policy"]
    assert status == 200
    assert "default-src 'none'" in policy
    assert "script-src 'self'" in policy
    assert "unsafe-eval" not in policy
    nonce = re.search(r"'nonce-([\w-]+)'", policy)[1]
    assert f'nonce="{nonce}"' in text
    assert headers["X-Content-Type-Options"] == "nosniff"


@pytest.mark.parametrize("host", ["evil.example", "evil.example:80", "127.0.0.1", "0.0.0.0:1"])
def test_a_foreign_host_is_refused(app, host):
    for method, path in (("GET", "/"), ("POST", "/api/start")):
        assert app.ask(method, path, {}, Host=host)[0] == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "https://127.0.0.1:1"])
def test_a_foreign_origin_is_refused(app, origin):
    assert app.ask("POST", "/api/start", {}, Origin=origin)[0] == 403


def test_its_own_origin_is_served(app):
    assert app.ask("POST", "/api/start", {}, Origin=f"http://127.0.0.1:{app.port}")[0] == 200


@pytest.mark.parametrize("token", [None, "", "wrong", "é"])
def test_a_request_without_the_token_is_refused(app, token):
    header = None if token is None else token.encode()
    assert app.ask("POST", "/api/start", {}, X_Token=header)[0] == 403


@pytest.mark.parametrize(
    "kind", ["text/plain", "application/x-www-form-urlencoded", "multipart/form-data", ""]
)
def test_another_kind_of_content_is_refused(app, kind):
    status, _, _ = app.ask("POST", "/api/start", "{}", **{"Content-Type": kind})
    assert status == 415


@pytest.mark.parametrize("name", ["start", "curve", "run", "take", "show", "upload", "content"])
def test_get_has_no_effects(app, name):
    assert app.ask("GET", f"/api/{name}")[0] in (404, 405)


@pytest.mark.parametrize(
    "body",
    [
        "", "[]", "{", "null", '{"tab": "a"}', '{"tab": 1, "content": {}}',
        '{"tab": "a", "content": {}, "more": 1}', '{"tab": "a", "content": []}', "[" * 10**5,
    ],
)  # fmt: skip
def test_a_damaged_request_is_refused(app, body):
    assert app.ask("POST", "/api/curve", body)[0] == 400


def test_a_request_that_is_too_long_is_refused(app):
    assert app.ask("POST", "/api/content", '{"text": "' + "x" * 2**22 + '"}')[0] == 413


@pytest.mark.parametrize(
    "path",
    ["/../case.toml", "/%2e%2e/case.toml", "/..%2fcase.toml", "/static/app.js", "//etc/passwd"],
)
def test_no_other_file_is_served(app, path):
    status, _, text = app.ask("GET", path)
    assert status == 404
    assert "radius" not in text


@pytest.mark.parametrize("name", ["/etc/hostname", "../case.toml", "..", ".", "absent.txt", "a/b"])
def test_only_scans_of_the_page_are_read(app, name):
    content = app.content() | {"roughness": [{"kind": "measured", "file": name}]}
    *_, line = app.post("curve", tab="a", content=content)
    assert "is not a scan of this page" in line["problems"]["roughness.file"]


@pytest.mark.parametrize(
    ("given", "kept"),
    [("../../up.npy", "up.npy"), ("a%2Fb%5Cc.npy", "c.npy"), (".hidden.npy", "hidden.npy"),
     ("%3Cimg%20src=x%3E.npy", "_img_src_x_.npy"), ("%00x.npy", "_x.npy")],
)  # fmt: skip
def test_a_scan_is_kept_under_a_plain_name(app, given, kept):
    stream = io.BytesIO()
    np.save(stream, 1e-9 * np.random.default_rng(1).normal(size=(16, 16)))
    status, _, text = app.upload(given, stream.getvalue())
    assert (status, json.loads(text)["name"]) == (200, kept)
    assert kept in app.scans()
    assert "does not contain the size" in json.loads(text)["needs_size"]


class Attack:
    """Unpickling this would make a file."""

    def __reduce__(self):
        return os.mkdir, ("attacked",)


def zip_bomb():
    """An archive whose directory states the size of a file as over 2 GiB."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("main.xml", "<x/>")
        archive.writestr("bindata/data.bin", bytes(2**20))
        archive.getinfo("bindata/data.bin").file_size = 33 * 2**26
    return stream.getvalue()


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("a.npy", pickle.dumps(Attack())),
        ("a.npz", pickle.dumps(Attack())),
        ("a.pkl", pickle.dumps(Attack())),
        ("a.txt", b"<script>alert(1)</script>"),
        ("a.html", b"<script>alert(1)</script>"),
        ("a.x3p", b"PK\x03\x04 damaged"),
        ("empty.txt", b""),
    ],
    ids=["npy", "npz", "pkl", "txt", "html", "x3p", "empty"],
)
def test_a_hostile_file_is_refused_and_not_kept(app, name, content):
    status, headers, text = app.upload(name, content)
    assert status == 200
    assert headers["Content-Type"] == "application/json"
    assert json.loads(text)["error"]
    assert name not in app.scans()
    assert not list(app.folder.rglob("attacked"))


def test_an_archive_that_would_fill_the_memory_is_refused(app):
    _, _, text = app.upload("bomb.x3p", zip_bomb())
    assert "unpacks to" in json.loads(text)["error"]
    assert "bomb.x3p" not in app.scans()


def test_a_file_over_the_limit_is_refused_and_not_kept(app):
    connection = http.client.HTTPConnection("127.0.0.1", int(app.port), timeout=60)
    connection.putrequest("POST", "/api/upload")
    headers = {
        "X-Token": app.token,
        "Content-Type": "application/octet-stream",
        "X-File-Name": "big",
    }
    for name, value in {**headers, "Content-Length": str(2**28 + 1)}.items():
        connection.putheader(name, value)
    connection.endheaders()
    try:
        for _ in range(2**8):
            connection.send(bytes(2**20))
        connection.send(b"x")
    except (BrokenPipeError, ConnectionResetError):
        pass
    assert connection.getresponse().status == 413
    connection.close()
    assert "big" not in app.scans()


def test_a_worker_that_is_killed_is_replaced(app):
    app.post("curve", tab="a", content=app.content())
    slow = app.content() | {"grid": {"nodes": 1024, "spacing": "0.25 um"}}
    slow["indentation"] = {"from": "100 nm", "to": "2 um", "steps": 48}
    slow["interface"] = {"yield_strength": "300 MPa"}
    before = app.workers()
    connection = http.client.HTTPConnection("127.0.0.1", int(app.port), timeout=60)
    headers = {"X-Token": app.token, "Content-Type": "application/json"}
    connection.request("POST", "/api/curve", json.dumps({"tab": "a", "content": slow}), headers)
    time.sleep(0.5)
    for pid in before:
        os.kill(pid, signal.SIGKILL)
    lines = [json.loads(line) for line in connection.getresponse().read().splitlines()]
    connection.close()
    assert "ended unexpectedly" in lines[-1]["error"]
    assert lines[-1]["lost"]
    *_, line = app.post("curve", tab="a", content=app.content())
    assert len(line["curve"]) == 2


def test_a_newer_request_of_the_tab_replaces_an_older_one(app):
    slow = app.content() | {"grid": {"nodes": 1024, "spacing": "0.25 um"}}
    slow["indentation"] = {"from": "100 nm", "to": "2 um", "steps": 48}
    slow["interface"] = {"yield_strength": "300 MPa"}
    connection = http.client.HTTPConnection("127.0.0.1", int(app.port), timeout=60)
    headers = {"X-Token": app.token, "Content-Type": "application/json"}
    connection.request("POST", "/api/curve", json.dumps({"tab": "b", "content": slow}), headers)
    time.sleep(0.3)
    began = time.perf_counter()
    *_, line = app.post("curve", tab="b", content=app.content())
    assert len(line["curve"]) == 2
    assert time.perf_counter() - began < 10
    assert json.loads(connection.getresponse().read().splitlines()[-1]) == {"replaced": True}
    connection.close()


def test_a_newer_request_interrupts_the_solve_of_one_depth(app):
    """The process that computes is not ended: it would take seconds to start again."""
    app.post("curve", tab="c", content=app.content())
    slow = app.content() | {"grid": {"nodes": 256, "spacing": "5 nm"}}
    slow["first"] = {"material": "silica", "radius": "5 um"}
    slow["interface"] = {"work_of_adhesion": "0.05 J/m^2", "adhesion": "cohesive"}
    slow["roughness"] = [{"kind": "gaussian", "rms": "2 nm", "correlation_length": "0.1 um"}]
    slow["roughness"][0]["seed"] = 1
    slow["indentation"] = {"values": ["30 nm"]}
    connection = http.client.HTTPConnection("127.0.0.1", int(app.port), timeout=60)
    headers = {"X-Token": app.token, "Content-Type": "application/json"}
    before = app.workers()
    connection.request("POST", "/api/curve", json.dumps({"tab": "c", "content": slow}), headers)
    time.sleep(0.5)
    *_, line = app.post("curve", tab="c", content=app.content())
    assert len(line["curve"]) == 2
    assert json.loads(connection.getresponse().read().splitlines()[-1]) == {"replaced": True}
    connection.close()
    assert app.workers() == before


def test_an_import_is_not_interrupted(tmp_path, monkeypatch):
    from restitution.app.worker import _imports

    (tmp_path / "imported_by_a_test.py").write_text(
        "import sys\n"
        "from restitution.app.worker import _imports\n"
        "noticed = _imports(sys._getframe())\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    import imported_by_a_test

    assert imported_by_a_test.noticed
    assert not _imports(sys._getframe())


def test_the_files_to_take_away_agree_with_the_page(app):
    *_, line = app.post("curve", tab="a", content=app.content())
    values = {"tab": "a", "content": app.content(), "code": "", "velocity": "", "grids": 1}
    status, headers, text = app.ask("POST", "/api/take", values | {"what": "case"})
    assert (status, "case.toml" in headers["Content-Disposition"]) == (200, True)
    (app.folder / "taken.toml").write_text(text)
    from restitution import run

    results = run(app.folder / "taken.toml", out=app.folder / "taken")
    for row, of_page in zip(results.curve.rows, line["curve"], strict=True):
        for name in ("restitution", "force_N", "impact_velocity_m_per_s", "loading_work_J"):
            assert row[name] == of_page[name]


def test_a_file_that_was_taken_leaves_nothing_behind(app):
    values = {"tab": "a", "content": app.content(), "code": "", "velocity": "", "grids": 1}
    assert app.ask("POST", "/api/take", values | {"what": "results"})[0] == 200
    (room,) = app.folder.glob("restitution-app-*")
    until = time.monotonic() + 5  # the folder is removed after the answer
    while list(room.glob("take-*")):
        assert time.monotonic() < until
        time.sleep(0.05)


def test_what_cannot_be_taken_is_one_message(app):
    values = {"tab": "a", "content": app.content(), "grids": 1}
    for wrong in ({"what": "secrets", "code": "", "velocity": ""},
                  {"what": "export", "code": "nothing", "velocity": "1 m/s"},
                  {"what": "export", "code": "lammps", "velocity": "900 m/s"}):  # fmt: skip
        status, _, text = app.ask("POST", "/api/take", values | wrong)
        assert status == 200
        assert json.loads(text)["error"]


def test_ctrl_c_ends_everything(tmp_path):
    app = Client(tmp_path)
    app.post("curve", tab="a", content=app.content())
    children = app.children()
    assert children
    assert list(tmp_path.glob("restitution-app-*"))
    assert app.end() == 130
    assert not list(tmp_path.glob("restitution-app-*"))
    time.sleep(0.3)
    assert not [pid for pid in children if Path(f"/proc/{pid}/exe").exists()]


def test_a_missing_case_and_a_taken_port_are_one_line(refused, app, tmp_path):
    assert "cannot be read" in refused("app", tmp_path / "absent.toml", "--no-browser")
    assert "cannot be used" in refused("app", "--no-browser", "--port", app.port)
