"""The figure of theories."""

import numpy as np

from restitution.case.case_file import parse_case
from restitution.laws import theories as room
from restitution.laws.closed_forms import FORMS
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


def test_the_file(points, tmp_path):
    case = case_of()
    V = room.velocities_of(case, points)
    path = drawn.write_theory_figure(case, V, room.theories(case, V, points), tmp_path, points)
    assert path == tmp_path / "theory.png"
    assert path.read_bytes().startswith(b"\x89PNG")


def test_the_figure_draws_what_has_an_answer_and_marks_yield_and_sticking(points):
    case = case_of(WALL, 'work_of_adhesion = "0.01 J/m^2"\n')
    V = np.geomspace(1e-5, 1, 25)
    (axes,) = drawn.theory_figure(case, V, room.theories(case, V)).axes
    names = [text.get_text() for text in axes.get_legend().get_texts()]
    assert "sticking" in names
    assert {text.get_text() for text in axes.texts} == {"$V_y$", "$V_s$"}
    nowhere = {each.name for each in room.theories(case, V) if np.isnan(each.restitution).all()}
    assert not nowhere & set(names)

    V = points.column("velocity")
    (axes,) = drawn.theory_figure(case_of(), V, room.theories(case_of(), V, points), points).axes
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
