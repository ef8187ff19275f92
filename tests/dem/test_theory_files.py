"""Theories as a table and as a figure."""

import csv

import numpy as np
import pytest

from restitution.dem import theories as room
from restitution.dem.closed_forms import FORMS
from restitution.dem.theory_files import theory_lines, write_theories
from restitution.errors import OutputError
from restitution.plots import theories as plotted
from restitution.plots.static import draw
from restitution.studies.case import parse_case

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


def drawing(case, V, points=None):
    lines = theory_lines(case, V, room.theories(case, V, points))
    return draw(plotted.theory_figure(case.title, lines, room.marks(case), points))


def names_of(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


def test_the_table(points, tmp_path):
    case = case_of()
    V = room.velocities_of(case, points)
    found = room.theories(case, V, points)
    written = write_theories(V, found, tmp_path / "out")
    assert written == tmp_path / "out" / "theory.csv"
    with open(written, newline="") as file:
        rows = list(csv.DictReader(file))
    assert list(rows[0]) == ["velocity_m_per_s", *(each.name for each in found)]
    for each in found:
        column = [float(row[each.name] or "nan") for row in rows]
        np.testing.assert_array_equal(column, each.restitution)
    assert rows[0]["johnson"] == ""
    with pytest.raises(OutputError, match="not empty"):
        write_theories(V, found, tmp_path / "out")


def test_the_figure_draws_what_has_an_answer_and_marks_yield_and_sticking(points):
    case = case_of(WALL, 'work_of_adhesion = "0.01 J/m^2"\n')
    V = np.geomspace(1e-5, 1, 25)
    figure = drawing(case, V)
    (axes,), names = figure.axes, names_of(figure)
    assert "sticking" in names
    assert {text.get_text() for text in axes.texts} == {"$V_y$", "$V_s$"}
    nowhere = {each.name for each in room.theories(case, V) if np.isnan(each.restitution).all()}
    assert not nowhere & set(names)

    V = points.column("velocity")
    names = names_of(drawing(case_of(), V, points))
    assert names[0] == "computed"
    assert "luding (fit)" in names


def test_every_theory_has_a_line_of_its_own(points):
    names = {
        *FORMS,
        *(each.name for each in room.theories(case_of(), points.column("velocity"), points)),
    }
    lines = [plotted._LINES[name] for name in names - {"computed"}]
    assert len(set(lines)) == len(lines)
