"""Oblique impact against annuli of traction (evidence/maw/maw.py), closed forms and reversal."""

import csv
import math
from pathlib import Path

import pytest

from elastic_force import elastic
from evidence.maw import maw
from restitution import Body, Pair
from restitution.errors import CaseError
from restitution.impacts.oblique import collide_obliquely, full_slip_angle, full_slip_restitution
from tolerance import approx

STUDIES = Path(__file__).parents[2] / "evidence" / "maw"
MU = 0.1
BALL = Body(1e-3, 70e9, 0.3, 2500)


@pytest.fixture(scope="module")
def equal():
    return elastic(Pair(BALL, BALL), 3.0)


def rows():
    with open(STUDIES / "maw.csv", newline="") as file:
        return [{name: float(cell) for name, cell in row.items()} for row in csv.DictReader(file)]


def at(force, psi, friction=MU, **changed):
    """The collision at the dimensionless angle psi_1, and psi_2 of the contact point."""
    kappa = force.pair.tangential_modulus / force.pair.contact_modulus
    angle = math.atan(friction * psi / kappa)
    found = collide_obliquely(force, 1.0, angle, friction, **changed)
    U, V_n = math.sin(angle), math.cos(angle)
    after = U - 3.5 * U * (1 - found.tangential_restitution)
    return found, kappa * after / (friction * V_n)


@pytest.mark.parametrize("row", rows(), ids=lambda row: f"psi {row['psi_1']:g}")
def test_the_rebound_is_that_of_maw_barber_and_fawcett(equal, row):
    """psi_2 within 0.005, or 2 %, and the rebound angle of the centres within 0.5 %."""
    found, psi_2 = at(equal, row["psi_1"])
    assert abs(psi_2 - row["psi_2"]) < max(row["error"], 5e-4) + 2e-4
    kappa = equal.pair.tangential_modulus / equal.pair.contact_modulus
    centre = MU / kappa * (row["psi_1"] - 2 / 7 * (row["psi_1"] - row["psi_2"]))
    assert math.tan(found.rebound_angle) == approx(centre, rel=5e-3)


def test_the_annuli_converge_and_their_coarse_grid_is_computed_again():
    stored = {row["psi_1"]: row for row in rows()}
    for row in stored.values():
        coarse, middle, fine = (row[f"psi_2_{n}_rings"] for n in (30, 60, 120))
        assert abs(fine - middle) <= 0.62 * abs(middle - coarse) + 2e-6
        assert row["error"] < 0.0025
    assert approx(maw.KAPPA) == 2 * 0.7 / 1.7
    for psi in (1.0, 4.0, 6.0):
        assert maw.impact(psi, 30) == approx(stored[psi]["psi_2_30_rings"], rel=1e-4)


def test_the_closed_forms_of_full_slip(equal):
    kappa = equal.pair.tangential_modulus / equal.pair.contact_modulus
    angle = full_slip_angle(MU, 1.0, kappa)
    assert math.tan(angle) == approx(MU / kappa * (7 * kappa - 1))
    for factor, sliding in ((1.01, True), (0.98, False)):
        found, _ = at(equal, factor * (7 * kappa - 1))
        assert found.sliding is sliding
    found, _ = at(equal, 6.0)
    e = found.normal_restitution
    assert found.tangential_restitution == approx(
        full_slip_restitution(MU, e, found.angle), rel=1e-5
    )
    assert full_slip_angle(0.0, 1.0, kappa) == 0.0
    # without rebound the beginning decides, or the end of a contact that loses its speed
    assert math.tan(full_slip_angle(MU, 0.0, kappa)) == approx(3.5 * MU)


def test_the_rebound_does_not_depend_on_the_friction_but_through_psi(equal):
    for psi in (0.8, 3.0):
        assert at(equal, psi, 0.05)[1] == approx(at(equal, psi, 0.4)[1], rel=1e-3)


def test_without_friction_the_reversed_impact_is_the_impact(equal):
    """The rebound, with all velocities and spins reversed, is an impact with the first rebound."""
    angle, spins = math.radians(35), (120.0, -40.0)
    there = collide_obliquely(equal, 2.0, angle, 0.0, spins)
    assert there.spins == approx(spins, rel=1e-12)
    speed = 2.0 * math.hypot(
        there.normal_restitution * math.cos(angle), there.tangential_restitution * math.sin(angle)
    )
    back = collide_obliquely(
        equal, speed, there.rebound_angle, 0.0, (-there.spins[0], -there.spins[1])
    )
    assert back.rebound_angle == approx(angle, rel=1e-6)
    assert speed * back.tangential_restitution * math.sin(there.rebound_angle) == approx(
        2.0 * math.sin(angle), rel=1e-6
    )
    assert back.friction_loss == 0.0


def test_a_wall_does_not_turn_and_its_spin_is_refused():
    force = elastic(Pair(BALL, Body(math.inf, 70e9, 0.3)), 2.0)
    assert collide_obliquely(force, 1.0, 0.5, MU, (50.0, 0.0)).spins[1] == 0.0
    with pytest.raises(CaseError, match="a wall does not rotate"):
        collide_obliquely(force, 1.0, 0.5, MU, (0.0, 50.0))


def test_the_collision_says_what_matters(equal):
    lines = repr(at(equal, 6.0)[0]).splitlines()
    assert lines[0].startswith("ObliqueCollision: 1 m/s at 36.")
    assert "e_t 0.7" in lines[1]
    assert lines[2].endswith("slides")
