"""Odd environments, folders and paths: a command works, or says in one line why not."""

import ctypes
import dataclasses
import os
import re
import subprocess
import sys

import pytest

from restitution.cli import prepare
from restitution.errors import CaseError
from restitution.impacts import time_integration

_PR_CAPBSET_DROP = 24
_CAP_DAC_OVERRIDE, _CAP_DAC_READ_SEARCH = 1, 2


def obey_permissions():
    """Take from the superuser, as tests in a container have, the right to pass permissions by."""
    if os.getuid() == 0:
        for capability in (_CAP_DAC_OVERRIDE, _CAP_DAC_READ_SEARCH):
            ctypes.CDLL(None).prctl(_PR_CAPBSET_DROP, capability, 0, 0, 0)


@pytest.fixture
def call(case_text, tmp_path):
    """Call the command line in a process of its own, in the folder of a small case."""
    text = case_text.replace("[72, 64]", "[32, 32]").replace("2 um", "4 um")
    (tmp_path / "case.toml").write_text(text)

    def call(*arguments, cwd=tmp_path, **environment):
        return subprocess.run(
            [sys.executable, "-m", "restitution", *arguments],
            capture_output=True,
            text=True,
            errors="replace",
            cwd=cwd,
            timeout=60,
            env={**os.environ, **environment},
            preexec_fn=obey_permissions,
        )

    return call


def refusal(done):
    assert done.returncode == 1, done.stderr
    assert "Traceback" not in done.stderr
    lines = done.stderr.splitlines()
    assert len(lines) == 1
    return lines[0]


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="drops rights as Linux has them")
@pytest.mark.parametrize("mode", [0o000, 0o555])
def test_a_folder_without_permission(call, tmp_path, mode):
    out = tmp_path / "out"
    out.mkdir()
    out.chmod(mode)
    try:
        said = refusal(call("surface", "case.toml", "-o", "out"))
        assert said.startswith("Error: out: cannot be written (Permission denied)")
        if mode == 0:
            said = refusal(call("report", "out"))
            assert re.match(r"Error: out/.*cannot be read .*\(Permission denied\)", said)
    finally:
        out.chmod(0o755)


def test_a_file_where_a_study_should_go(refused, case_text, tmp_path):
    (tmp_path / "study.toml").write_text(f'{case_text}[sweep]\n"roughness.seed" = [1, 2]\n')
    said = refused("study", tmp_path / "study.toml", "-o", tmp_path / "study.toml")
    assert said.startswith(f"Error: {tmp_path / 'study.toml'}: cannot be written (File exists)")


def test_the_backend_of_matplotlib_does_not_matter(call, tmp_path):
    done = call("surface", "case.toml", "-o", "out", MPLBACKEND="no-such-backend")
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "out" / "surface.png").stat().st_size > 1000


@pytest.mark.parametrize("name", ["DUCC0_NUM_THREADS", "OMP_NUM_THREADS"])
@pytest.mark.parametrize("text", ["x", "-1", "1e9", "2.5", "٣", "9" * 30])
def test_a_number_of_threads_that_is_none(refused, monkeypatch, name, text):
    monkeypatch.setenv("DUCC0_NUM_THREADS", "1")
    monkeypatch.delenv("DUCC0_NUM_THREADS")
    monkeypatch.setenv(name, text)
    assert refused("check", "case.toml").startswith(f'Error: {name}: "{text}" is not a number of')


@pytest.mark.parametrize(
    ("name", "text", "threads"),
    [
        ("DUCC0_NUM_THREADS", "0", "0"),
        ("DUCC0_NUM_THREADS", " 2", "2"),
        ("OMP_NUM_THREADS", "4,2", "4"),
        ("OMP_NUM_THREADS", "", None),
    ],
)
def test_numbers_of_threads_that_openmp_takes(monkeypatch, name, text, threads):
    monkeypatch.setenv("DUCC0_NUM_THREADS", "1")
    monkeypatch.delenv("DUCC0_NUM_THREADS")
    monkeypatch.setenv(name, text)
    prepare([])
    assert os.environ.get("DUCC0_NUM_THREADS") == threads


@pytest.mark.skipif(os.name != "posix", reason="names of files are bytes there")
@pytest.mark.parametrize(
    "arguments",
    [
        ("surface", b"b\xff.toml", "-o", "out"),
        ("surface", "case.toml", "-o", b"b\xff"),
        ("report", b"b\xff"),
    ],
)
def test_a_path_that_is_not_utf8(call, arguments):
    said = refusal(call(*arguments))
    assert '"b\\udcff' in said
    assert "is not UTF-8" in said


@pytest.mark.skipif(os.name != "posix", reason="names of files are bytes there")
def test_a_current_folder_that_is_not_utf8(call, tmp_path):
    folder = os.fsencode(tmp_path) + b"/b\xff"
    os.mkdir(folder)
    (tmp_path / "case.toml").rename(os.fsdecode(folder) + "/case.toml")
    assert "is not UTF-8" in refusal(call("surface", "case.toml", "-o", "out", cwd=folder))


def test_a_current_folder_that_is_gone(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "gone").mkdir()
    os.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(CaseError, match="current folder was removed"):
        prepare([])


def test_a_restitution_in_time_has_its_error(cli, case_text, tmp_path, monkeypatch):
    """Stored curves may return a little more than was given; the error says how much."""
    (tmp_path / "case.toml").write_text(case_text)
    assert cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")[0] == 0
    real = time_integration.collide_in_time
    monkeypatch.setattr(
        "restitution.cli.simulate.collide_in_time",
        lambda *arguments: dataclasses.replace(real(*arguments), restitution=1.00012),
    )
    status, said, _ = cli("simulate", tmp_path / "out")
    assert status == 0
    rows = [line.split() for line in said.splitlines() if "1.00012" in line]
    assert len(rows) == 2
    for row in rows:
        assert row[1:3] == ["1.00012", "±"]
        assert float(row[1]) - float(row[3]) <= 1.0
