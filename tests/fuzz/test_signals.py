"""Signals at random moments of saving: what was computed is there, readable, and nothing hangs.

Each process sends the signal to itself and to those it has begun, as a terminal does, some
milliseconds after it has begun to save, or where the netCDF library is about to leave its lock; the
moments are random (the number of the test is the seed), and some signals are sent twice.
"""

import json
import os
import random
import signal
import subprocess
import sys

import pytest

from restitution.results.reader import RunResults, StudyResults
from restitution.results.stored_files import read_netcdf

COUNT = max(1, round(2 * float(os.environ.get("FUZZ", "1")) + 1))

# Where the clock begins, and how long saving takes from there (s).
SAVES = {
    "run": ("replace_file", 0.5),
    "ensemble": ("replace_file", 2.0),
    "study": ("write_netcdf", 0.3),
    "surface": ("replace_file", 0.5),
    "converge": ("replace_file", 2.0),
    "law": ("write_table", 0.1),
    "workers": ("replace_file", 2.0),  # a study, whose first file is study.toml
}
STATUS = {signal.SIGINT: 130, signal.SIGTERM: 143, signal.SIGHUP: 129}

# A signal that comes while compiled code writes is raised as a lock is left, which stays taken.
CALL = """
import os, signal, sys, threading, time
from xarray.backends.locks import CombinedLock
from restitution.results import writer

def send():
    time.sleep({delay})
    for _ in range({times}):
        os.killpg(0, {number})
        time.sleep(0.02)

begun = []
def announced(function):
    def call(*arguments, **options):
        if not begun:
            begun.append(True)
            threading.Thread(target=send, daemon=True).start()
        return function(*arguments, **options)
    return call

changed = announced(getattr(writer, {what!r}))
setattr(writer, {what!r}, changed)

leave = CombinedLock.__exit__
left = []
def interrupted(self, *arguments):
    left.append(True)
    if len(left) == {unlocking}:
        os.killpg(0, {number})
    return leave(self, *arguments)
CombinedLock.__exit__ = interrupted
signal.signal({number}, signal.default_int_handler if {number} == signal.SIGINT else signal.SIG_DFL)
from restitution.cli import main
main()
"""


@pytest.fixture(scope="module")
def cases(tiny_case, tmp_path_factory):
    """A case, an ensemble, a study, and a run."""
    at = tmp_path_factory.mktemp("cases")
    text = "total_error = false\n" + tiny_case
    (at / "case.toml").write_text(text)
    (at / "ensemble.toml").write_text(text.replace("seed = 1", "seed = 1\nrealisations = 2"))
    (at / "study.toml").write_text(f'{text}[sweep]\n"roughness.seed" = [1, 2]\n')
    done = subprocess.run(
        [sys.executable, "-m", "restitution", "run", "case.toml", "-o", "run"],
        cwd=at,
        capture_output=True,
        check=False,
    )
    assert done.returncode == 0
    return at


@pytest.mark.programs
@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("number", range(COUNT), ids=lambda number: f"signal-{number}")
def test_a_signal_at_a_random_moment_of_saving(number, cases, tmp_path):
    pick = random.Random(number)
    kind = list(SAVES)[number % len(SAVES)]
    what, long = SAVES[kind]
    sent = pick.choice(list(STATUS))
    at_a_lock = number % 2 == 0 and what != "write_table"
    call = CALL.format(
        delay=100.0 if at_a_lock else pick.uniform(0, long),
        unlocking=pick.randint(1, 40) if at_a_lock else 0,
        times=pick.choice((1, 1, 2)),
        number=int(sent),
        what=what,
    )
    arguments = {
        "ensemble": ("run", "ensemble.toml"),
        "study": ("study", "study.toml", "--workers", "1"),
        "workers": ("study", "study.toml", "--workers", "1"),
        "law": ("fit-law", "run"),
    }.get(kind, (kind, "case.toml"))
    if kind == "converge":
        arguments = (*arguments, "--grids", "2")
    out = tmp_path / "out"
    done = subprocess.run(
        [sys.executable, "-c", call, *arguments, "-o", out],
        cwd=cases,
        timeout=60,
        capture_output=True,
        text=True,
        start_new_session=True,
    )
    assert "Traceback" not in done.stderr
    assert done.returncode in (0, STATUS[sent]), done.stderr
    assert not list(out.rglob(".*")), "half of a file, or a lock"
    assert_readable(kind, out, done.returncode)


def assert_readable(kind, out, status):
    """What is there is whole; all of it is where the signal came late enough."""
    if kind == "surface":
        if status == 0 or (out / "surface.nc").exists():
            assert read_netcdf(out / "surface.nc")["height"].shape == (32, 32)
            json.loads((out / "statistics.json").read_text())
    elif kind == "law":
        if status == 0 or (out / "law.json").exists():
            assert json.loads((out / "law.json").read_text())["points"]
    elif kind in ("study", "workers"):
        # Before the first table is written the folder is one that --resume finishes.
        if status == 0 or (out / "table.csv").exists():
            assert all(case.status in ("complete", "missing") for case in StudyResults(out).cases)
            read_netcdf(out / "study.nc")
    else:
        run = RunResults(out)
        run.check()  # saving had begun: what was computed is there
        assert run.summary["status"] in ("complete", "interrupted")
        assert (run.summary["status"] == "complete") == (run.summary["reason"] == "")
        assert run.summary["depths_computed"] > 0
