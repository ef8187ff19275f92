"""Only one process at a time writes in a folder."""

import pytest

from restitution.errors import OutputError
from restitution.results.locking import locked
from restitution.results.schema import LOCK
from restitution.results.writer import ResultsFolder


def test_a_second_process_is_kept_out_and_no_lock_is_left(tmp_path):
    out = tmp_path / "new" / "out"
    with locked(out):
        with (
            pytest.raises(OutputError, match=f"^{out}: another process is writing to this folder"),
            locked(out),
        ):
            pass
        ResultsFolder(out)  # the lock does not count as content
        (out / "curve.csv").write_text("")
    assert [path.name for path in out.iterdir()] == ["curve.csv"]


def test_a_new_folder_in_which_nothing_was_written_is_removed(tmp_path):
    with locked(tmp_path / "out"):
        pass
    assert not (tmp_path / "out").exists()
    (tmp_path / "out").mkdir()
    with locked(tmp_path / "out"):
        pass
    assert (tmp_path / "out").exists()


@pytest.mark.parametrize("verb", ["run", "converge", "surface"])
def test_the_verbs_refuse_a_folder_in_which_another_process_writes(
    refused, case_text, tmp_path, verb
):
    (tmp_path / "case.toml").write_text(case_text)
    with locked(tmp_path / "out"):
        said = refused(verb, tmp_path / "case.toml", "-o", tmp_path / "out")
        assert "another process is writing to this folder" in said
        assert [path.name for path in (tmp_path / "out").iterdir()] == [LOCK]


def test_files_of_others_stay(refused, case_text, tmp_path):
    (tmp_path / "case.toml").write_text(case_text)
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / ".lock").write_text("of another program")
    assert "is not empty" in refused("run", tmp_path / "case.toml", "-o", tmp_path / "out")
    assert [path.name for path in (tmp_path / "out").iterdir()] == [".lock"]
