"""Studies on a Dask cluster: a scheduler and two workers on loopback, over TCP."""

import os
import re
import subprocess
import sys
import time

import pytest

pytest.importorskip("distributed", reason="Dask is not installed (extra cluster)")

SWEEP = """
[sweep]
"roughness.seed" = [1, 2, 3, 4]
"""


def dask(*arguments):
    environment = {**os.environ, "DUCC0_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", "distributed.cli." + arguments[0], *arguments[1:]],
        stderr=subprocess.PIPE,
        stdout=subprocess.DEVNULL,
        text=True,
        env=environment,
    )


@pytest.fixture
def cluster():
    """The address of a scheduler with two workers."""
    started = [dask("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard")]
    address = None
    for line in started[0].stderr:
        if found := re.search(r"tcp://127\.0\.0\.1:\d+", line):
            address = found[0]
            break
    assert address, "the scheduler has not started"
    for _ in range(2):
        started.append(dask("dask_worker", address, "--nthreads", "1", "--no-dashboard"))
    for worker in started[1:]:
        for line in worker.stderr:
            if "Registered to" in line:
                break
    yield address
    for process in reversed(started):
        process.terminate()
    for process in started:
        process.communicate(timeout=60)


def test_a_cluster_gives_what_one_process_gives(cli, case_text, cluster, tmp_path):
    (tmp_path / "study.toml").write_text(case_text + SWEEP)
    status, _, said = cli(
        "study", tmp_path / "study.toml", "-o", tmp_path / "far", "--scheduler", cluster
    )
    assert status == 0, said
    status, _, said = cli("study", tmp_path / "study.toml", "-o", tmp_path / "near", "--workers", 1)
    assert status == 0, said
    assert (tmp_path / "far" / "table.csv").read_text() == (
        tmp_path / "near" / "table.csv"
    ).read_text()


def test_no_cluster_there(refused, case_text, tmp_path, monkeypatch):
    from restitution.sweeps import executors

    monkeypatch.setattr(executors, "PATIENCE", "1s")
    (tmp_path / "study.toml").write_text(case_text + SWEEP)
    began = time.monotonic()
    message = refused(
        "study", tmp_path / "study.toml", "-o", tmp_path / "out", "--scheduler", "tcp://127.0.0.1:9"
    )
    assert "tcp://127.0.0.1:9 does not answer" in message
    assert time.monotonic() - began < 60
