"""The end of a run is recorded and its results are kept, whatever ends it."""

from contextlib import nullcontext

import pytest

from points import point
from restitution.curve.curve import Curve
from restitution.errors import DomainError
from restitution.results.writer import ResultsFolder
from restitution.runs.log import RunLog


@pytest.mark.parametrize(
    ("error", "status", "reason"),
    [
        (None, "complete", ""),
        (KeyboardInterrupt(), "interrupted", "stopped by the user"),
        (DomainError("the edge"), "failed", "the edge"),
        (ValueError("a bug\n"), "failed", "stopped by an unexpected error: ValueError a bug"),
    ],
)
def test_it_says_how_a_run_ended_and_keeps_what_there_is(error, status, reason, tmp_path):
    told, out = [], ResultsFolder(tmp_path / "out")
    log = RunLog(tell=told.append)

    def compute():
        log.warn("foreseen")
        if error:
            raise error

    def keep():
        return {"status": log.status, "warnings": [*log.warnings, "found"]}

    with pytest.raises(type(error)) if error else nullcontext(), log.record(out, keep):
        compute()
    assert log.summary["status"] == status
    assert (log.status, log.reason) == (status, reason)
    assert told == ["foreseen", "found"]
    assert out.path.exists()


def test_a_folder_without_results_is_taken_back(tmp_path):
    out = ResultsFolder(tmp_path / "out")
    with pytest.raises(DomainError), RunLog().record(out, dict):
        raise DomainError("the edge")
    assert not out.path.exists()


def test_one_of_several_runs_tells_what_is_foreseen_of_it(tmp_path):
    told, part = [], ResultsFolder(tmp_path / "part")
    log = RunLog(progress=told.append, tell=told.append)
    log.progress_of("realisation 2 of 3")("1 of 4 depths")
    log.warnings_of(part)("foreseen")
    part.curve = Curve((point(),))
    log.warnings_of(part)("found")
    assert told == ["realisation 2 of 3, 1 of 4 depths", "foreseen"]
    assert log.warnings == ["foreseen"]
