"""Stored results are read as they were written, or rejected."""

import json
import math
import shutil

import pytest

from restitution.case.case_file import parse_case
from restitution.errors import OutputError
from restitution.results.checksums import CHECKSUMS
from restitution.results.reader import EnsembleResults, RunResults, read_run
from restitution.results.writer import ResultsFolder
from restitution.runs.run import run_case


@pytest.fixture(scope="module")
def whole(case_text, tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole")
    out = ResultsFolder(folder / "out")
    run_case(parse_case(case_text), case_text, folder, out)
    return out


@pytest.fixture
def copy(whole, tmp_path):
    shutil.copytree(whole.path, tmp_path / "out")
    return tmp_path / "out"


def test_what_was_written_is_read(whole, case_text):
    run = RunResults(whole.path)
    run.check()
    assert run.case_text == case_text
    assert run.case == parse_case(case_text)
    assert [row["restitution"] for row in run.curve.rows] == [
        row["restitution"] for row in whole.rows
    ]
    assert [row["resolved"] for row in run.curve.rows] == [row["resolved"] for row in whole.rows]
    assert math.isnan(run.curve.rows[0]["material_error"])  # the case uses no library values
    assert run.curve.rows[0]["total_error"] == whole.rows[0]["total_error"]
    assert run.dataset["restitution"].values.tolist() == [row["restitution"] for row in whole.rows]


@pytest.mark.parametrize("name", ["curve.csv", "summary.json", "results.nc"])
@pytest.mark.parametrize("where", [0.3, 0.5, 0.9])
def test_a_changed_byte_is_refused(copy, name, where):
    content = bytearray((copy / name).read_bytes())
    content[int(where * len(content))] ^= 1
    (copy / name).write_bytes(content)
    with pytest.raises(OutputError, match=rf"{name}: is damaged"):
        RunResults(copy).check()


def test_a_digit_is_told_by_the_checksum_alone(copy):
    """Only the checksum can detect this, because the number is valid."""
    text = (copy / "curve.csv").read_text()
    last = text.splitlines()[-1].split(",")[7]
    digit = last[-1]
    changed = text.replace(last, f"{last[:-1]}{(int(digit) + 1) % 10}")
    (copy / "curve.csv").write_text(changed)
    with pytest.raises(OutputError, match=r"curve\.csv: is damaged, or was edited"):
        RunResults(copy).curve  # noqa: B018
    (copy / CHECKSUMS).unlink()
    RunResults(copy).curve  # noqa: B018


def changed_cell(column, text):
    def change(lines):
        cells = lines[2].split(",")
        cells[lines[0].split(",").index(column)] = text
        return [*lines[:2], ",".join(cells), *lines[3:]]

    return change


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (changed_cell("restitution", "-7"), "line 3: restitution is -7"),
        (changed_cell("restitution", "1.5"), "line 3: restitution is 1.5"),
        (changed_cell("restitution", ""), "line 3: restitution has no value"),
        (changed_cell("restitution", "nan"), "line 3: restitution is 'nan', not a number"),
        (changed_cell("force_N", "inf"), "line 3: force_N is inf"),
        (changed_cell("force_N", "1.2x"), "line 3: force_N is '1.2x', not a number"),
        (changed_cell("resolved", "yes"), "line 3: resolved is 'yes', not true or false"),
        (lambda lines: [lines[0].replace("force_N", "farce_N"), *lines[1:]], "column force_N is"),
        (
            lambda lines: [lines[0], lines[1][: lines[1].rindex(",")], *lines[2:]],
            "line 2 does not have",
        ),
        (lambda lines: [*lines, "0,0"], "line 6 does not have"),
        (lambda lines: ["a" * 10], "column max_indentation_m is missing"),
        (lambda lines: [f"{lines[0]},sticks", *(f"{r},true" for r in lines[1:])], "the same name"),
        (lambda lines: lines[:-1], "a file is damaged"),
        (lambda lines: [], "column max_indentation_m is missing"),
    ],
)
def test_a_table_that_no_run_writes_is_refused(copy, change, said):
    """The content is checked even if the folder has no checksums."""
    (copy / CHECKSUMS).unlink()
    lines = (copy / "curve.csv").read_text().splitlines()
    (copy / "curve.csv").write_text("\n".join(change(lines)) + "\n")
    with pytest.raises(OutputError) as refused:
        RunResults(copy).check()
    assert said in str(refused.value)
    assert str(copy) in str(refused.value)


@pytest.mark.parametrize(
    ("key", "value"),
    [("derived", None), ("depths_computed", "4"), ("model", {}), ("warnings", [1]), ("status", 0)],
)
def test_a_summary_that_no_run_writes_is_refused(copy, key, value):
    (copy / CHECKSUMS).unlink()
    content = json.loads((copy / "summary.json").read_text())
    (copy / "summary.json").write_text(json.dumps({**content, key: value}))
    with pytest.raises(OutputError, match=rf"summary\.json: is damaged \({key}"):
        RunResults(copy).summary  # noqa: B018
    del content[key]
    (copy / "summary.json").write_text(json.dumps(content))
    with pytest.raises(OutputError, match=rf"summary\.json: is damaged \({key}"):
        RunResults(copy).summary  # noqa: B018


@pytest.mark.parametrize("name", ["curve.csv", "summary.json", "results.nc", CHECKSUMS])
@pytest.mark.parametrize("content", [b"", b"\0" * 5000, bytes(range(128, 256)), None])
def test_what_is_no_such_file_is_refused(copy, name, content):
    (copy / name).unlink()
    if content is None:
        (copy / name).mkdir()
    else:
        (copy / name).write_bytes(content)
    if name == CHECKSUMS and content == b"":
        RunResults(copy).check()
        return
    with pytest.raises(OutputError) as refused:
        RunResults(copy).check()
    assert str(copy / name) in str(refused.value)
    assert "\n" not in str(refused.value)


def test_unloading_curves_are_read_from_the_least_depth_up(whole):
    curves = RunResults(whole.path).unloading
    assert [curve.start for curve in curves] == sorted(start for start, _ in whole.unloading)
    for curve, (_, points) in zip(curves, sorted(whole.unloading), strict=True):
        assert list(zip(curve.indentation, curve.force, strict=True)) == points[::-1]
        assert curve.indentation[-1] == curve.start


def test_an_ensemble_is_told_by_its_summary(whole, copy):
    assert not isinstance(read_run(whole.path), EnsembleResults)
    (copy / CHECKSUMS).unlink()
    content = json.loads((copy / "summary.json").read_text()) | {"realisations": [{}, {}]}
    (copy / "summary.json").write_text(json.dumps(content))
    run = read_run(copy)
    assert isinstance(run, EnsembleResults)
    assert run.surfaces == 2
