"""Two runs or studies side by side."""

import csv

import pytest

from tolerance import approx


@pytest.fixture
def results(cli, case_text, tmp_path):
    """Compute a case with changes into a folder of the given name."""

    def call(name, *replacements, verb="run", more=()):
        text = case_text if verb != "study" else "total_error = false\n" + case_text
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        (tmp_path / f"{name}.toml").write_text(text)
        status, _, said = cli(verb, tmp_path / f"{name}.toml", "-o", tmp_path / name, *more)
        assert status == 0, said
        return tmp_path / name

    return call


def rows_of(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_two_runs(cli, results, tmp_path):
    without = ("\ntitle", "\ntotal_error = false\ntitle")
    a = results("a", without)
    b = results(
        "b", without, ("750 MPa", "500 MPa"), ("A small rough contact", "Softer [bold]x[/bold]")
    )
    status, said, _ = cli("compare", a, b, "-o", tmp_path / "rows.csv")
    assert status == 0
    assert "interface.yield_pressure" in said
    assert "Softer [bold]x[/bold]" in said
    assert "restitution converge" in said
    rows, of_a, of_b = (
        rows_of(path) for path in (tmp_path / "rows.csv", a / "curve.csv", b / "curve.csv")
    )
    assert len(rows) == 4
    for row, one, other in zip(rows, of_a, of_b, strict=True):
        difference = float(other["restitution"]) - float(one["restitution"])
        assert float(row["difference"]) == approx(difference)
        assert row["significant"] == "true"
        assert float(row["force_ratio"]) == approx(float(other["force_N"]) / float(one["force_N"]))


def test_the_same_twice_differs_in_nothing(cli, results):
    status, said, _ = cli("compare", results("a"), results("b"))
    assert status == 0
    assert "largest difference of COR +0.0000" in said
    assert "input" not in said


def test_depths_in_between_are_interpolated_and_others_left_out(cli, results, tmp_path):
    without = ("\ntitle", "\ntotal_error = false\ntitle")
    a = results("a", without, ("steps = 4", "steps = 7"), ('from = "20 nm"', 'from = "15 nm"'))
    b = results("b", without, ("steps = 4", "steps = 12"))
    _, said, _ = cli("compare", a, b, "-o", tmp_path / "rows.csv")
    assert "the second result is interpolated" in said
    assert "outside the range of the second are left out" in said
    rows = rows_of(tmp_path / "rows.csv")
    assert len(rows) == 6
    assert max(abs(float(row["difference"])) for row in rows) < 0.03


def test_errors_of_grids_and_means_count(cli, results, tmp_path):
    a = results("a", verb="converge", more=("--grids", "2"))
    b = results("b", ("seed = 1", "seed = 1\nrealisations = 2"))
    cli("compare", a, b, "-o", tmp_path / "rows.csv")
    for row, one, other in zip(
        rows_of(tmp_path / "rows.csv"),
        rows_of(a / "curve.csv"),
        rows_of(b / "curve.csv"),
        strict=True,
    ):
        half = 0.5 * (float(other["restitution_high"]) - float(other["restitution_low"]))
        grids = [float(each["discretisation_error"]) for each in (one, other)]
        expected = (grids[0] ** 2 + grids[1] ** 2 + half**2) ** 0.5
        assert float(row["error"]) == approx(expected)


def test_two_studies_are_matched_by_what_is_swept(cli, results, tmp_path):
    sweep = "\n[sweep]\n'roughness.seed' = [{}]\n[unloading]"
    a = results("a", ("\n[unloading]", sweep.format("1, 2")), verb="study", more=("--workers", "1"))
    b = results(
        "b",
        ("\n[unloading]", sweep.format("2, 3")),
        ("750 MPa", "500 MPa"),
        verb="study",
        more=("--workers", "1"),
    )
    status, said, _ = cli("compare", a, b, "-o", tmp_path / "rows.csv")
    assert status == 0
    rows = rows_of(tmp_path / "rows.csv")
    assert [row["roughness.seed"] for row in rows] == ["2"] * 4
    assert said.count("1 of 2 cases are in") == 2


def test_what_cannot_be_compared(refused, results, tmp_path):
    a = results("a")
    assert "holds no results" in refused("compare", a, tmp_path)
    study = results(
        "s",
        ("\n[unloading]", "\n[sweep]\n'roughness.seed' = [1]\n[unloading]"),
        verb="study",
        more=("--workers", "1"),
    )
    assert "cannot compare a run with a study" in refused("compare", a, study)
    other = results(
        "t",
        ("\n[unloading]", "\n[sweep]\n'roughness.seed' = [9]\n[unloading]"),
        verb="study",
        more=("--workers", "1"),
    )
    assert "no case has the same swept values" in refused("compare", study, other)
    (tmp_path / "there.csv").write_text("mine")
    assert "is not overwritten" in refused("compare", a, a, "-o", tmp_path / "there.csv")
