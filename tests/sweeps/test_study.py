"""Studies: each case is stored when done, and an interrupted study can be resumed."""

import csv
import json
import os
import random
import signal
import subprocess
import sys
import time
from collections import deque
from concurrent.futures import Future, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from types import SimpleNamespace

import pytest
import xarray as xr

from restitution.errors import OutputError
from restitution.sweeps import scheduler as module
from restitution.sweeps.executors import Outcome, Workers
from restitution.sweeps.scheduler import Tally, _compute_all, run_study
from restitution.sweeps.study_folder import StudyFolder
from restitution.sweeps.sweep import parse_study

SWEEP = """
[sweep]
"roughness.seed" = [1, 2, 3]
"interface.yield_pressure" = ["150 MPa", "750 MPa"]
"""


class _Nowhere:
    def put(self, message):
        pass


def here(places=1):
    """An executor that computes cases in this process."""
    executor = ThreadPoolExecutor(places)
    return Workers(executor, places, 1, _Nowhere(), list, lambda _: executor)


def run(text, folder, *, resume=False, **more):
    study = parse_study(text)
    out = StudyFolder(folder / "out", study, resume=resume)
    return run_study(study, folder, out, here(), **more), out


@pytest.fixture(scope="module")
def text(case_text):
    short = case_text.replace("steps = 4", "steps = 2").replace("curves = 2", "curves = 1")
    return "total_error = false\n" + short + SWEEP


@pytest.fixture(scope="module")
def whole(text, tmp_path_factory):
    """The table of the study without interruption."""
    folder = tmp_path_factory.mktemp("whole")
    run(text, folder)
    return folder / "out"


def table(out):
    return (out / "table.csv").read_text()


def test_the_table_holds_every_case(whole):
    with open(whole / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0])[:3] == ["roughness.seed", "interface.yield_pressure", "max_indentation_m"]
    assert list(rows[0])[-3:] == ["case", "status", "reason"]
    assert len(rows) == 6 * 2
    assert [row["roughness.seed"] for row in rows] == ["1"] * 4 + ["2"] * 4 + ["3"] * 4
    with open(whole / "cases" / "case-00004" / "curve.csv", newline="") as file:
        stored = list(csv.DictReader(file))
    assert [row["restitution"] for row in rows[6:8]] == [row["restitution"] for row in stored]


def test_the_dataset_has_the_swept_quantities_as_dimensions(whole):
    with xr.open_dataset(whole / "study.nc") as study:
        cor = study["restitution"]
        assert cor.dims == ("roughness.seed", "interface.yield_pressure", "depth")
        soft = cor.sel({"interface.yield_pressure": 150e6})
        assert (soft < cor.sel({"interface.yield_pressure": 750e6})).all()
        assert study["interface.yield_pressure"].attrs["units"] == "Pa"
        assert study["roughness.seed"].values.tolist() == [1, 2, 3]
        assert (study["status"] == "complete").all()


def test_paired_quantities_are_coordinates_of_the_cases(text, tmp_path):
    paired = text.split("[sweep]")[0] + (
        '[sweep]\nmode = "paired"\n"roughness.seed" = [1, 2]\n'
        '"interface.yield_pressure" = ["150 MPa", "750 MPa"]\n'
    )
    _, out = run(paired, tmp_path)
    with xr.open_dataset(out.path / "study.nc") as study:
        assert study["restitution"].dims == ("case", "depth")
        pressure = study["interface.yield_pressure"]
        assert pressure.values.tolist() == [150e6, 750e6]
        assert json.loads(pressure.attrs["as_written"]) == ["150 MPa", "750 MPa"]


def test_the_same_study_gives_the_same_table(whole, text, tmp_path):
    _, out = run(text, tmp_path)
    assert table(out.path) == table(whole)


def test_a_case_that_fails_is_kept_with_its_reason_and_not_tried_again(text, tmp_path, monkeypatch):
    deep = text.replace("[1, 2, 3]", "[1]").replace(
        '"interface.yield_pressure" = ["150 MPa", "750 MPa"]',
        '"indentation.to" = ["300 nm", "30 um"]',
    )
    tally, out = run(deep, tmp_path)
    assert (tally.done, tally.failed) == (2, 1)
    with open(out.path / "table.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["status"] for row in rows] == ["complete", "complete", "failed"]
    assert "edge of the" in rows[-1]["reason"]
    assert (out.path / "cases" / "case-00002" / "curve.csv").exists()

    calls = []
    compute = module.compute
    monkeypatch.setattr(module, "compute", lambda *a: calls.append(a[2]) or compute(*a))
    tally, _ = run(deep, tmp_path, resume=True)
    assert (calls, tally.failed) == ([], 1)
    run(deep, tmp_path, resume=True, retry_failed=True)
    assert calls == [2]


def rewrite(path, change):
    path.write_text(change(path.read_text()))


def with_a_restitution_of(value):
    def change(text):
        lines = [line.split(",") for line in text.splitlines()]
        lines[1][lines[0].index("restitution")] = value
        return "".join(",".join(line) + "\n" for line in lines)

    return change


@pytest.mark.parametrize(
    "damage",
    [
        lambda case: (case / "results.nc").write_bytes(b"CDF and no more"),
        lambda case: (case / "results.nc").unlink(),
        lambda case: (case / "curve.csv").write_text("max_indentation_m\n"),
        lambda case: (case / "summary.json").write_text("{"),
        lambda case: (case / "case.toml").write_text("title = 'another'"),
        lambda case: rewrite(case / "curve.csv", lambda text: text.replace("e-", "x-", 1)),
        lambda case: rewrite(case / "curve.csv", lambda text: text.replace("force_N", "force", 1)),
        lambda case: rewrite(case / "curve.csv", with_a_restitution_of("-7")),
        lambda case: rewrite(case / "curve.csv", lambda text: "\0" * len(text)),
        lambda case: rewrite(
            case / "summary.json", lambda text: text.replace("complete", "failed")
        ),
    ],
)
@pytest.mark.parametrize("checked", [True, False])
def test_a_damaged_case_is_computed_again(whole, text, tmp_path, damage, checked, monkeypatch):
    import shutil

    shutil.copytree(whole, tmp_path / "out")
    if not checked:
        (tmp_path / "out" / "cases" / "case-00003" / "SHA256SUMS").unlink()
    damage(tmp_path / "out" / "cases" / "case-00003")
    calls = []
    compute = module.compute
    monkeypatch.setattr(module, "compute", lambda *a: calls.append(a[2]) or compute(*a))
    run(text, tmp_path, resume=True)
    assert calls == [3]
    assert table(tmp_path / "out") == table(whole)


def test_what_a_folder_holds_is_respected(whole, text, tmp_path):
    study = parse_study(text)
    with pytest.raises(OutputError, match="or continue with --resume"):
        StudyFolder(whole, study, resume=False)
    with pytest.raises(OutputError, match="holds another study"):
        StudyFolder(whole, parse_study(text.replace("[1, 2, 3]", "[1, 2]")), resume=True)
    with pytest.raises(OutputError, match="holds no study"):
        StudyFolder(tmp_path / "new", study, resume=True)
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "thesis.txt").write_text("")
    with pytest.raises(OutputError, match="move it away"):
        StudyFolder(tmp_path / "other", study, resume=False)


def test_one_process_at_a_time(text, tmp_path):
    study = parse_study(text)
    one = StudyFolder(tmp_path / "out", study, resume=False)
    two = StudyFolder(tmp_path / "out", study, resume=True)
    with one.locked(), pytest.raises(OutputError, match="another process"), two.locked():
        pass
    with two.locked():
        pass


def test_a_full_disk_stops_the_study_and_loses_nothing(whole, text, tmp_path, monkeypatch):
    put, kept = StudyFolder.put, []

    def full(self, case, outcome):
        if len(kept) == 2:
            raise OutputError(f"{self.path}: cannot be written (No space left on device)")
        put(self, case, outcome)
        kept.append(case.number)

    with monkeypatch.context() as patch:
        patch.setattr(StudyFolder, "put", full)
        with pytest.raises(OutputError, match="No space left"):
            run(text, tmp_path)
    run(text, tmp_path, resume=True)
    assert table(tmp_path / "out") == table(whole)


def begin(folder, *more):
    return subprocess.Popen(
        [
            sys.executable,
            "-m",
            "restitution",
            "study",
            folder / "study.toml",
            "-o",
            folder / "out",
            "--workers",
            "2",
            *more,
        ],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "DUCC0_NUM_THREADS": "1"},
    )


@pytest.mark.programs
def test_kill_9_at_any_moment_loses_the_cases_in_flight_at_most(text, tmp_path):
    text = text.replace("[1, 2, 3]", "[1, 2, 3, 4]")
    (tmp_path / "whole").mkdir()
    _, unstopped = run(text, tmp_path / "whole")
    (tmp_path / "study.toml").write_text(text)
    cases, pick = tmp_path / "out" / "cases", random.Random(7)
    begun: dict[str, int] = {}
    resume, seen = (), []
    for kill in range(6):
        process = begin(tmp_path, *resume)
        # From before the first case to after the last, and while cases are written.
        while len(list(cases.glob("case-*"))) < (8 * kill) // 5 and process.poll() is None:
            time.sleep(0.01)
        time.sleep(pick.uniform(0, 0.1))  # less than a case takes
        process.send_signal(signal.SIGKILL)
        process.communicate(timeout=60)
        for case in cases.glob("case-*") if cases.exists() else ():
            stamp = (case / "results.nc").stat().st_mtime_ns
            assert begun.setdefault(case.name, stamp) == stamp, "computed twice"
        seen.append(len(begun))
        resume = ("--resume",) if (tmp_path / "out" / "study.toml").exists() else ()
    assert len(set(seen)) > 3
    process = begin(tmp_path, *resume)
    _, said = process.communicate(timeout=300)
    assert process.returncode == 0, said
    for name, stamp in begun.items():
        assert (cases / name / "results.nc").stat().st_mtime_ns == stamp
    assert table(tmp_path / "out") == table(unstopped.path)


def children(pid):
    found = []
    for stat in os.listdir("/proc"):
        if stat.isdigit():
            try:
                with open(f"/proc/{stat}/stat") as file:
                    fields = file.read().rsplit(")", 1)[1].split()
            except OSError:
                continue
            if int(fields[1]) == pid:
                found.append(int(stat))
    return found


def command_of(pid):
    try:
        with open(f"/proc/{pid}/cmdline") as file:
            return file.read()
    except OSError:
        return ""


@pytest.mark.programs
@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="finds workers through /proc")
def test_a_worker_that_dies_is_replaced_and_none_outlives_its_study(whole, text, tmp_path):
    (tmp_path / "study.toml").write_text(text.replace("nodes = [72, 64]", "nodes = [72, 64]"))
    process = begin(tmp_path)
    deadline = time.monotonic() + 60
    workers = []
    while len(workers) < 3 and time.monotonic() < deadline:  # the manager and two workers
        workers = [pid for pid in children(process.pid) if "spawn_main" in command_of(pid)]
        time.sleep(0.02)
    time.sleep(1.0)
    os.kill(workers[-1], signal.SIGKILL)
    _, said = process.communicate(timeout=300)
    assert process.returncode == 0, said
    assert table(tmp_path / "out") == table(whole)

    (tmp_path / "again").mkdir()
    (tmp_path / "again" / "study.toml").write_text(text)
    process = begin(tmp_path / "again")
    workers = []
    while len(workers) < 3 and time.monotonic() < deadline + 60:
        workers = [pid for pid in children(process.pid) if "spawn_main" in command_of(pid)]
        time.sleep(0.02)
    process.send_signal(signal.SIGKILL)
    process.communicate(timeout=60)
    gone = time.monotonic() + 30
    while any("spawn_main" in command_of(pid) for pid in workers) and time.monotonic() < gone:
        time.sleep(0.1)
    assert not any("spawn_main" in command_of(pid) for pid in workers)


@pytest.mark.programs
def test_interruption_says_how_to_go_on(whole, text, tmp_path):
    (tmp_path / "study.toml").write_text(text)
    process = begin(tmp_path)
    cases = tmp_path / "out" / "cases"
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline and not list(cases.glob("case-*")):
        time.sleep(0.05)
    process.send_signal(signal.SIGTERM)
    _, said = process.communicate(timeout=60)
    assert process.returncode == 143, said
    assert "--resume" in said.splitlines()[-1]
    assert "Traceback" not in said
    assert (tmp_path / "out" / "table.csv").exists()
    run(text, tmp_path, resume=True)
    assert table(tmp_path / "out") == table(whole)


def test_a_worker_that_dies_between_two_cases_is_replaced():
    """The executor then raises the error on `submit`, not by a result."""

    class Dead:
        def submit(self, *_):
            raise BrokenProcessPool

    class Alive:
        def submit(self, _, text, *__):
            future = Future()
            future.set_result(Outcome({}, f"not computed: {text}"))
            return future

    class Renewed:
        executor, places, threads, channel, renewals = Dead(), 2, 1, None, 0

        def renewed(self, _):
            self.renewals += 1
            return Alive()

        def heard(self):
            return []

    class Kept(list):
        def put(self, case, outcome):
            self.append((case.number, outcome.reason))

    cases = deque(SimpleNamespace(number=n, text=f"case {n}") for n in (1, 2, 3))
    kept, tally, workers = Kept(), Tally(3), Renewed()
    _compute_all(cases, Path(), kept, workers, tally, lambda _: None)
    assert sorted(kept) == [(n, f"not computed: case {n}") for n in (1, 2, 3)]
    assert workers.renewals == 1
