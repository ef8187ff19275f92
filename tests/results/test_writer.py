import pytest

from restitution.errors import OutputError
from restitution.results.schema import LOCK
from restitution.results.writer import (
    ResultsFolder,
    make_folder,
    replace_file,
    require_new_file,
    write_json,
)


def test_a_new_folder_is_taken_back_when_nothing_was_computed(tmp_path):
    folder = ResultsFolder(tmp_path / "new")
    with folder.tables():
        pass
    folder.discard()
    assert not (tmp_path / "new").exists()


def test_an_empty_folder_of_the_user_stays(tmp_path):
    (tmp_path / "mine").mkdir()
    ResultsFolder(tmp_path / "mine").discard()
    assert (tmp_path / "mine").is_dir()


def test_a_file_is_replaced_whole_or_not_at_all(tmp_path):
    path = tmp_path / "file.json"
    write_json(path, {"a": 1})

    def half(to):
        to.write_text("ha")
        raise OSError(28, "No space left on device")

    with pytest.raises(OutputError, match="No space left on device"):
        replace_file(path, half)
    assert path.read_text() == '{\n  "a": 1\n}\n'
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize(("off", "warned"), [(0.009, False), (0.011, True), (-0.02, True)])
def test_unloading_that_returns_another_work_is_warned_of(off, warned):
    """The work differs by more than 1 % of the stored energy, up or down."""
    from restitution.runs.result_warnings import unbalanced

    check = {"relative_to_stored_energy": off, "max_indentation_m": 1e-7}
    lines = list(unbalanced([check]))
    assert len(lines) == warned
    assert all(f"{off:+.1%}" in line for line in lines)


def test_nothing_is_written_over_what_is_there(tmp_path):
    assert make_folder(tmp_path / "new" / "folder")
    assert not make_folder(tmp_path / "new" / "folder")
    (tmp_path / "new" / "folder" / LOCK).touch()
    assert not make_folder(tmp_path / "new" / "folder")
    with pytest.raises(OutputError, match=r"not empty.*another folder with -o, or go home"):
        make_folder(tmp_path / "new", "go home")
    require_new_file(None)
    require_new_file(tmp_path / "new.csv")
    with pytest.raises(OutputError, match="already exists and is not overwritten"):
        require_new_file(tmp_path / "new")
