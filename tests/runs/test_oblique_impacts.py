"""The oblique impacts of a run: table, dataset, checks on reading, ensembles, convergence."""

import math
import re

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.errors import OutputError
from restitution.impacts.oblique import collide_obliquely, full_slip_angle, full_slip_restitution
from restitution.impacts.stored_force import stored_force
from restitution.results.reader import read_run
from restitution.results.schema import OBLIQUE_COLUMNS
from restitution.results.writer import ResultsFolder
from restitution.runs.convergence import run_convergence
from restitution.runs.ensemble import run_realisations
from restitution.runs.oblique import mean_oblique
from tolerance import approx

CASE = """
total_error = false
first = { material = "steel", radius = "500 um" }
second = "steel"
[interface]
friction = 0.2
[roughness]
kind = "gaussian"
rms = "0.02 um"
correlation_length = "3 um"
seed = 1
[grid]
nodes = 64
spacing = "0.6 um"
[impact]
velocity = ["0.05 m/s", "0.1 m/s"]
angle = ["10 deg", "60 deg"]
spin = "-50 rad/s"
[unloading]
curves = 1
"""


def computed(text, out):
    run_realisations(parse_case(text), text, out.parent, ResultsFolder(out))
    return read_run(out)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return computed(CASE, tmp_path_factory.mktemp("oblique") / "out")


def test_there_is_a_row_for_each_velocity_and_angle(run):
    rows = run.oblique
    assert list(rows[0].cells()) == list(OBLIQUE_COLUMNS)
    assert [row.velocity for row in rows] == [0.05, 0.05, 0.1, 0.1]
    assert [math.degrees(row.angle) for row in rows] == approx([10, 60, 10, 60])
    assert {row.first_spin_before for row in rows} == {-50.0}
    # all depths are unloaded, and 0.05 m/s is computed once
    assert [len(run.curve.points), len(run.unloading)] == [5, 5]
    run.check()


def test_the_rows_are_those_of_the_stored_force(run):
    force, last = stored_force(run.folder), run.oblique[-1]
    found = collide_obliquely(force, 0.1, math.radians(60), 0.2, (-50.0, 0.0))
    assert last.tangential_restitution == approx(found.tangential_restitution, rel=1e-5)
    assert last.rebound_angle == approx(found.rebound_angle, rel=1e-5)
    assert last.first_spin == approx(found.spins[0], rel=1e-4)
    assert last.friction_loss == approx(found.friction_loss, rel=1e-4)
    assert last.slides == found.sliding


def test_the_normal_restitution_is_that_of_the_curve(run):
    curve = {row.impact_velocity: row.restitution for row in run.curve.points}
    for row in run.oblique:
        normal = row.velocity * math.cos(row.angle)
        nearest = min(curve, key=lambda V: abs(V - normal))
        assert nearest == approx(normal, rel=1e-4)
        assert row.normal_restitution == approx(curve[nearest], rel=2e-3)


def test_the_losses_are_the_kinetic_energy_lost(run):
    pair = run.case.pair()
    R, m = pair.first.radius, pair.mass
    for row in run.oblique:
        V, angle = row.velocity, row.angle
        before = 0.5 * m * V**2 + 0.2 * m * R**2 * row.first_spin_before**2
        after = 0.2 * m * R**2 * row.first_spin**2 + 0.5 * m * V**2 * (
            (row.tangential_restitution * math.sin(angle)) ** 2
            + (row.normal_restitution * math.cos(angle)) ** 2
        )
        lost = row.friction_loss + row.normal_loss
        assert abs(before - after - lost) < 1e-4 * before


def test_the_dataset_has_the_rows_by_velocity_and_angle(run):
    stored = run.dataset["oblique_tangential_restitution"]
    assert stored.dims == ("oblique_velocity", "oblique_angle")
    assert stored.values.ravel() == approx([row.tangential_restitution for row in run.oblique])
    assert run.dataset["oblique_angle"].attrs["units"] == "rad"
    assert run.dataset["oblique_first_spin"].attrs["units"] == "rad s-1"
    picked = run.dataset["oblique_slides"].sel(oblique_velocity=0.1, oblique_angle=math.radians(60))
    assert bool(picked) == bool(run.oblique[-1].slides)


def test_full_slip_follows_its_closed_form(run):
    pair = run.case.pair()
    ratio = pair.tangential_modulus / pair.contact_modulus
    for row in run.oblique:
        if row.slides:
            angle, e = row.angle, row.normal_restitution
            expected = full_slip_restitution(0.2, e, angle)
            assert row.tangential_restitution == approx(expected, rel=1e-5)
            assert angle > full_slip_angle(0.2, e, ratio)
    assert run.oblique[1].slides


def test_the_error_contains_that_of_the_normal_restitution(tmp_path):
    """In full slip, e_t = 1 − µ (1 + e_n)/tan θ, and like bodies have no other error."""
    text = CASE.replace("total_error = false\n", "").replace('"10 deg", "60 deg"', '"60 deg"')
    run = computed(text.replace('"0.05 m/s", ', ""), tmp_path / "out")
    assert run.oblique[0].slides
    for row in run.oblique:
        normal, angle = row.normal_restitution_error, row.angle
        V_n = row.velocity * math.cos(angle)
        assert normal > 0
        expected = 0.2 * normal / math.tan(angle)
        assert row.tangential_restitution_error == approx(expected, rel=1e-6)
        body = run.case.pair().first
        impulse = 0.2 * normal * run.case.pair().mass * V_n
        turned = 2.5 * impulse / (body.mass * body.radius)
        assert row.first_spin_error == approx(turned, rel=1e-6)
        # The angle of rebound atan(e_t tan θ/e_n), with both restitutions at their worst.
        worst = math.atan2(
            (row.tangential_restitution + expected) * math.tan(angle),
            row.normal_restitution - normal,
        )
        shift = worst - row.rebound_angle
        assert row.rebound_angle_error == approx(shift, rel=0.1)
        rebound = math.tan(row.rebound_angle)
        parts = expected * math.tan(angle), rebound * normal
        assert min(parts) > 0
        linear = sum(parts) / row.normal_restitution / (1 + rebound**2)
        assert row.rebound_angle_error == approx(linear, rel=1e-4)


def test_a_run_without_angles_has_no_oblique_impacts(run, tmp_path):
    text = re.sub("(angle|spin) = .*\n", "", CASE).replace('["0.05 m/s", "0.1 m/s"]', '"0.1 m/s"')
    plain = computed(text, tmp_path / "out")
    assert plain.oblique == ()
    assert not (tmp_path / "out" / "oblique.csv").exists()
    assert not [name for name in plain.dataset if str(name).startswith("oblique")]
    head_on = next(row for row in run.curve.points if row.impact_velocity > 0.0999)
    assert plain.curve.points[0].restitution == approx(head_on.restitution, rel=1e-5)


def test_a_damaged_table_is_refused(run, tmp_path):
    text = (run.folder / "oblique.csv").read_text()
    for wrong, words in (
        (text.replace("false", "perhaps").replace("true", "perhaps"), "not true or false"),
        (text.replace("friction_loss_J", "loss"), "column friction_loss_J is missing"),
        (text.replace("0.05,0.17", "x,0.17"), "line 2: impact_velocity_m_per_s is 'x'"),
        (text.replace("0.05,0.17", "-1,0.17"), "line 2: impact_velocity_m_per_s is -1"),
    ):
        (tmp_path / "oblique.csv").write_text(wrong)
        with pytest.raises(OutputError, match=words):
            _ = read_run_of(tmp_path).oblique
    (run.folder / "copy").mkdir()
    for name in ("oblique.csv", "SHA256SUMS"):
        (run.folder / "copy" / name).write_text((run.folder / name).read_text() + " ")
    with pytest.raises(OutputError):
        _ = read_run_of(run.folder / "copy").oblique


def read_run_of(folder):
    from restitution.results.reader import RunResults

    return RunResults(folder)


def test_an_ensemble_has_the_means_of_its_surfaces(tmp_path):
    text = CASE.replace("seed = 1", "seed = 1\nrealisations = 2").replace('"0.05 m/s", ', "")
    found = computed(text, tmp_path / "out")
    parts = [read_run(tmp_path / "out" / f"realisation-{k}").oblique for k in (1, 2)]
    for row, *of in zip(found.oblique, *parts, strict=True):
        values = [each.tangential_restitution for each in of]
        assert row.tangential_restitution == approx(float(np.mean(values)))
        assert row.tangential_restitution_std == approx(float(np.std(values, ddof=1)))
        assert row.realisations == 2
    assert "oblique_tangential_restitution_std" in found.dataset


def test_the_mean_of_one_surface_has_no_deviation(run):
    (first, *_), rows = mean_oblique([run.oblique]), run.oblique
    assert math.isnan(first.tangential_restitution_std)
    assert first.friction_loss == rows[0].friction_loss


def test_a_convergence_study_has_those_of_the_finest_grid(tmp_path):
    text = CASE.replace("nodes = 64", "nodes = 32").replace('"0.6 um"', '"1.2 um"')
    text = text.replace('"0.05 m/s", ', "")
    out = tmp_path / "out"
    run_convergence(parse_case(text), text, tmp_path, ResultsFolder(out), grids=2)
    found = read_run(out)
    assert found.oblique == read_run(out / "refine-2").oblique
    assert "oblique_friction_loss" in found.dataset
    found.check()
