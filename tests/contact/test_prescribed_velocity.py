from dataclasses import replace

import numpy as np
import pytest

from contact_keys import models_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.loading import solve
from restitution.contact.path import loading_path
from restitution.contact.prescribed import velocity as prescribed_velocity
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.errors import CaseError, DomainError
from restitution.numerics.grid import Grid
from restitution.theory import ThorntonNing
from tolerance import approx

UM, NM = 1e-6, 1e-9


def _velocity(state):
    return np.sqrt(2 * state.loading_work / state.contact.pair.mass)


@pytest.mark.parametrize("rms", [0.0, 10 * NM])
@pytest.mark.parametrize(
    ("model", "tolerance"),
    [
        ({}, 1e-6),
        ({"yield_pressure": 750e6}, 1e-6),
        ({"yield_pressure": 750e6, "plasticity": "truncated"}, 2e-4),
        ({"work_of_adhesion": 0.02, "yield_pressure": 750e6}, 2e-3),
        ({"work_of_adhesion": 0.02, "approach": "hertzian"}, 1e-6),
    ],
)
def test_the_velocity_is_met_and_the_depth_found(rough_contact, rms, model, tolerance):
    contact = replace(rough_contact(rms=rms), **models_of(**model))
    known = solve(contact, 40 * NM)
    found = solve_at_velocity(contact, _velocity(known))
    assert _velocity(found) == approx(_velocity(known), rel=1e-6 if tolerance == 1e-6 else 1e-4)
    # The depth is as accurate as the work, which is integrated within its tolerance.
    assert found.indentation == approx(known.indentation, rel=2 * tolerance)
    assert found.convolutions > known.convolutions


def test_smooth_spheres_sink_as_hertz_says_on_a_wall_and_on_each_other():
    steel = Body(250 * UM, 210e9, 0.25, 7850.0)
    wall = Body(np.inf, 70e9, 0.3)
    small = Body(100 * UM, 70e9, 0.3, 2500.0)
    grid = Grid((64, 64), (0.16 * UM, 0.16 * UM))
    for second in (steel, wall, small):
        pair = Pair(steel, second)
        depth = (4 * UM) ** 2 / pair.radius
        elastic = ThorntonNing(pair.radius, pair.contact_modulus, 1e12)
        velocity = elastic.impact_velocity(depth, pair.mass)
        state = solve_at_velocity(Contact(pair, smooth(grid)), float(velocity))
        assert state.indentation == approx(depth, rel=2e-3)


def test_a_path_of_velocities_is_that_of_its_depths(rough_contact):
    contact = rough_contact(rms=10 * NM, yield_pressure=750e6)
    states = list(loading_path(contact, velocities=[0.002, 0.005, 0.01]))
    again = list(loading_path(contact, [state.indentation for state in states]))
    assert [_velocity(s) for s in states] == approx([0.002, 0.005, 0.01], rel=1e-6)
    assert [s.force for s in again] == approx([s.force for s in states], rel=1e-6)


@pytest.mark.parametrize("velocity", [0.0, -1.0, np.inf, np.nan])
def test_a_velocity_must_be_positive(rough_contact, velocity):
    with pytest.raises(CaseError, match=r"^velocity: .* is not positive"):
        solve_at_velocity(rough_contact(), velocity)


def test_masses_are_needed():
    body = Body(500 * UM, 210e9, 0.25)
    contact = Contact(Pair(body, body), smooth(Grid((16, 16), (UM, UM))))
    with pytest.raises(CaseError, match="density"):
        solve_at_velocity(contact, 0.1)


def test_an_impact_too_fast_for_the_grid_is_refused(rough_contact):
    with pytest.raises(DomainError):
        solve_at_velocity(rough_contact(), 50.0)


def test_one_of_three_ways_to_say_how_deep(rough_contact):
    with pytest.raises(CaseError, match="one of indentations, forces and velocities"):
        next(loading_path(rough_contact(), [1e-8], velocities=[0.1]))


def test_a_work_that_is_negative_at_small_depths_is_no_way_back():
    """Adhesion attracts the bodies, so the loading work is negative at first touch."""
    body = Body(20e-6, 5e9, 0.3, 1500.0)
    grid = Grid((48, 48), (0.12e-6, 0.12e-6))
    contact = Contact(Pair(body, body), smooth(grid), adhesion=JKRLimit(0.3))
    shallow = solve(contact, 1e-9)
    assert shallow.loading_work < 0
    state = solve_at_velocity(contact, 0.05)
    assert state.indentation > shallow.indentation
    assert _velocity(state) == approx(0.05, rel=5e-3)


def test_the_bracket_grows_from_a_depth_that_is_too_shallow(rough_contact, monkeypatch):
    contact = rough_contact()
    velocity = _velocity(solve(contact, 20 * NM))
    found = solve_at_velocity(contact, velocity)
    monkeypatch.setattr(prescribed_velocity._Search, "newton", lambda *_: None)
    monkeypatch.setattr(
        prescribed_velocity._Search, "first_depth", lambda *_: 0.2 * found.indentation
    )
    again = solve_at_velocity(contact, velocity)
    assert again.indentation == approx(found.indentation, rel=1e-4)


@pytest.mark.parametrize(
    ("model", "tolerance"),
    [
        ({"yield_pressure": 750e6}, 1e-6),
        ({"yield_strength": 300e6}, 1e-3),
        ({"work_of_adhesion": 0.02, "yield_pressure": 750e6}, 2e-3),
    ],
)
def test_an_expected_depth_saves_solves_and_changes_nothing_else(rough_contact, model, tolerance):
    contact = replace(rough_contact(rms=10 * NM), **models_of(**model))
    unaided = solve_at_velocity(contact, 0.01)
    for share in (0.9, 1.1):
        state = solve_at_velocity(contact, 0.01, near=share * unaided.indentation)
        assert _velocity(state) == approx(0.01, rel=1e-6 if tolerance == 1e-6 else 1e-4)
        assert state.indentation == approx(unaided.indentation, rel=tolerance)
    near = solve_at_velocity(contact, 0.01, near=0.99 * unaided.indentation)
    assert near.convolutions < 0.9 * unaided.convolutions


def test_an_expected_depth_must_be_positive(rough_contact):
    with pytest.raises(CaseError, match=r"^near: .* is not a positive depth"):
        solve_at_velocity(rough_contact(), 0.1, near=0.0)
