"""Many impacts in the background of the page, asked of its server."""

import http.client
import io
import json
import time
import zipfile

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


def worn_content(app):
    content = app.content() | {"impact": {"velocity": ["0.05 m/s"]}}
    del content["indentation"]
    return content | {"impacts": {"coverage": 0.11, "places": 2}}


def test_many_impacts_run_in_the_background_with_progress(app):
    """New and run-in surfaces in one figure and one table; the export is at the coverage."""
    content = worn_content(app)
    *progress, line = app.post("run", tab="a", content=content, grids=1)
    words = [said["progress"] for said in progress]
    assert words[-2:] == ["run-in at 0.05 m/s, coverage 0", "run-in at 0.05 m/s, coverage 0.11"]
    assert [round(row["coverage"], 1) for row in line["worn"]] == [0, 0.1]
    assert line["worn"][0]["restitution"] == approx(line["results"][0]["restitution"], rel=0.02)
    names = [trace.get("name") for trace in line["worn_figure"]["data"]]
    assert {"new surfaces", "coverage 0.11"} <= set(names)
    values = {"tab": "a", "content": content, "grids": 1, "code": "lammps", "velocity": "0.05 m/s"}
    status, archive = app.download(values | {"what": "export"})
    assert status == 200
    with zipfile.ZipFile(io.BytesIO(archive)) as opened:
        (path,) = (path for path in opened.namelist() if path.endswith("restitution_lammps.txt"))
        words = b" ".join(opened.read(path).split())
    assert b"that earlier impacts have covered 0.106 times" in words


def test_many_impacts_stop_when_the_page_closes_the_request(app):
    content = worn_content(app) | {"total_error": True}
    content["impacts"] = {"coverage": 20, "places": 200}
    connection = http.client.HTTPConnection("127.0.0.1", int(app.port), timeout=60)
    headers = {"X-Token": app.token, "Content-Type": "application/json"}
    body = json.dumps({"tab": "a", "content": content, "grids": 1})
    connection.request("POST", "/api/run", body, headers)
    answer = connection.getresponse()
    while "run-in" not in json.loads(answer.readline())["progress"]:
        pass
    connection.close()
    began = time.perf_counter()
    app.post("run", tab="a", content=worn_content(app), grids=1)
    assert time.perf_counter() - began < 10
