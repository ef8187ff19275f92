"""The figure and the page of oblique impacts."""

import math

import numpy as np
import pytest

import restitution as rs
from restitution.curve.columns import array
from restitution.impacts.oblique import full_slip_angle
from restitution.pages.run import write_run_page
from restitution.plots.figure import Line, Mark, Points
from restitution.plots.oblique import oblique_figure
from restitution.plots.run import run_figures
from tolerance import approx

CASE = {
    "title": "oblique <b>",
    "total_error": False,
    "first": {"material": "steel", "radius": "500 um"},
    "interface": {"yield_pressure": "elastic", "friction": 0.1, "work_of_adhesion": "0 J/m^2"},
    "grid": {"nodes": 64, "spacing": "0.5 um"},
    "impact": {"velocity": ["0.02 m/s", "0.05 m/s"], "angle": ["0 deg", "15 deg", "50 deg"]},
}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return rs.run(CASE, out=tmp_path_factory.mktemp("figure") / "out")


def test_each_chart_has_the_values_of_the_table_and_the_angle_of_full_slip(run):
    charts = oblique_figure(run.dataset).panels
    columns = ("tangential_restitution", "rebound_angle", "first_spin")
    ratio = run.case.pair().tangential_modulus / run.case.pair().contact_modulus
    for chart, column, scale in zip(charts, columns, (1, math.degrees(1), 1), strict=True):
        points = [each for each in chart.series if isinstance(each, Points)]
        assert [each.label for each in points] == ["0.02 m/s", "0.05 m/s"]
        rows = [row for row in run.oblique if row.velocity == 0.05]
        values = scale * array(rows, column)
        known = np.isfinite(values)
        assert points[1].y == approx(values[known], abs=1e-9)
        assert points[1].x == approx(np.array([0, 15, 50.0])[known], abs=1e-9)
        (mark,) = (each for each in chart.series if isinstance(each, Mark))
        assert mark.value == approx(math.degrees(full_slip_angle(0.1, 1.0, ratio)), rel=1e-3)
        slides = [bool(row.slides) for row in rows]
        assert slides == [angle > mark.value for angle in (0, 15, 50)]
        assert list(~points[1].open) == list(np.array(slides)[known])
    (line,) = (each for each in charts[0].series if isinstance(each, Line))
    assert line.y[-1] == approx(run.oblique[-1].tangential_restitution, rel=1e-4)
    assert np.isfinite(charts[0].series[0].y).all()  # a head-on impact has no e_t


def test_with_a_spin_no_range_of_full_slip_is_drawn(run):
    turning = run.dataset.copy()
    turning["oblique_first_spin_before"] = turning["oblique_first_spin_before"] + 10.0
    for chart in oblique_figure(turning).panels:
        assert not [each for each in chart.series if isinstance(each, Line | Mark)]


def test_the_figure_is_one_of_the_run_and_its_page_has_the_numbers(run):
    assert "oblique" in dict(run_figures(run.dataset))
    text = write_run_page(run.folder).read_text(encoding="utf-8")
    assert "Oblique impacts" in text
    row = run.oblique[-1]
    assert f"{row.tangential_restitution:.5g}" in text
    assert f"{row.first_spin:.5g}" in text


def test_a_run_without_oblique_impacts_has_no_such_figure(run):
    names = [name for name in run.dataset if str(name).startswith("oblique")]
    assert "oblique" not in dict(run_figures(run.dataset.drop_vars(names)))


def test_collisions_in_python_take_texts_numbers_and_the_friction_of_the_case(run):
    row = run.oblique[-1]
    one = rs.collide_obliquely(run, "0.05 m/s", "50 deg")
    other = rs.collide_obliquely(str(run.folder), 0.05, math.radians(50), friction=0.1)
    assert one.tangential_restitution == approx(row.tangential_restitution, rel=1e-5)
    assert other.tangential_restitution == one.tangential_restitution
    turned = rs.collide_obliquely(run, 0.04, 0.0, spin=("60 rpm", -2 * math.pi))
    assert turned.spins[0] == approx(2 * math.pi)  # equal and opposite spins roll
    assert isinstance(one, rs.ObliqueCollision)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"angle": "95 deg"}, "angle: .* is not an angle of impact"),
        ({"angle": 1.6}, "below 90 degrees"),
        ({"angle": "1 m"}, "angle: .* is not an angle"),
        ({"velocity": "1 N"}, "velocity: .* is not a velocity"),
        ({"spin": "10 Hz"}, "spin: .* is not a spin"),
        ({"friction": -1.0}, "give 0 or more"),
    ],
)
def test_wrong_arguments_are_refused(run, given, words):
    with pytest.raises(rs.RestitutionError, match=words):
        rs.collide_obliquely(run, **({"velocity": 0.04, "angle": 0.3} | given))


def test_the_command_line_takes_friction_and_angles_of_the_case(run, cli, refused):
    status, said, _ = cli("simulate", run.folder)
    assert status == 0
    assert len([line for line in said.splitlines() if line.strip().startswith("0.0")]) == 6
    _, said, _ = cli("simulate", run.folder, "--velocity", "0.04 m/s", "--spin", "10 rpm")
    assert len([line for line in said.splitlines() if line.strip().startswith("0.04")]) == 3
    assert "--spin: " in refused("simulate", run.folder, "--spin", "10 Hz")
    many = [word for k in range(3) for word in ("--spin", f"{k} rpm")]
    assert "3 values for two bodies" in refused("simulate", run.folder, *many)
    assert "90 degrees" in refused("simulate", run.folder, "--angle", "90 deg")
