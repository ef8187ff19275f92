"""Stiffness of periodic contacts: closed forms and differences of states."""

import math

import numpy as np
import pytest

import restitution as rs
from contact_keys import contact_of
from restitution.contact.prescribed.stiffness import normal_stiffness
from restitution.errors import CaseError
from restitution.theory import LennardJones
from tolerance import approx

WALL = rs.Body(math.inf, 210e9, 0.25)
FLAT = rs.Pair(WALL, WALL)
E = FLAT.contact_modulus
WAVELENGTH, AMPLITUDE = 10e-6, 20e-9
COMPLETE = math.pi * E * AMPLITUDE / WAVELENGTH


def wave(nodes, **model):
    grid = rs.Grid((nodes, 4), WAVELENGTH / nodes)
    z = AMPLITUDE * np.cos(2 * np.pi * grid.x / WAVELENGTH)
    return contact_of(FLAT, rs.Surface(np.tile(z[:, None], 4), grid), **model, periodic=True)


def rough(rms=50e-9, spacing=0.25e-6, **model):
    grid = rs.Grid(64, spacing)
    waves = {"hurst": 0.8, "rolloff": 32 * spacing, "shortest": 8 * spacing}
    surface = rs.generate_surface(grid, kind="self-affine", rms=rms, seed=1, **waves)
    return contact_of(FLAT, surface, **model, periodic=True)


def slope(contact, indentation, step):
    low, high = (rs.solve(contact, indentation + sign * step, residual=1e-10) for sign in (-1, 1))
    return (high.nominal_pressure - low.nominal_pressure) / (high.indentation - low.indentation)


@pytest.mark.parametrize("share", [0.05, 0.3, 0.7])
def test_one_wave(share):
    """Westergaard (1939): the mean gap is Δ (1 − P + P ln P), so dp/dδ = p*/(Δ ln(1/P))."""
    state = rs.solve_at_pressure(wave(512), share * COMPLETE)
    assert normal_stiffness(state) == approx(COMPLETE / (AMPLITUDE * -math.log(share)), rel=0.01)


def test_complete_contact_is_rigid_and_separated_bodies_carry_nothing():
    assert normal_stiffness(rs.solve_at_pressure(wave(64), 1.2 * COMPLETE)) == math.inf
    *_, separated = rs.unloading_path(rs.solve(wave(64), 5e-9))
    assert normal_stiffness(separated) == 0


@pytest.mark.parametrize("pressure", [1e7, 1e8, 1e9, 3e9])
def test_the_stiffness_is_the_slope_of_the_curve(pressure):
    state = rs.solve_at_pressure(rough(), pressure, residual=1e-9)
    found = slope(state.contact, state.indentation, 1e-5 * state.indentation)
    assert normal_stiffness(state) == approx(found, rel=2e-3)


def test_a_contact_that_yielded_has_the_stiffness_of_unloading():
    contact = rough(yield_pressure=4e9)
    state = rs.solve(contact, 100e-9)
    assert state.plastic_work > 0
    back = rs.step(state, state.indentation * (1 - 1e-4), residual=1e-10)
    drop = state.nominal_pressure - back.nominal_pressure
    unloading = drop / (state.indentation - back.indentation)
    assert normal_stiffness(state) == approx(unloading, rel=5e-3)
    assert slope(contact, state.indentation, 1e-11) < 0.97 * normal_stiffness(state)


@pytest.mark.parametrize("indentation", [0.1e-9, 0.5e-9, 1.5e-9])
def test_a_contact_with_attraction(indentation):
    contact = rough(1e-9, 50e-9, work_of_adhesion=0.05, adhesion="cohesive")
    state = rs.solve(contact, indentation, residual=1e-10)
    assert normal_stiffness(state) == approx(slope(contact, indentation, 1e-13), rel=1e-3)


def test_flat_bodies_with_attraction_have_the_stiffness_of_the_law():
    contact = rough(1e-14, 20e-9, work_of_adhesion=0.05, adhesion="cohesive")
    state = rs.solve(contact, 1e-14)
    law = LennardJones(0.05, contact.adhesion.equilibrium_separation)
    z0 = contact.adhesion.equilibrium_separation
    k = (float(law.traction(z0 * (1 + 1e-6))) - float(law.traction(z0 * (1 - 1e-6)))) / (2e-6 * z0)
    assert normal_stiffness(state) == approx(k, rel=1e-3)


def test_only_a_periodic_contact_has_this_stiffness():
    ball = rs.Body(1e-4, 210e9, 0.25)
    grid = rs.Grid(16, 1e-6)
    state = rs.solve(rs.Contact(rs.Pair(ball, ball), rs.smooth(grid)), 1e-9)
    with pytest.raises(CaseError, match="only a periodic contact"):
        normal_stiffness(state)
