"""However a command ends: what is said, what is kept, and which status."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
import xarray as xr

from restitution.errors import DomainError
from restitution.runs import convergence, depths, run

CALL = "from restitution.cli import main; main()"


@pytest.fixture
def case(case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    return tmp_path / "case.toml"


def call(*arguments, before="", **options):
    """The command line in a process of its own, after the statements `before`."""
    command = [sys.executable, "-c", f"{before}\n{CALL}", *map(str, arguments)]
    return subprocess.run(command, capture_output="stdout" not in options, text=True, **options)


def fail_at_the_third_depth(monkeypatch, error):
    real, calls = depths.solve, []

    def solve(*arguments, **options):
        calls.append(arguments)
        if len(calls) == 3:
            raise error
        return real(*arguments, **options)

    monkeypatch.setattr(depths, "solve", solve)


def test_an_unforeseen_error_is_recorded(cli, case, tmp_path, monkeypatch):
    fail_at_the_third_depth(monkeypatch, ZeroDivisionError("by\nnought"))
    with pytest.raises(ZeroDivisionError):
        cli("run", case, "-o", tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert summary["reason"] == ("stopped by an unexpected error: ZeroDivisionError by\\nnought")
    assert summary["depths_computed"] == 2


def test_too_little_memory_is_one_line(refused, case, tmp_path, monkeypatch):
    fail_at_the_third_depth(monkeypatch, MemoryError("9 TiB"))
    assert "use fewer grid.nodes" in refused("run", case, "-o", tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert "MemoryError 9 TiB" in summary["reason"]


def test_an_interruption_after_the_last_depth_says_what_is_kept(cli, case, tmp_path, monkeypatch):
    from restitution.plots import run as figures

    def stop(_):
        raise KeyboardInterrupt

    monkeypatch.setattr(figures, "pressure_map", stop)
    status, table, said = cli("run", case, "-o", tmp_path / "out")
    assert status == 130
    assert f"4 of 4 depths were computed and are kept in {tmp_path / 'out'}" in said
    assert "COR" in table  # before the figures


@pytest.mark.parametrize(
    ("verb", "surfaces", "module", "name"),
    [
        (("run",), 1, run.ErrorBudget, "add"),
        (("run",), 2, run.ErrorBudget, "add"),
        (("converge", "--grids", "2"), 1, convergence, "_spread_of"),
    ],
)
def test_an_interruption_of_the_error_curves_says_what_is_missing(
    cli, case_text, tmp_path, monkeypatch, verb, surfaces, module, name
):
    text = case_text.replace("steps = 4", "steps = 2")
    text = text.replace("seed = 1", f"seed = 1\nrealisations = {surfaces}")
    (tmp_path / "case.toml").write_text(text)

    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(module, name, stop)
    status, _, said = cli(*verb, tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 130
    missing = "total_error is missing at 2 of 2 depths, because the run was stopped before"
    assert said.count(f"Warning: {missing}") == 1
    assert "2 of 2 depths were computed" in said
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert [each for each in summary["warnings"] if each.startswith(missing)]


def test_a_total_error_that_cannot_be_computed_is_said(cli, case, tmp_path, monkeypatch):
    def fail(*_, **__):
        raise DomainError("the edge")

    monkeypatch.setattr(run.ErrorBudget, "add", fail)
    status, _, said = cli("run", case, "-o", tmp_path / "out")
    assert status == 0
    assert said.count("Warning: total_error is unknown: the edge") == 1


def test_an_unloading_curve_that_misses_the_stored_energy_is_warned_of(
    cli, case, tmp_path, monkeypatch
):
    from restitution.runs import result_warnings

    monkeypatch.setattr(result_warnings, "_BALANCE", 1e-9)
    status, _, said = cli("run", case, "-o", tmp_path / "out")
    assert status == 0
    assert "the work of 2 of 2 unloading curves differs from the stored energy, at worst" in said
    assert "raise unloading.steps" in (tmp_path / "out" / "summary.json").read_text()


def test_a_name_with_a_line_break_stays_one_line(refused, tmp_path):
    assert "two\\nlines.toml" in refused("check", tmp_path / "two\nlines.toml")


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_a_terminal_without_greek_letters(case, encoding):
    done = call("check", case, env={**os.environ, "PYTHONIOENCODING": encoding})
    assert done.returncode == 0
    assert not done.stderr
    assert "yield indentation ?_y" in done.stdout


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
@pytest.mark.parametrize("verb", ["check", "--version"])
def test_a_standard_output_that_is_full(case, verb):
    with open("/dev/full", "w") as full:
        done = call(verb, *([case] if verb == "check" else []), stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1
    assert done.stderr == (
        "Error: standard output cannot be written (No space left on device); "
        "redirect it elsewhere\n"
    )


@pytest.mark.parametrize("module", ["numpy", "typer", "pint"])
def test_an_interruption_while_modules_load(case, module):
    before = f"""
import sys
class Stop:
    def find_spec(name, *_):
        if name == "{module}":
            raise KeyboardInterrupt
sys.meta_path.insert(0, Stop)
"""
    done = call("check", case, before=before)
    assert done.returncode == 130
    assert not done.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="needs /dev/full")
def test_a_full_disk(monkeypatch, case_text, cli, tmp_path):
    """The table cannot be written: said, with the folder."""
    import builtins

    (tmp_path / "case.toml").write_text(case_text)
    real = builtins.open

    def open_full(file, *args, **kwargs):
        full = str(file).endswith("curve.csv")
        return real("/dev/full" if full else file, *args, **kwargs)

    monkeypatch.setattr(builtins, "open", open_full)
    status, _, said = cli("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert status == 1
    assert "cannot be written (No space left on device)" in said
    assert "Traceback" not in said


@pytest.mark.programs
@pytest.mark.parametrize(
    ("sent", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129)]
)
def test_interruption_keeps_what_was_computed(case_text, tmp_path, sent, status):
    """Ctrl-C while a case runs: one line, its status, and a readable folder of what was done."""
    text = case_text.replace("steps = 4", "steps = 400").replace("curves = 2", "curves = 400")
    (tmp_path / "case.toml").write_text(text)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "restitution", "run", tmp_path / "case.toml", "-o", out]
    # Tests started in the background pass on that the signal is to be ignored.
    process = subprocess.Popen(
        command,
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(sent, signal.SIG_DFL),
    )
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        curve = out / "curve.csv"
        if curve.exists() and curve.read_text().count("\n") > 5:
            break
        time.sleep(0.02)
    process.send_signal(sent)
    said = process.communicate(timeout=180)[1]
    assert process.returncode == status
    assert "Interrupted" in said
    assert "depths were computed and are kept" in said
    assert "Traceback" not in said

    rows = (out / "curve.csv").read_text().splitlines()[1:]
    with xr.open_dataset(out / "results.nc") as results:
        assert results.sizes["indentation_max"] == len(rows) > 4
        assert results.attrs["status"] == "interrupted"
    assert '"status": "interrupted"' in (out / "summary.json").read_text()
    assert (out / "restitution-indentation.png").exists()
    assert not list(out.glob(".*.part"))


def test_interruption_between_what_belongs_to_a_row(case_text, tmp_path, monkeypatch):
    """The third depth is computed, and is either kept or not."""
    from restitution.case.case_file import parse_case
    from restitution.results.writer import ResultsFolder
    from restitution.runs import run

    calls, real = [], ResultsFolder.add

    def interrupted(*args):
        calls.append(args)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return real(*args)

    monkeypatch.setattr(ResultsFolder, "add", interrupted)
    out = ResultsFolder(tmp_path / "out")
    with pytest.raises(KeyboardInterrupt):
        run.run_case(parse_case(case_text), case_text, tmp_path, out)
    with xr.open_dataset(tmp_path / "out" / "results.nc") as results:
        assert results.sizes["indentation_max"] == len(out.rows) == 2
        assert results.attrs["status"] == "interrupted"


def test_interruption_while_results_are_written_loses_nothing(case_text, tmp_path, monkeypatch):
    """Twice, in the middle of the library's own writing."""
    from restitution.case.case_file import parse_case
    from restitution.results.reader import RunResults
    from restitution.results.writer import ResultsFolder
    from restitution.runs.run import run_case

    write = xr.Dataset.to_netcdf

    def interrupted(self, *arguments, **options):
        signal.raise_signal(signal.SIGINT)
        write(self, *arguments, **options)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr(xr.Dataset, "to_netcdf", interrupted)
    out = ResultsFolder(tmp_path / "out")
    with pytest.raises(KeyboardInterrupt):
        run_case(parse_case(case_text), case_text, tmp_path, out)
    run = RunResults(tmp_path / "out")
    run.check()
    assert run.summary["status"] == "complete"
    assert len(run.curve.rows) == 4


@pytest.mark.parametrize("error", [RuntimeError("NetCDF: HDF error"), OSError(28, "No space left")])
@pytest.mark.parametrize("realisations", [1, 2])
def test_a_disk_that_is_full_for_the_results(
    refused, case_text, tmp_path, monkeypatch, error, realisations
):
    """One line, a summary that says so, and no part of a file."""
    (tmp_path / "case.toml").write_text(
        case_text.replace("seed = 1", f"seed = 1\nrealisations = {realisations}")
    )
    write, out = xr.Dataset.to_netcdf, tmp_path / "out"

    def full(self, path, **options):
        if path.parent == out:  # not in the folders of the realisations
            path.write_bytes(b"half of it")
            raise error
        write(self, path, **options)

    monkeypatch.setattr(xr.Dataset, "to_netcdf", full)
    assert f"{out}: cannot be written (" in refused("run", tmp_path / "case.toml", "-o", out)
    summary = json.loads((out / "summary.json").read_text())
    assert summary["status"] == "failed"
    assert "cannot be written" in summary["reason"]
    assert not (out / "results.nc").exists()
    assert not list(out.glob(".*"))


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_that_a_destructor_swallows_comes_again(number):
    program = f"""
import signal, time
from restitution.cli.signals import Stopped, stoppable

class Swallows:
    def __del__(self):
        signal.raise_signal({int(number)})

signal.signal(signal.SIGINT, signal.default_int_handler)
with stoppable():
    try:
        thing = Swallows()
        del thing
        time.sleep(5)
        print("lost")
    except Stopped as stop:
        print(stop.args[0])
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == (f"{int(number)}\n", "")


@pytest.mark.parametrize(("number", "status"), [(signal.SIGINT, 130), (signal.SIGTERM, 143)])
def test_a_signal_that_compiled_code_turns_into_another_error(
    cli, case, tmp_path, monkeypatch, number, status
):
    """Matplotlib 3.11.2's `ft2font` raises `ImportError` if Ctrl-C comes while it is imported."""
    from restitution.plots import run as figures

    def imported(_):
        try:
            signal.raise_signal(number)
        except KeyboardInterrupt as error:
            raise ImportError("initialization failed") from error

    monkeypatch.setattr(figures, "pressure_map", imported)
    ended, _, said = cli("run", case, "-o", tmp_path / "out")
    assert ended == status
    assert said.count("Interrupted.") == 1
    assert "4 of 4 depths were computed and are kept" in said
