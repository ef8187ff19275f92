"""Forty numbers of the command line, so that a change of the house that moves one does not pass.

`python tests/cli/test_numbers.py` writes them anew, after a change that is meant to move them; the
CHANGELOG then says which moved and why.
"""

import csv
import json
import sys
import tempfile
from pathlib import Path
from unittest import mock

from restitution.cli import main
from tolerance import approx

FILE = Path(__file__).with_name("numbers.json")
CASE = """
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
{interface}
[roughness]
kind = "{kind}"
rms = "0.03 um"
correlation_length = "3 um"
seed = 3
[grid]
nodes = 96
spacing = "0.5 um"
[indentation]
from = "20 nm"
to = "600 nm"
steps = 5
"""
RUNS = {
    "constant": ('yield_pressure = "1.5 GPa"', "gaussian"),
    "growing": ('yield_strength = "600 MPa"', "exponential"),
    "truncated": ('yield_pressure = "1.5 GPa"\nplasticity = "truncated"', "gaussian"),
    "adhesive": ('yield_pressure = "1.5 GPa"\nwork_of_adhesion = "0.2 J/m^2"', "gaussian"),
}
COLUMNS = {
    "constant": ("force_N", "contact_area_m2", "loading_work_J", "restitution", "model_error"),
    "growing": ("force_N", "loading_work_J", "unloading_work_J", "restitution", "model_error"),
    "truncated": ("force_N", "loading_work_J", "restitution"),
    "adhesive": ("force_N", "pull_off_force_N", "restitution", "restitution_error"),
}
# Kernels and processors round differently, which changes the numbers by less than 1e-7. The two
# numbers that depend on when unloading releases nodes change by up to 2e-5.
ROUNDING = 1e-6
ROUNDING_OF_RELEASE = 2e-4
OF_RELEASE = ("adhesive pull_off_force_N", "adhesive restitution_error")


def command(*arguments):
    """Call the command line in this process, and expect success."""
    with mock.patch.object(sys, "argv", ["restitution", *map(str, arguments)]):
        status = 0
        try:
            main()
        except SystemExit as end:
            status = end.code
    assert not status, arguments


def table(file):
    lines = [line for line in file.read_text().splitlines() if not line.startswith("#")]
    return list(csv.DictReader(lines))


def compute(folder):
    """The numbers by name, from runs below `folder`."""
    found = {}
    for name, (interface, kind) in RUNS.items():
        case, out = folder / f"{name}.toml", folder / name
        # The total error takes most of a run; one of the runs has it.
        total = "" if name == "constant" else "total_error = false\n"
        case.write_text(total + CASE.format(interface=interface, kind=kind))
        command("run", case, "-o", out)
        rows = table(out / "curve.csv")
        for column in COLUMNS[name]:
            for row in (1, 4) if name == "growing" else (2, 4):
                found[f"{name} {column} {row}"] = float(rows[row][column])
    command("fit-law", folder / "constant", "-o", folder / "law")
    for column in ("velocity_m_per_s", "restitution", "compact_fit"):
        found[f"law {column}"] = float(table(folder / "law" / "table.csv")[-1][column])
    command("export", folder / "law", "--to", "csv", "-o", folder / "export")
    last = table(folder / "export" / "restitution.csv")[-1]
    for column in ("restitution_error", "largest_force_N", "reduced_mass_kg"):
        found[f"export {column}"] = float(last[column])
    study = folder / "study.toml"
    study.write_text(
        (folder / "growing.toml").read_text()
        + '[sweep]\n"roughness.rms" = ["0.02 um", "0.05 um"]\n'
    )
    command("study", study, "-o", folder / "study", "--workers", 1)
    for number, row in enumerate(table(folder / "study" / "table.csv")):
        found[f"study row {number}"] = float(row["restitution"])
    return found


def test_numbers_have_not_moved(tmp_path, monkeypatch):
    # Figures are built, but their pixels are not drawn.
    monkeypatch.setattr("matplotlib.figure.Figure.savefig", lambda _, to, **__: Path(to).touch())
    stored = json.loads(FILE.read_text())
    assert len(stored) >= 40
    found = compute(tmp_path)
    assert found.keys() == stored.keys()
    for name, value in stored.items():
        rounding = ROUNDING_OF_RELEASE if name.startswith(OF_RELEASE) else ROUNDING
        assert found[name] == approx(value, rel=rounding), name


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        FILE.write_text(json.dumps(compute(Path(folder)), indent=1) + "\n")
