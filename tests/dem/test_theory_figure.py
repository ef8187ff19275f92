"""Theories as files and as a figure."""

import csv

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.dem import theories as room
from restitution.dem.closed_forms import FORMS
from restitution.errors import OutputError
from restitution.reports import theory_figure as drawn

CASE = """
[first]
radius = "1 mm"
youngs_modulus = "70 GPa"
poissons_ratio = 0.25
density = "2500 kg/m^3"
{more}
[grid]
nodes = 64
spacing = "1 um"
[impact]
from = "1 mm/s"
to = "100 m/s"
steps = 3
[interface]
yield_pressure = "560 MPa"
"""
WALL = '[second]\nradius = "flat"\nyoungs_modulus = "200 GPa"\npoissons_ratio = 0.3\n'


def case_of(more="", adhesion=""):
    return parse_case(CASE.format(more=more) + adhesion)


def test_the_files(points, tmp_path):
    case = case_of()
    V = room.velocities_of(case, points)
    found = room.theories(case, V, points)
    written = drawn.write_theories(case, V, found, tmp_path / "out", points)
    assert [path.name for path in written] == ["theory.csv", "theory.png"]
    with open(written[0], newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["velocity_m_per_s", *(each.name for each in found)]
    for each in found:
        column = [float(row[each.name] or "nan") for row in rows]
        np.testing.assert_array_equal(column, each.restitution)
    assert rows[0]["johnson"] == ""
    with pytest.raises(OutputError, match="not empty"):
        drawn.write_theories(case, V, found, tmp_path / "out")


def test_the_figure_draws_what_has_an_answer_and_marks_yield_and_sticking(points):
    case = case_of(WALL, 'work_of_adhesion = "0.01 J/m^2"\n')
    V = np.geomspace(1e-5, 1, 25)
    (axes,) = drawn.figure(case, V, room.theories(case, V)).axes
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "sticking" in names
    assert {text.get_text() for text in axes.texts} == {"$V_y$", "$V_s$"}
    nowhere = {each.name for each in room.theories(case, V) if np.isnan(each.restitution).all()}
    assert not nowhere & set(names)

    V = points.column("velocity")
    (axes,) = drawn.figure(case_of(), V, room.theories(case_of(), V, points), points).axes
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert names[0] == "computed"
    assert "luding (fit)" in names


def test_every_theory_has_a_line_of_its_own(points):
    names = {
        *FORMS,
        *(each.name for each in room.theories(case_of(), points.column("velocity"), points)),
    }
    lines = [drawn._LINES[name] for name in names - {"computed"}]
    assert len(set(lines)) == len(lines)
