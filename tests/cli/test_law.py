"""`restitution fit-law`: what it shows while it works, and what it prints."""

import csv
import io

from rich.console import Console


def test_it_says_which_law_it_is_fitting(cli, case_text, tmp_path, monkeypatch):
    case, run = tmp_path / "case.toml", tmp_path / "run"
    case.write_text(case_text)
    assert cli("run", case, "-o", run)[0] == 0
    terminal = Console(file=io.StringIO(), force_terminal=True, width=100)
    monkeypatch.setattr("restitution.cli.console.errors", terminal)
    assert cli("fit-law", run, "-o", tmp_path / "law")[0] == 0
    shown = terminal.file.getvalue()
    steps = [
        "reading the results",
        "fitting constant (1 of 7)",
        "fitting thornton-ning (3 of 7)",
        "fitting lammps-mdr (7 of 7)",
        "drawing the figure",
    ]
    places = [shown.find(step) for step in steps]
    assert -1 not in places
    assert places == sorted(places)


def test_it_prints_the_error_of_cor_beside_those_of_the_fits(cli, case_text, tmp_path):
    case, run, law = tmp_path / "case.toml", tmp_path / "run", tmp_path / "law"
    case.write_text(case_text)
    assert cli("run", case, "-o", run)[0] == 0
    status, printed, _ = cli("fit-law", run, "-o", law)
    assert status == 0
    with (law / "table.csv").open() as file:
        largest = max(float(row["restitution_error"]) for row in csv.DictReader(file))
    assert f"an error of up to {largest:.2g}." in printed
