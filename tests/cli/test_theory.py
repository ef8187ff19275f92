"""`restitution compare-theory`: what it prints, what it writes, and what it refuses."""

import csv

import pytest


@pytest.fixture
def case(case_text, tmp_path):
    """The small case as a file, with parts of its text replaced."""

    def write(*replacements):
        text = case_text
        for old, new in replacements:
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "case.toml"
        path.write_text(text)
        return path

    return write


ELASTIC = ('"750 MPa"', '"elastic"')


def test_prints_the_table_and_where_each_theory_holds(cli, case):
    status, said, warned = cli("compare-theory", case())
    assert status == 0
    assert not warned
    lines = said.splitlines()
    for name in ("hertz", "thornton-ning", "johnson", "mdr"):
        at = next(k for k, line in enumerate(lines) if line.startswith(f"{name}: "))
        assert lines[at + 1].startswith("  holds: ")
    assert "Y = p_y/2.8 = 267.9 MPa" in said
    assert "left out: sticking (the case has no work_of_adhesion)" in lines
    rows = [line.split() for line in lines if line.lstrip()[:1].isdigit()]
    assert len(rows) == 25
    assert rows[0][1:3] == ["1.0000", "1.0000"]
    assert rows[0][3] == "-"


def test_the_table_is_split_where_the_terminal_is_narrow(cli, case, monkeypatch):
    monkeypatch.setattr("restitution.cli.console.answers.width", 40)
    status, said, _ = cli("compare-theory", case())
    assert status == 0
    heads = [line for line in said.splitlines() if line.split()[:1] == ["m/s"]]
    assert len(heads) > 1
    assert max(map(len, heads)) <= 40


@pytest.mark.drawn
def test_writes_a_table_and_a_figure(cli, case, tmp_path):
    out = tmp_path / "out"
    status, said, _ = cli("compare-theory", case(), "-o", out)
    assert status == 0
    assert f"In {out}: theory.csv, theory.png" in said
    assert {path.name for path in out.iterdir()} == {"theory.csv", "theory.png"}
    assert (out / "theory.png").read_bytes().startswith(b"\x89PNG")
    with open(out / "theory.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 25
    assert list(rows[0])[:3] == ["velocity_m_per_s", "hertz", "thornton-ning"]


def test_one_velocity_is_a_table_and_a_figure_too(cli, case, tmp_path):
    path = case(
        (
            '[indentation]\nfrom = "20 nm"\nto = "300 nm"\nsteps = 4',
            '[impact]\nvelocity = ["0.5 m/s"]',
        ),
    )
    status, _, _ = cli("compare-theory", path, "-o", tmp_path / "out")
    assert status == 0
    assert len((tmp_path / "out" / "theory.csv").read_text().splitlines()) == 2


def test_says_that_an_elastic_case_has_hertz_only(cli, case, tmp_path):
    status, said, _ = cli("compare-theory", case(ELASTIC), "-o", tmp_path / "out")
    assert status == 0
    assert "only Hertz" in said
    header = (tmp_path / "out" / "theory.csv").read_text().splitlines()[0]
    assert header == "velocity_m_per_s,hertz"
    assert "only Hertz" not in cli("compare-theory", case())[1]


def test_puts_a_law_beside_them(cli, case, tmp_path):
    path, run, law = case(), tmp_path / "run", tmp_path / "law"
    assert cli("run", path, "-o", run)[0] == 0
    assert cli("fit-law", run, "-o", law)[0] == 0
    status, said, _ = cli("compare-theory", path, "--law", law, "-o", tmp_path / "out")
    assert status == 0
    with open(tmp_path / "out" / "theory.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    with open(law / "table.csv", newline="") as file:
        points = list(csv.DictReader(file))
    for name, of_law in (("velocity_m_per_s", "velocity_m_per_s"), ("computed", "restitution")):
        assert [row[name] for row in rows] == [point[of_law] for point in points]
    assert {"constant", "walton-braun", "luding", "eepa", "brilliantov"} <= set(rows[0])
    assert "fitted to the computed e" in said


def test_refuses_a_law_of_another_pair(cli, refused, case, tmp_path):
    run, law = tmp_path / "run", tmp_path / "law"
    assert cli("run", case(), "-o", run)[0] == 0
    assert cli("fit-law", run, "-o", law)[0] == 0
    other = case(('"500 um"', '"400 um"'))
    message = refused("compare-theory", other, "--law", law)
    assert "belongs to another pair: its R* is" in message
    assert "E*" not in message
    assert "m* is" in message


def test_refuses_a_folder_that_holds_no_law(refused, case, tmp_path):
    assert "holds no law" in refused("compare-theory", case(), "--law", tmp_path)


def test_refuses_a_case_without_density(refused, case):
    message = refused("compare-theory", case(('density = "7850 kg/m^3"', "")))
    assert "case.toml: first.density: is missing" in message


def test_refuses_two_walls(refused, case):
    assert "first.radius" in refused("compare-theory", case(('"500 um"', '"flat"')))


def test_refuses_a_folder_that_is_not_empty(refused, case, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "mine.txt").write_text("kept")
    message = refused("compare-theory", case(), "-o", out)
    assert "not empty, and nothing in it is overwritten" in message
    assert [path.name for path in out.iterdir()] == ["mine.txt"]
