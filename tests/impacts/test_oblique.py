"""Oblique impact: the tangential law against closed forms, energy and a measurement."""

import math
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from elastic_force import ALUMINA, elastic
from restitution import Pair
from restitution.cli import console
from restitution.errors import CaseError, DomainError
from restitution.impacts.foundation import Foundation
from restitution.impacts.oblique import collide_obliquely, course
from restitution.impacts.stored_force import stored_force
from restitution.theory import Hertz
from tolerance import approx

MU = 0.3


def test_full_slip_follows_the_impulse_exactly(wall):
    for degrees in (45, 60, 80):
        angle, friction = math.radians(degrees), 0.092
        found = collide_obliquely(wall, 3.9, angle, friction)
        assert found.sliding
        lost = friction * (1 + found.normal_restitution) / math.tan(angle)
        assert found.tangential_restitution == approx(1 - lost, rel=1e-5)


@pytest.mark.parametrize(("factor", "sliding"), [(1.01, True), (0.99, False)])
def test_the_range_of_full_slip_is_that_of_maw_barber_and_fawcett(wall, factor, sliding):
    """Maw, Barber and Fawcett (1976): from ψ₁ = 4χ − 1 on, with ψ₁ = κ tan θ/µ and χ = 7κ/4."""
    kappa = wall.pair.tangential_modulus / wall.pair.contact_modulus
    angle = math.atan(factor * 0.2 * (7 - 1 / kappa))
    assert collide_obliquely(wall, 3.9, angle, 0.2).sliding is sliding


@pytest.mark.parametrize(("factor", "sticks"), [(0.95, True), (1.05, False)])
def test_the_contact_sticks_at_first_below_the_angle_of_maw_barber_and_fawcett(
    wall, factor, sticks
):
    """All of the contact sticks at the beginning where ψ₁ < 1."""
    kappa = wall.pair.tangential_modulus / wall.pair.contact_modulus
    found = collide_obliquely(wall, 3.9, math.atan(factor * 0.2 / kappa), 0.2)
    early = found.sticking[
        (found.time > 0.02 * found.time[-1]) & (found.time < 0.1 * found.time[-1])
    ]
    assert bool(early.min() > 0.9) == sticks


def test_the_energy_lost_is_that_of_friction_and_of_the_normal_contact(wall):
    mass = wall.pair.mass
    for degrees, spin in ((5, 0.0), (20, 0.0), (20, 800.0), (35, -300.0), (60, 0.0)):
        angle = math.radians(degrees)
        found = collide_obliquely(wall, 3.9, angle, 0.15, (spin, 0.0))
        V_n, V_t = 3.9 * math.cos(angle), 3.9 * math.sin(angle)
        inertia = 0.4 * mass * ALUMINA.radius**2
        before = 0.5 * mass * (V_n**2 + V_t**2) + 0.5 * inertia * spin**2
        after = 0.5 * inertia * found.spins[0] ** 2 + 0.5 * mass * (
            (found.normal_restitution * V_n) ** 2 + (found.tangential_restitution * V_t) ** 2
        )
        assert before - after == approx(found.friction_loss + found.normal_loss, rel=1e-4)


def test_without_friction_nothing_tangential_changes(wall):
    found = collide_obliquely(wall, 2.0, math.radians(30), 0.0)
    assert found.tangential_restitution == approx(1.0, rel=1e-12)
    assert found.spins == (0.0, 0.0)
    assert found.friction_loss == 0.0
    assert found.rebound_angle == approx(math.radians(30), rel=1e-6)


def test_equal_spheres_spin_alike_and_a_rolling_sphere_keeps_its_velocity(wall):
    pair = elastic(Pair(ALUMINA, ALUMINA), 2.0)
    found = collide_obliquely(pair, 2.0, math.radians(40), 0.2)
    assert found.spins[0] == approx(found.spins[1], rel=1e-12)
    assert found.spins[0] > 0
    angle = math.radians(30)
    rolling = 2.0 * math.sin(angle) / ALUMINA.radius
    found = collide_obliquely(wall, 2.0, angle, 0.2, (rolling, 0.0))
    assert found.tangential_restitution == approx(1.0, rel=1e-9)


# Kharaz, Gorham and Salman (2001), Powder Technol. 120, 281: angle (degrees), e_t.
KHARAZ = (
    (1.84, 0.79344),
    (3.703, 0.74533),
    (9.496, 0.67257),
    (20.012, 0.59691),
    (30.127, 0.68756),
    (39.382, 0.77148),
    (49.694, 0.84761),
    (60.02, 0.90142),
)


@pytest.mark.parametrize(("degrees", "measured"), KHARAZ)
def test_the_tangential_restitution_of_alumina_on_glass_is_as_measured(wall, degrees, measured):
    found = collide_obliquely(wall, 3.9, math.radians(degrees), 0.092)
    assert found.tangential_restitution == approx(measured, rel=0.04)


@pytest.fixture(scope="module")
def yielded(computed_yielding):
    return stored_force(computed_yielding)


@pytest.fixture(scope="module")
def computed_yielding(tmp_path_factory):
    """The run of a rough pair that yields."""
    from restitution import run

    case = {
        "total_error": False,
        "first": {"material": "steel", "radius": "500 um"},
        "interface": {"yield_strength": "500 MPa"},
        "roughness": {
            "kind": "gaussian",
            "rms": "0.05 um",
            "correlation_length": "3 um",
            "seed": 2,
        },
        "grid": {"nodes": 96, "spacing": "0.4 um"},
        "indentation": {"from": "50 nm", "to": "500 nm", "steps": 6},
        "unloading": {"curves": 6},
    }
    out = tmp_path_factory.mktemp("yielding") / "out"
    run(case, out=out)
    return out


def test_the_springs_of_a_yielded_rough_contact_carry_its_forces(yielded):
    springs = Foundation.of(yielded, yielded.deepest)
    force, end, _ = yielded.branch(yielded.deepest)
    largest = yielded.loading(yielded.deepest)
    for share in (0.3, 0.6, 0.9, 1.0):
        at = end + share * (yielded.deepest - end)
        total = springs.load(at, yielded.deepest).sum()
        assert abs(total - force(at)) < 0.02 * largest
    for share in (0.3, 0.7):
        at = share * yielded.deepest
        assert springs.load(at, at).sum() == approx(yielded.loading(at), rel=0.02)


def test_a_yielded_contact_keeps_its_normal_restitution(yielded):
    angle = math.radians(25)
    found = collide_obliquely(yielded, 0.9 * yielded.highest, angle, 0.3)
    head_on = collide_obliquely(yielded, 0.9 * yielded.highest * math.cos(angle), 0.0, 0.3)
    assert found.normal_restitution == approx(head_on.normal_restitution, rel=1e-12)
    assert 0 < found.tangential_restitution < 1
    assert math.isnan(head_on.tangential_restitution)
    assert len(course(found)) == found.time.size


def test_the_law_of_a_yielded_rough_contact_agrees_with_boundary_elements(
    yielded, computed_yielding
):
    from restitution import solve
    from restitution.contact.tangential import shear
    from restitution.impacts.tangential_error import tangential_error
    from restitution.results.reader import RunResults

    state = solve(RunResults(computed_yielding).case.contact(computed_yielding), yielded.deepest)
    springs = Foundation.of(yielded, yielded.deepest)
    loads = springs.load(yielded.deepest, yielded.deepest)
    error = tangential_error(yielded, yielded.deepest, MU)
    stiffness = shear(state, 1e-14, MU).force / 1e-14
    for share in (1e-6, 0.3, 0.6, 0.9):
        place = share * MU * state.force / stiffness
        _, found, _ = springs.move(np.zeros(loads.size), place, MU * loads)
        whole = shear(state, place, MU).force
        assert found == approx(whole, rel=error.stiffness)
    assert error.stiffness < 0.15


def test_the_error_is_that_of_the_tangential_law(yielded):
    """The impulse changes by its error; from it follow the errors of e_t, spin and rebound."""
    pair = elastic(Pair(ALUMINA, ALUMINA), 2.0)
    angle = math.radians(10)
    smooth = collide_obliquely(pair, 2.0, angle, 0.2)
    assert 0 < smooth.tangential_restitution_error < 5e-3
    rough = collide_obliquely(yielded, 0.9 * yielded.highest, angle, 0.2)
    assert rough.tangential_restitution_error > 5 * smooth.tangential_restitution_error
    for found, body in ((smooth, ALUMINA), (rough, yielded.pair.first)):
        impulse = found.tangential_restitution_error * found.velocity * math.sin(angle)
        mass = pair.pair.mass if found is smooth else yielded.pair.mass
        turned = 2.5 * impulse * mass / body.mass / body.radius
        assert found.spin_errors == approx((turned, turned), rel=1e-9)
        normal = found.normal_restitution * found.velocity * math.cos(angle)
        after = found.tangential_restitution * found.velocity * math.sin(angle)
        turn = math.atan2(after + impulse, normal) - math.atan2(after, normal)
        assert found.rebound_angle_error == approx(turn, rel=0.02)
    assert math.isnan(collide_obliquely(pair, 2.0, 0.0, 0.2).tangential_restitution_error)


def test_full_slip_has_an_error_for_unlike_bodies_only(wall):
    alike = collide_obliquely(elastic(Pair(ALUMINA, ALUMINA), 2.0), 2.0, math.radians(60), 0.1)
    assert alike.sliding
    assert alike.tangential_restitution_error < 1e-9
    unlike = collide_obliquely(wall, 2.0, math.radians(60), 0.1)
    assert unlike.tangential_restitution_error == approx(
        0.15 * 0.24903 * (1 - unlike.tangential_restitution), rel=1e-3
    )


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"angle": math.pi / 2}, "below 90 degrees"),
        ({"angle": -0.1}, "below 90 degrees"),
        ({"angle": math.nan}, "below 90 degrees"),
        ({"friction": -0.1}, "give 0 or more"),
        ({"friction": math.inf}, "give 0 or more"),
        ({"spins": (math.nan, 0.0)}, "finite numbers"),
    ],
)
def test_bad_arguments_are_refused(wall, changed, words):
    given = {"velocity": 1.0, "angle": 0.1, "friction": 0.1} | changed
    with pytest.raises(CaseError, match=words):
        collide_obliquely(wall, **given)


def test_nothing_is_extrapolated(wall):
    with pytest.raises(DomainError, match="outside the computed velocities"):
        collide_obliquely(wall, 10.0, 0.1, 0.1)


def test_a_pair_with_adhesion_is_refused(refused, tmp_path):
    from restitution import run

    case = {
        "total_error": False,
        "first": {"material": "glass", "radius": "50 um"},
        "interface": {"yield_pressure": "elastic", "work_of_adhesion": "0.05 J/m^2"},
        "grid": {"nodes": 64, "spacing": "0.1 um"},
        "indentation": {"values": ["20 nm", "40 nm"]},
        "unloading": {"curves": 2},
    }
    with warnings.catch_warnings(action="ignore"):
        run(case, out=tmp_path / "out")
    given = ["simulate", tmp_path / "out", "--velocity", "0.05 m/s", "--friction", "0.2"]
    assert "only for pairs without adhesion" in refused(*given, "--angle", "30 deg")


def test_the_command_line(cli, refused, computed_yielding, tmp_path):
    given = ["simulate", computed_yielding, "--velocity", "0.2 m/s"]
    table = tmp_path / "course.csv"
    _, said, _ = cli(
        *given, "--angle", "30 deg", "--angle", "60 deg", "--friction", "0.2", "-o", table
    )
    assert re.search(r" (full|part) *\n", said)
    assert "±: error due to the tangential law" in said
    assert table.read_text().startswith("impact_velocity_m_per_s,angle_rad,time_s")
    assert "--friction: not given" in refused(*given, "--angle", "30 deg")
    assert "--angle" in refused(*given, "--friction", "0.2")
    assert "is not an angle" in refused(*given, "--friction", "0.2", "--angle", "30 m")
    assert "less than 90 degrees" in refused(*given, "--friction", "0.2", "--angle", "95 deg")


def test_the_table_fits_into_80_columns(cli, computed_yielding, monkeypatch):
    monkeypatch.setattr(console.answers, "_width", 80)
    given = ["--velocity", "0.2 m/s", "--angle", "30 deg", "--friction", "0.2"]
    _, said, _ = cli("simulate", computed_yielding, *given, "--spin", "-12345.6 rad/s")
    head, units, row, _ = said.splitlines()
    assert "…" not in said
    assert max(map(len, (head, units, row))) <= 80


def test_the_course_of_a_sliding_impact_is_that_of_coulomb(wall):
    """T = µF, and the contact point loses 7/2 of the velocity that the centre loses."""
    angle, friction = math.radians(60), 0.092
    found = collide_obliquely(wall, 3.9, angle, friction)
    assert found.sticking.max() == 0.0
    assert found.tangential_force[1:-1] == approx(friction * found.normal_force[1:-1], rel=1e-6)
    V_t = 3.9 * math.sin(angle)
    assert found.slip_velocity[0] == approx(V_t)
    end = V_t * (1 - 3.5 * (1 - found.tangential_restitution))
    assert found.slip_velocity[-1] == approx(end, rel=1e-4)
    assert (found.time[0], found.time.size) == (0.0, 4001)
    largest = wall.loading(
        float(
            Hertz(wall.pair.radius, wall.pair.contact_modulus).indentation_from_energy(
                0.5 * wall.pair.mass * (3.9 * math.cos(angle)) ** 2
            )
        )
    )
    assert found.normal_force.max() == approx(largest, rel=1e-5)
    assert found.normal_loss == approx(
        0.5 * wall.pair.mass * (3.9 * math.cos(angle)) ** 2 * (1 - found.normal_restitution**2)
    )


def test_an_impact_whose_contact_point_moves_backwards_has_the_same_errors(wall):
    """The spin 2 V_t/R reverses the velocity of the contact point, and so the impulse."""
    angle = math.radians(20)
    spin = 2 * 3.9 * math.sin(angle) / ALUMINA.radius
    there = collide_obliquely(wall, 3.9, angle, 0.15)
    back = collide_obliquely(wall, 3.9, angle, 0.15, (spin, 0.0))
    assert back.tangential_restitution - 1 == approx(1 - there.tangential_restitution, rel=1e-9)
    assert back.tangential_restitution_error == approx(there.tangential_restitution_error, rel=1e-9)
    assert back.spin_errors == approx(there.spin_errors, rel=1e-9)
    assert back.spins[0] == approx(spin - there.spins[0], rel=1e-9)
    assert back.rebound_angle_error > 0


def test_after_yield_the_error_has_a_part_that_vanishes_in_full_slip(yielded, monkeypatch):
    from restitution.impacts import oblique
    from restitution.impacts.tangential_error import TangentialError

    def errors(degrees, friction, **parts):
        stated = TangentialError(**{"stiffness": 0.0, "impulse": 0.0, "sliding": 0.0} | parts)
        monkeypatch.setattr(oblique, "tangential_error", lambda *_: stated)
        return collide_obliquely(yielded, 0.9 * yielded.highest, math.radians(degrees), friction)

    for degrees, friction in ((10, 0.3), (30, 0.1)):
        found = errors(degrees, friction, impulse=0.2)
        change = 1 - found.tangential_restitution  # the impulse over m V_t
        slip = friction * (1 + found.normal_restitution) / math.tan(math.radians(degrees))
        expected = 0.2 * change * (1 - change / slip)
        assert found.tangential_restitution_error == approx(expected, rel=1e-6)
        assert errors(degrees, friction, sliding=0.2).tangential_restitution_error == approx(
            0.2 * change, rel=1e-9
        )
        assert errors(degrees, friction).tangential_restitution_error == 0.0
    full = errors(75, 0.05, impulse=0.2)
    assert full.sliding
    assert full.tangential_restitution_error < 1e-4 * (1 - full.tangential_restitution)


def test_the_error_of_the_impulse_is_the_largest_change_by_the_error_of_the_stiffness(
    wall, monkeypatch
):
    from restitution.impacts import oblique
    from restitution.impacts.tangential_error import TangentialError

    angle, make = math.radians(12), Foundation.of.__func__

    def rebound(factor, error):
        def changed(cls, law, deepest):
            springs = make(cls, law, deepest)
            E, G = springs.moduli
            return replace(springs, moduli=(E, factor * G))

        monkeypatch.setattr(Foundation, "of", classmethod(changed))
        monkeypatch.setattr(
            oblique, "tangential_error", lambda *_: TangentialError(error, 0.0, 0.0)
        )
        return collide_obliquely(wall, 2.0, angle, 0.2)

    for error in (0.1, 0.4):
        found = rebound(1.0, error)
        changes = [
            abs(rebound(factor, 0.0).tangential_restitution - found.tangential_restitution)
            for factor in (1 + error, 1 / (1 + error))
        ]
        assert found.tangential_restitution_error == approx(max(changes), rel=1e-6)
        assert found.tangential_restitution_error > 1e-3
