"""Sticking velocity and pull-off force of the pair, with their errors."""

import math

import numpy as np
import pytest

from restitution.case.case_file import parse_case
from restitution.curve.work_curve import WorkCurve
from restitution.results.reader import RunResults
from restitution.results.writer import ResultsFolder
from restitution.runs.attraction import (
    Sticking,
    _Impact,
    _search,
    curve_errors,
    in_words,
    mean_of,
    stored,
    summary_of,
)
from restitution.runs.ensemble import run_realisations
from restitution.runs.run import run_case
from restitution.theory import JKR
from tolerance import approx

MASS = 2e-12
SOFT = """
total_error = false
[first]
radius = "5 um"
youngs_modulus = "3 GPa"
poissons_ratio = 0.33
density = "1050 kg/m^3"
[interface]
work_of_adhesion = "0.05 J/m^2"
adhesion = "jkr"
yield_pressure = "elastic"
[grid]
nodes = 64
spacing = "30 nm"
refine = "auto"
[indentation]
values = ["8 nm", "14 nm"]
"""


@pytest.mark.parametrize(("fixed", "power"), [(1e-14, 0.0), (1e-14, 0.3), (4e-14, 0.1)])
def test_the_velocity_whose_energy_is_lost_is_found(fixed, power):
    """L(V) = L₀ (V/1 m/s)^p and ½ m V² = L give V in closed form."""

    def impact(V):
        return _Impact(V, fixed * V**power, 0.0)

    found = _search(impact(1.0), impact, MASS)
    exact = (2 * fixed / MASS) ** (1 / (2 - power))
    assert found.velocity == approx(exact, rel=0.02)
    assert abs(found.velocity - exact) <= max(found.solver_error, 0.02 * exact)


def test_without_a_loss_no_velocity_sticks():
    found = _search(_Impact(1.0, 1e-20, 1e-18), lambda V: pytest.fail("solved"), MASS)
    assert found.velocity == 0
    assert found.solver_error == approx(math.sqrt(2e-18 / MASS))


def test_a_failed_solve_leaves_a_wider_error():
    def fails(V):
        from restitution.errors import NotConvergedError

        raise NotConvergedError("no")

    found = _search(_Impact(1.0, 1e-14, 1e-16), fails, MASS)
    assert found.velocity == approx(0.1)
    assert found.solver_error > 0.89


def test_a_soft_smooth_sphere_sticks_as_in_the_theory_of_jkr(tmp_path):
    case = parse_case(SOFT)
    out = ResultsFolder(tmp_path / "out")
    summary = run_case(case, SOFT, tmp_path, out)
    pair = case.pair()
    jkr = JKR(pair.radius, pair.contact_modulus, 0.05)
    exact = float(jkr.sticking_velocity(pair.mass))
    found = summary["sticking"]
    assert found["sticks_below_m_per_s"] == approx(exact, rel=0.05)
    assert not found["error_is_total"]
    assert [row["resolved"] for row in out.rows] == [True, True]
    for row in out.rows:
        miss = abs(row["pull_off_force_N"] - float(jkr.pull_off_force))
        assert miss < 2 * row["pull_off_error_N"]
    words = in_words(found, out.curve.points)
    assert words.startswith("Sticks below ")
    assert "pull-off force" in words
    assert RunResults(out.path).summary["sticking"] == found


@pytest.mark.parametrize("more", ["", "realisations = 2\n"])
def test_a_rough_pair_has_errors_of_grid_and_surfaces(tmp_path, more):
    rough = SOFT.replace("total_error = false\n", "").replace('refine = "auto"\n', "")
    rough += f'[roughness]\nkind = "gaussian"\nrms = "2 nm"\nseed = 1\n{more}'
    rough += 'correlation_length = "0.4 um"\n'
    out = ResultsFolder(tmp_path / "out")
    summary = run_realisations(parse_case(rough), rough, tmp_path, out)
    found = summary["sticking"]
    assert found["error_is_total"]
    assert found["sticks_below_error_m_per_s"] > 0
    for row in out.rows:
        assert row["pull_off_error_N"] > 0.02 * row["pull_off_force_N"]
        assert math.isfinite(row["pull_off_error_N"])


def test_without_densities_or_adhesion_nothing_is_said(tmp_path):
    light = SOFT.replace('density = "1050 kg/m^3"\n', "")
    out = ResultsFolder(tmp_path / "light")
    assert run_case(parse_case(light), light, tmp_path, out)["sticking"] == {}
    assert "unknown (it needs densities" in in_words({}, out.curve.points)
    dry = SOFT.replace('work_of_adhesion = "0.05 J/m^2"\nadhesion = "jkr"\n', "")
    out = ResultsFolder(tmp_path / "dry")
    assert run_case(parse_case(dry), dry, tmp_path, out)["sticking"] == {}
    assert in_words({}, out.curve.points) == ""


def test_what_is_stored_is_read_back():
    pair = Sticking(0.1, 0.01, 0.11, 0.02)
    assert stored(summary_of(pair)) == Sticking(0.1, 0.02, 0.11, 0.02)
    assert stored({}) is None


def test_the_mean_of_surfaces_has_their_interval():
    pairs = [Sticking(v, 0.001, 0.2) for v in (0.08, 0.10, 0.12)]
    found = mean_of(pairs, Sticking(0.08, 0.001, 0.2, 0.03))
    half = 4.3027 * 0.02 / math.sqrt(3)  # Student's t, two degrees of freedom, 95 %
    assert found.velocity == approx(0.1)
    assert found.error == approx(math.hypot(half, 0.03), rel=1e-4)
    assert mean_of([], None) is None


def test_errors_come_from_grid_surfaces_and_materials():
    class Fake:
        of_materials = "own"

        class case:  # noqa: N801
            roughness = (1,)

        own = reference = WorkCurve(
            np.array([1.0, 10.0]), np.array([0.5, 5.0]), np.array([2.0, 2.0])
        )

        def others(self):
            flat = np.array([1.0, 10.0])
            return [WorkCurve(flat, flat, np.full(2, force)) for force in (2.2, 1.8)]

        def scales(self):
            return None

        def spectra(self):
            return self.ends

        ends = ()

        def material_ends(self):
            return [("low", "high")]

        def curve(self, end):
            force = {"own": 2.0, "low": 1.7, "high": 2.1}[end]
            return WorkCurve(np.array([1.0]), np.array([1.0]), np.array([force]))

    work = np.array([3.0])
    parts = curve_errors(Fake(), lambda c: c.pull_off_at(work), np.array([2.5]), scattered=True)
    half = 4.3027 * 0.2 / math.sqrt(3)
    assert [float(part[0]) for part in parts] == approx([0.5, half, 0.3], rel=1e-4)
    alone = curve_errors(Fake(), lambda c: c.pull_off_at(work), np.array([2.5]), scattered=False)
    assert len(alone) == 2
    Fake.ends = [Fake().curve(end) for end in ("low", "high")]
    joined = curve_errors(Fake(), lambda c: c.pull_off_at(work), np.array([2.5]), scattered=False)
    assert [float(part[0]) for part in joined] == approx([0.5, 0.3, 0.3], rel=1e-4)
