"""Collisions in time, compared with closed forms and with energies."""

import csv
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.cli import console
from restitution.contact.bodies import Body, Pair
from restitution.errors import CaseError, DomainError, NotConvergedError, OutputError
from restitution.impacts.stored_force import StoredForce, loading_force, stored_force
from restitution.impacts.time_integration import collide_in_time, course
from restitution.laws.from_results import bare_law
from restitution.results.writer import ResultsFolder
from restitution.runs.ensemble import run_realisations
from restitution.theory import ThorntonNing
from tolerance import approx

STEEL = Body(500e-6, 210e9, 0.25, 7850.0)
SMALL = Body(100e-6, 70e9, 0.2, 2500.0)
WALL = Body(math.inf, 70e9, 0.3)
P_Y = 750e6


def closed_form(pair, p_y, depths):
    """Thornton and Ning's force law in the form of a stored run."""
    smooth = ThorntonNing(pair.radius, pair.contact_modulus, p_y)
    curves = []
    for deepest in depths:
        end = float(smooth.residual_indentation(deepest))
        x = end + (deepest - end) * np.linspace(0, 1, 60) ** 2
        curves.append((x, smooth.unloading_force(x, deepest)))
    return StoredForce(
        pair=pair,
        deepest=float(depths[-1]),
        highest=float(smooth.impact_velocity(depths[-1], pair.mass)),
        loading=lambda x: float(smooth.loading_force(max(x, 0.0))),
        separation=lambda x: float(smooth.residual_indentation(x)),
        unloading_from=np.asarray(depths),
        unloading=tuple(curves),
    )


@pytest.mark.parametrize("second", [STEEL, SMALL, WALL])
def test_thornton_and_nings_spheres(second):
    pair = Pair(STEEL, second)
    smooth = ThorntonNing(pair.radius, pair.contact_modulus, P_Y)
    depths = np.geomspace(20e-9, 2e-6, 6)
    law = closed_form(pair, P_Y, depths)
    for deepest in depths[1:]:
        velocity = float(smooth.impact_velocity(deepest, pair.mass))
        found = collide_in_time(law, velocity)
        assert found.largest_indentation == approx(deepest, rel=1e-6)
        exact = smooth.restitution(velocity, pair.mass)
        assert found.restitution == approx(float(exact), abs=2e-4)
        assert not found.blended


def test_an_elastic_collision_lasts_as_long_as_hertz_says():
    """t_c = 2.9432 (m*²/(k² V))^⅕ with F = kδ^1.5 (Johnson 1985, eq. 11.24), and e = 1."""
    pair = Pair(STEEL, STEEL)
    law = closed_form(pair, 1e12, np.array([1e-7, 1e-6]))
    k = 4 / 3 * pair.contact_modulus * math.sqrt(pair.radius)
    velocity = 0.999 * law.highest
    found = collide_in_time(law, velocity)
    exact = 2.9432 * (15 / 16 * pair.mass / (math.sqrt(pair.radius) * pair.contact_modulus)) ** 0.4
    assert found.duration == approx(exact * velocity**-0.2, rel=2e-4)
    assert found.restitution == approx(1, abs=2e-4)
    assert found.largest_force == approx(k * found.largest_indentation**1.5, rel=1e-9)


def test_momentum_is_kept_and_a_wall_stays():
    pair = Pair(STEEL, SMALL)
    found = collide_in_time(closed_form(pair, P_Y, np.geomspace(1e-8, 1e-6, 5)), 0.1)
    momentum = STEEL.mass * found.rebound_first + SMALL.mass * found.rebound_second
    assert abs(momentum) < 1e-6 * SMALL.mass * 0.1
    assert found.rebound_second - found.rebound_first == approx(0.1 * found.restitution, rel=1e-9)
    assert found.blended
    wall = collide_in_time(closed_form(Pair(STEEL, WALL), P_Y, np.geomspace(1e-8, 1e-6, 5)), 0.05)
    assert wall.rebound_second == 0


def test_equal_spheres_rebound_with_opposite_velocities():
    pair = Pair(STEEL, STEEL)
    found = collide_in_time(closed_form(pair, P_Y, np.geomspace(1e-8, 1e-6, 5)), 0.1)
    assert found.rebound_first == approx(-found.rebound_second, rel=1e-12)


def shaped(depths, powers, *, end=0.25):
    """A law that unloads from each depth with a power of the part that is left."""
    s = np.linspace(0, 1, 400)
    return StoredForce(
        pair=Pair(STEEL, STEEL),
        deepest=depths[-1],
        highest=1.0,
        loading=lambda x: 3e6 * x,
        separation=lambda x: end * x,
        unloading_from=np.array(depths),
        unloading=tuple(
            (d * (end + (1 - end) * s), 3e6 * d * s**power)
            for d, power in zip(depths, powers, strict=True)
        ),
    )


def test_between_two_depths_the_curves_are_mixed_by_the_logarithm_of_the_depth():
    law = shaped([1e-7, 4e-7, 6e-7], [1.0, 3.0, 2.0])
    for deepest, upper in ((1e-7, 0.0), (1.5e-7, math.log(1.5) / math.log(4)), (4e-7, 1.0)):
        force, separated, blended = law.branch(deepest)
        assert separated == 0.25 * deepest
        assert blended == (0 < upper < 1)
        for s in (0.1, 0.5, 0.8):
            expected = 3e6 * deepest * ((1 - upper) * s + upper * s**3)
            assert force(deepest * (0.25 + 0.75 * s)) == approx(expected, rel=1e-4)
    force, *_ = law.branch(5e-7)
    upper = math.log(5 / 4) / math.log(6 / 4)
    expected = 3e6 * 5e-7 * ((1 - upper) * 0.5**3 + upper * 0.5**2)
    assert force(5e-7 * 0.625) == approx(expected, rel=1e-4)


def test_a_stored_curve_serves_depths_that_differ_by_rounding():
    law = shaped([1e-7, 4e-7], [1.0, 3.0])
    for deepest in (1e-7 * (1 - 5e-6), 1e-7 * (1 + 5e-6), 4e-7 * (1 + 5e-6)):
        _, _, blended = law.branch(deepest)
        assert not blended
    for deepest in (1e-7 * (1 - 2e-5), 4e-7 * (1 + 2e-5)):
        with pytest.raises(DomainError, match="stored only from 100 nm to 400 nm"):
            law.branch(deepest)


class Still(StoredForce):
    """A pair that no force drives apart again."""

    def branch(self, deepest):
        return (lambda _: 0.0), 0.0, False


def test_bodies_that_never_part_have_no_restitution():
    law = Still(**vars(shaped([1e-7, 4e-7], [1.0, 1.0])))
    with pytest.raises(NotConvergedError, match=r"at 0\.01 m/s did not end"):
        collide_in_time(law, 0.01)


def test_with_adhesion_the_force_is_linear_up_to_the_first_depth():
    """It does the stored work there, although it pulls at first."""
    depth, force, work = np.array([2e-8, 5e-8]), np.array([1e-3, 6e-3]), np.array([-4e-11, 5e-11])
    pushing = loading_force(depth, force, work)
    x = np.linspace(0, depth[0], 5)
    F = [pushing(float(each)) for each in x]
    assert approx(np.linspace(F[0], force[0], 5)) == F
    assert 0.5 * (F[0] + F[-1]) * depth[0] == approx(work[0])


CASE = """
total_error = false
[first]
radius = "500 um"
youngs_modulus = "210 GPa"
poissons_ratio = 0.25
density = "7850 kg/m^3"
[interface]
yield_pressure = "750 MPa"
{adhesion}
[roughness]
kind = "gaussian"
rms = "{rms}"
correlation_length = "{length}"
seed = 3
[grid]
nodes = {nodes}
spacing = "{spacing}"
[indentation]
from = "{first}"
to = "{last}"
steps = {steps}
[unloading]
curves = {steps}
"""
ROUGH = {"rms": "20 nm", "length": "3 um", "nodes": 96, "spacing": "0.6 um"}
ROUGH |= {"first": "50 nm", "last": "1 um"}
ADHESIVE = {"rms": "1 nm", "length": "3 um", "nodes": 40, "spacing": "0.192 um"}
ADHESIVE |= {"first": "10 nm", "last": "40 nm"}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    def make(text=CASE, **values):
        text = text.format(**values)
        out = tmp_path_factory.mktemp("run") / "out"
        run_realisations(parse_case(text), text, out.parent, ResultsFolder(out))
        return out

    return make


@pytest.mark.parametrize(
    "values",
    [
        {**ROUGH, "adhesion": "", "steps": 6},
        {**ROUGH, "adhesion": 'plasticity = "truncated"', "steps": 4},
        {**ADHESIVE, "adhesion": 'work_of_adhesion = "0.5 J/m^2"', "steps": 2},
    ],
)
def test_restitution_in_time_is_that_of_the_energies(run, values):
    out = run(**values)
    force, law = stored_force(out), bare_law(out)
    assert len(law.points) == values["steps"]
    for point in law.points:
        found = collide_in_time(force, point.velocity)
        # Balances of an adhesive contact scatter within its error, much less than this error.
        assert found.restitution == approx(point.restitution, abs=max(1e-3, 0.1 * point.error))
        assert found.largest_indentation == approx(point.indentation, rel=1e-6)
        assert found.largest_force == approx(point.force, rel=1e-4)


def test_between_stored_curves_it_is_near_and_beyond_them_refused(run):
    out = run(**ROUGH, adhesion="", steps=8)
    force, law = stored_force(out), bare_law(out)
    between = math.sqrt(law.points[-2].velocity * law.points[-1].velocity)
    found = collide_in_time(force, between)
    assert found.blended
    assert found.restitution == approx(law.at(between).restitution, abs=0.01)
    with pytest.raises(DomainError, match="outside the computed velocities"):
        collide_in_time(force, 1.01 * law.highest)
    with pytest.raises(DomainError, match="are not extrapolated"):
        collide_in_time(force, 0.5 * law.lowest)
    for velocity in (0.0, -1.0, math.nan):
        with pytest.raises(DomainError):
            collide_in_time(force, velocity)


def test_the_verb(run, cli, refused, tmp_path):
    out = run(**ROUGH, adhesion="", steps=4)
    status, said, _ = cli("simulate", out, "-o", tmp_path / "courses.csv")
    assert status == 0
    assert len(said.splitlines()) == 1 + 4 + 1
    with open(tmp_path / "courses.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    velocities = {row["impact_velocity_m_per_s"] for row in rows}
    assert len(velocities) == 4
    last = [row for row in rows if row["impact_velocity_m_per_s"] == max(velocities, key=float)]
    assert float(last[0]["closing_velocity_m_per_s"]) == approx(float(max(velocities, key=float)))
    assert float(last[-1]["closing_velocity_m_per_s"]) < 0
    assert "exists" in refused("simulate", out, "-o", tmp_path / "courses.csv")
    assert "has no unit" in refused("simulate", out, "--velocity", "1")
    assert "not extrapolated" in refused("simulate", out, "--velocity", "1e-6 m/s")
    assert "holds no results" in refused("simulate", tmp_path)


@pytest.mark.parametrize("columns", [80, 40])
def test_no_number_of_the_table_is_cut(run, cli, monkeypatch, columns):
    """At 80 columns the table fits; below, its lines are longer than the terminal is wide."""
    out = run(**ROUGH, adhesion="", steps=4)
    whole = cli("simulate", out)[1].splitlines()
    monkeypatch.setattr(console.answers, "_width", columns)
    lines = cli("simulate", out)[1].splitlines()
    assert lines == whole
    assert max(map(len, lines)) <= 80


def test_a_restitution_above_one_is_printed_with_an_error_that_reaches_one(run, cli):
    out = run(CASE.replace("750 MPa", "750 GPa"), **ROUGH, adhesion="", steps=3)
    _, said, _ = cli("simulate", out)
    rows = re.findall(r"(\d\.\d+) +± (\d\.\d+) +(\d\.\d+)", said)
    assert len(rows) == 3
    for restitution, error, energies in np.array(rows, dtype=float):
        assert energies <= 1
        assert restitution - error <= 1 + 1e-9
        assert restitution == approx(1, abs=1e-3)


def test_a_pair_that_sticks_is_held(run):
    """The impact is so slow that adhesion nearly cancels the work of the approach."""
    values = {**ADHESIVE, "first": "6 nm", "last": "7.5 nm"}
    out = run(**values, adhesion='work_of_adhesion = "0.5 J/m^2"', steps=3)
    law, force = bare_law(out), stored_force(out)
    assert law.sticks_everywhere
    assert any("sticks at every computed velocity" in warning for warning in law.warnings)
    for point in law.points:
        assert collide_in_time(force, point.velocity).restitution == 0


def test_what_was_not_followed_to_separation_cannot_collide(run):
    adhesion = 'work_of_adhesion = "0.5 J/m^2"'
    text = CASE.replace("curves = {steps}", 'curves = {steps}\nmethod = "energy-estimate"')
    out = run(text=text, **ADHESIVE, adhesion=adhesion, steps=2)
    assert any("is an estimate" in warning for warning in bare_law(out).warnings)
    with pytest.raises(OutputError, match=r'unloading\.method = "path"'):
        stored_force(out)


def test_what_cannot_collide(run, tmp_path):
    with pytest.raises(OutputError, match="holds no results of a run"):
        stored_force(tmp_path)
    bare = Pair(Body(1e-3, 1e9, 0.3), WALL)
    law = closed_form(Pair(STEEL, WALL), P_Y, np.array([1e-7, 1e-6]))
    with pytest.raises(CaseError, match="density"):
        replace(law, pair=bare)


def test_the_course_is_a_table_of_floats():
    law = closed_form(Pair(STEEL, STEEL), P_Y, np.geomspace(1e-8, 1e-6, 4))
    rows = course(collide_in_time(law, 0.1))
    assert rows[0]["indentation_m"] == 0
    assert all(type(value) is float for row in rows for value in row.values())
    times = [row["time_s"] for row in rows]
    assert times == sorted(times)
