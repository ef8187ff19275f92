"""The figure of theories."""

import numpy as np

from restitution.case.case_file import parse_case
from restitution.compare import theories as room
from restitution.compare.closed_forms import FORMS
from restitution.plots import law as plotted
from restitution.plots.law import LAW_LINES
from restitution.plots.static import draw

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
    lines = room.theory_lines(case, V, room.theories(case, V, points))
    return draw(plotted.theory_figure(case.title, lines, room.marks(case), points))


def names_of(figure):
    return [text.get_text() for text in figure.legends[0].get_texts()]


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
    lines = [LAW_LINES[name] for name in names - {"computed"}]
    assert len(set(lines)) == len(lines)
