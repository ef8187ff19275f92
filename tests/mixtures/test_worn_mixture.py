"""A mixture with many impacts: laws, table, report and exports at its coverage."""

import csv
import json
import math

import pytest

from restitution import open_results
from restitution.dem.export import export
from restitution.laws.law_files import read_laws
from restitution.pages.report import write_report
from tolerance import approx

MIXTURE = """
title = "Worn beads"
[materials.alu]
material = "aluminium"
radius = "50 um"
roughness = { kind = "gaussian", rms = "0.05 um", correlation_length = "2 um", seed = 1 }
[walls.drum]
material = "pmma"
[interface]
work_of_adhesion = "0 J/m^2"
yield_pressure = "1 GPa"
[grid]
nodes = 16
spacing = "1.2 um"
[impact]
velocity = "2 m/s"
[impacts]
coverage = 0.5
places = 2
"""

pytestmark = pytest.mark.filterwarnings("ignore::UserWarning")  # of a coarse grid


@pytest.fixture(scope="module")
def folder(tmp_path_factory, compute_mixture):
    return compute_mixture(MIXTURE, tmp_path_factory.mktemp("worn") / "out")


def test_laws_and_tables_are_those_at_the_coverage(folder):
    laws = {f"{law.first.name}+{law.second.name}": law for law in read_laws([folder])}
    assert {law.coverage for law in laws.values()} == {0.5}
    with (folder / "pairs.csv").open(newline="") as file:
        rows = {f"{row['first']}+{row['second']}": row for row in csv.DictReader(file)}
    for case in (folder / "runs").glob("case-*"):
        run = open_results(case)
        name = run.summary["title"].split(",")[0]
        (point,) = laws[name].points
        worn = run.run_in[-1]
        assert worn.coverage == approx(0.5, abs=0.1)
        share = math.prod(point.factors.values())  # of waves in the drum
        assert point.restitution == approx(share * worn.restitution, rel=0.02)
        assert point.deviation == approx(share * worn.restitution_std, rel=0.02)
        assert point.quantiles[2] == approx(share * worn.restitution_50, rel=0.02)
        assert float(rows[name]["restitution"]) == approx(point.restitution)
        assert float(rows[name]["restitution_std"]) == approx(point.deviation)
        assert float(rows[name]["coverage"]) == 0.5
        # Both beads are rough; the drum, which yields, is not.
        assert run.summary["run_in"]["rough"] == ("both" if name == "alu+alu" else "first")
    assert json.loads((folder / "summary.json").read_text())["coverage"] == 0.5


def test_the_report_and_the_exports_say_the_coverage(folder):
    report = write_report(folder).read_text("utf-8")
    assert "surfaces that earlier impacts have covered 0.5 times" in report
    laws = read_laws([folder])
    assert (
        "that earlier impacts have covered 0.5 times"
        in export(laws, "lammps", 2.0)["restitution_lammps.txt"]
    )
    rows = list(csv.DictReader(export(laws, "csv", None)["restitution.csv"].splitlines()))
    points = [point for law in laws for point in law.points]
    assert [float(row["restitution_std"]) for row in rows] == approx([p.deviation for p in points])
    medians = [float(row["restitution_50"]) for row in rows]
    assert medians == approx([p.quantiles[2] for p in points])
