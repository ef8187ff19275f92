"""The way of a run from the command line to the compiled loops: short, and never back to a file."""

import sys
from functools import cache
from pathlib import Path

import pytest

from restitution.numerics import kernels

PACKAGE = Path(__file__).parents[1] / "src" / "restitution"
MOST = 14  # files from the command line to C++
SETTING_UP = "contact/influence.py"  # it makes the operator of a grid, once
WRITING = "runs/log.py"  # it lets a run write its results, whatever ended the run


@cache
def name_of(file):
    """The name of a file in this package, or None for other files."""
    path = Path(file)
    return path.relative_to(PACKAGE).as_posix() if path.is_relative_to(PACKAGE) else None


def way_to(frame):
    """The files of this package that lead to `frame`, the first one first, each once in a row."""
    files = []
    while frame is not None:
        name = name_of(frame.f_code.co_filename)
        if name is not None and files[-1:] != [name]:
            files.append(name)
        frame = frame.f_back
    return tuple(reversed(files))


def ways_to_loops(run):
    """Every way on which `run` comes to a compiled loop."""
    names = {id(each) for each in vars(kernels.loops).values()}
    found = set()

    def note(frame, event, called):
        if event == "c_call" and id(called) in names:
            found.add(way_to(frame))

    before = sys.getprofile()
    sys.setprofile(note)
    try:
        run()
    finally:
        sys.setprofile(before)
    return found


@pytest.mark.skipif(kernels.loops is None, reason="the loops are not compiled")
def test_a_run_comes_to_compiled_loops_over_few_files_and_never_back(
    cli, case_text, tmp_path, monkeypatch
):
    """docs/developers/source.md states these numbers and the two exceptions."""
    monkeypatch.setattr("restitution.cli.run._draw", lambda *_: [])
    small = case_text.replace("[72, 64]", "[40, 36]").replace("steps = 4", "steps = 2")
    (tmp_path / "case.toml").write_text(small)
    ways = ways_to_loops(lambda: cli("run", tmp_path / "case.toml", "-o", tmp_path / "out"))
    solving = {way for way in ways if SETTING_UP not in way}
    ended = {"numerics/kernels.py", "numerics/convolution/device.py"}
    assert {way[-1] for way in solving} == ended
    assert all(way[0] == "cli/__init__.py" for way in ways)
    assert max(map(len, solving)) == MOST
    assert max(map(len, ways)) <= MOST + 2
    again = {way for way in solving if len(set(way)) < len(way)}
    assert {name for way in again for name in way if way.count(name) > 1} <= {"runs/run.py"}
    assert all(WRITING in way for way in again)
