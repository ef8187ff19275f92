"""Tables of measured restitution: read, or refused in one line."""

import os

import pytest

from restitution.errors import CaseError
from restitution.fit.measured import read_measured
from tolerance import approx

HEAD = "velocity_m_per_s,restitution,restitution_std\n"


def test_rows_are_sorted_and_other_columns_ignored(tmp_path):
    path = tmp_path / "m.csv"
    path.write_text(
        "\ufeffnote, restitution ,velocity_m_per_s,restitution_error\n"
        "b,0.7,0.2,0.03\n\na,0.8,0.1,0.02\n",
        encoding="utf-8",
    )
    found = read_measured(path)
    assert found.velocity == approx([0.1, 0.2])
    assert found.restitution == approx([0.8, 0.7])
    assert found.deviation == approx([0.02, 0.03])


def test_deviations_may_be_left_out_and_std_comes_first(tmp_path):
    path = tmp_path / "m.csv"
    path.write_text("velocity_m_per_s,restitution\n0.1,0.8\n")
    assert read_measured(path).deviation is None
    path.write_text(HEAD.replace("\n", ",restitution_error\n") + "0.1,0.8,0.01,0.5\n")
    assert read_measured(path).deviation == approx([0.01])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "the column velocity_m_per_s (impact velocities in m/s) is missing"),
        ("velocity,restitution\n1,0.5\n", 'this file has "velocity", "restitution"'),
        ("velocity_m_per_s;restitution\n1;0.5\n", "separated by commas"),
        ("velocity_m_per_s,e\n1,0.5\n", "the column restitution (e, 0 to 1) is missing"),
        ("restitution,velocity_m_per_s,restitution\n1,1,1\n", "more than one column restitution"),
        (HEAD, "has no rows"),
        (HEAD + "0.1 m/s,0.5,0.1\n", "in m/s, without the unit"),
        (HEAD + "0.1,0.5,0.1\n-1,0.5,0.1\n", 'line 3: velocity_m_per_s = "-1" is not a velocity'),
        (HEAD + "0,0.5,0.1\n", "is not a velocity of 1e-09 to 10000 m/s"),
        (HEAD + "nan,0.5,0.1\n", "is not a number"),
        (HEAD + "0.1,-0.1,0.1\n", 'restitution = "-0.1" is negative'),
        (HEAD + "0.1,1.4,0.1\n", 'restitution = "1.4" is above 1.3, which is 1 and 3 standard'),
        (
            "velocity_m_per_s,restitution\n0.1,1.07\n",
            "is above 1.06, which is 1 and 3 standard deviations of 0.02, assumed because the "
            "column restitution_std is missing",
        ),
        (HEAD + "0.1,,0.1\n", 'restitution = "" is not a number'),
        (HEAD + "0.1,0.5\n", 'restitution_std = "" is not a number'),
        (HEAD + "0.1,0.5,0\n", 'restitution_std = "0" is not a standard deviation'),
        ('a,"b\n', "is not a CSV file"),
    ],
)
def test_bad_tables_are_refused(tmp_path, text, words):
    path = tmp_path / "m.csv"
    path.write_text(text)
    with pytest.raises(CaseError) as refusal:
        read_measured(path)
    assert words in str(refusal.value)
    assert str(refusal.value).startswith(f"{path}: ")
    assert "\n" not in str(refusal.value)


def test_noise_above_one_is_kept(tmp_path):
    path = tmp_path / "m.csv"
    path.write_text(HEAD + "0.1,1.0035,0.01\n0.2,1.029,0.01\n")
    assert read_measured(path).restitution == approx([1.0035, 1.029])
    path.write_text("velocity_m_per_s,restitution\n0.1,1.0035\n")
    assert read_measured(path).restitution == approx([1.0035])


def test_what_is_no_file_is_refused(tmp_path):
    for path, words in ((tmp_path / "none.csv", "cannot be read"), (tmp_path, "is a folder")):
        with pytest.raises(CaseError, match=words):
            read_measured(path)
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(CaseError, match="is not a regular file"):
        read_measured(tmp_path / "pipe")
    (tmp_path / "b.csv").write_bytes(b"\xff\xfe\x00\x01")
    with pytest.raises(CaseError, match="is not a CSV file in UTF-8"):
        read_measured(tmp_path / "b.csv")
