"""Loading with a truncated pressure (`truncated`), whose work is an integral."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from contact_keys import load
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.loading import solve, step
from restitution.contact.plasticity.bound import Elastic
from restitution.contact.plasticity.truncated import Truncated
from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from restitution.surfaces import generate_surface
from tolerance import approx

UM, NM = 1e-6, 1e-9
P_Y = 750e6
DEPTH = 40 * NM


def test_truncated_is_the_elastic_pressure_cut(rough_contact, dense):
    contact = rough_contact(
        (16, 13), (0.8 * UM, 0.9 * UM), yield_pressure=P_Y, plasticity="truncated"
    )
    state = solve(contact, 30 * NM, residual=1e-11)
    elastic = dense.pressure(contact, 30 * NM, math.inf)
    cut = np.minimum(elastic, P_Y)
    assert (elastic > P_Y).any()
    assert ((elastic > 0) & (elastic < P_Y)).any()
    assert_allclose(state.pressure, cut, atol=1e-7 * P_Y)
    lowered = np.maximum(-dense.gap(contact, cut, 30 * NM), 0)
    assert_allclose(state.plastic_displacement, lowered, atol=1e-8 * 30 * NM)
    u = dense.gap(contact, cut, 30 * NM) - contact.gap + 30 * NM
    area = contact.grid.cell_area
    assert state.stored_energy == approx(0.5 * (cut * u).sum() * area, rel=1e-7)


def test_truncated_work_is_the_work_of_its_force(rough_contact):
    """The work agrees with a fine Riemann sum, also if integrated from an intermediate state."""
    contact = rough_contact(yield_pressure=P_Y, plasticity="truncated")
    uncut = replace(contact, plasticity=Elastic())
    state = solve(contact, DEPTH)
    depths = DEPTH * ((np.arange(400) + 0.5) / 400) ** 2
    edges = DEPTH * (np.arange(401) / 400) ** 2
    elastic, work = None, 0.0
    for depth, width in zip(depths, np.diff(edges), strict=True):
        elastic = solve(uncut, depth, start=elastic, residual=1e-6)
        work += np.minimum(elastic.pressure, P_Y).sum() * contact.grid.cell_area * width
    assert state.loading_work == approx(work, rel=1e-4)
    # Nodes yield one after the other: errors reached 1e-3 in validation contacts (see next test).
    assert abs(state.loading_work - work) < state.work_error < 1e-3 * state.loading_work
    halfway = solve(contact, DEPTH, start=solve(contact, 0.5 * DEPTH))
    assert halfway.loading_work == approx(state.loading_work, rel=3e-5)
    assert halfway.force == approx(state.force, rel=1e-6)
    deeper = solve(contact, DEPTH, start=solve(contact, 1.2 * DEPTH))  # only a guess
    assert deeper.loading_work == approx(state.loading_work, rel=3e-5)


@pytest.mark.parametrize(
    ("seed", "hardness", "depth"),
    [(25, 0.010, 0.55), (46, 0.0006, 0.9), (77, 0.001, 0.6), (80, 0.001, 0.35), (94, 0.02, 0.8)],
)
def test_the_error_of_a_cut_work_holds_where_two_rules_agree_by_chance(pair, seed, hardness, depth):
    grid = Grid((48, 48), (0.25 * UM, 0.25 * UM))
    rough = generate_surface(
        grid, kind="gaussian", rms=10 * NM, correlation_length=1 * UM, seed=seed
    )
    p_y = hardness * pair.contact_modulus
    contact = Contact(pair, rough, plasticity=Truncated(p_y))
    deepest = depth * (4 * UM) ** 2 / pair.radius
    state = solve(contact, deepest)
    depths = deepest * np.linspace(0, 1, 301)
    force = [0.0]
    for depth in map(float, depths[1:]):
        force.append(load(contact, depth, start=None, residual=1e-8).force)
    assert abs(state.loading_work - np.trapezoid(force, depths)) < state.work_error


def test_truncated_unloading_starts_at_the_cut_pressure(rough_contact):
    state = solve(rough_contact(yield_pressure=P_Y, plasticity="truncated"), DEPTH)
    same = step(state, DEPTH)
    assert same.force == approx(state.force, rel=1e-6)
    assert_allclose(same.pressure, state.pressure, atol=1e-5 * P_Y)
    just = step(state, (1 - 1e-6) * DEPTH)
    assert just.force == approx(state.force, rel=1e-4)
    assert just.force < state.force


def test_truncated_goes_no_deeper_by_steps(rough_contact):
    state = solve(rough_contact(yield_pressure=P_Y, plasticity="truncated"), DEPTH)
    for beginning in (state, step(state, 0.9 * DEPTH)):
        with pytest.raises(CaseError, match="can only be unloaded; for a larger indentation"):
            step(beginning, 1.01 * DEPTH)


def test_truncated_below_yield_is_elastic(pair):
    contact = Contact(
        pair,
        smooth(Grid((41, 41), (0.25 * UM, 0.25 * UM))),
        plasticity=Truncated(1e12),
    )
    state = solve(contact, 20 * NM)
    assert state.pressure.max() < 1e12
    assert abs(state.plastic_work) <= state.work_error + 1e-8 * state.stored_energy
    assert state.loading_work == approx(state.stored_energy, rel=1e-5)


def test_truncated_work_from_an_unloaded_state_is_not_taken_for_granted(rough_contact):
    contact = rough_contact(yield_pressure=P_Y, plasticity="truncated")
    unloaded = step(solve(contact, 0.9 * DEPTH), 0.7 * DEPTH)
    try:
        state = solve(contact, DEPTH, start=unloaded)
    except CaseError:
        return
    assert state.loading_work == approx(solve(contact, DEPTH).loading_work, rel=1e-4)


# --- refusals ---------------------------------------------------------------------------------


def test_negligible_adhesive_work_is_w_times_the_area_with_an_error_that_covers_integrated_values():
    """Integrated values of the adhesive work were 0.37 to 0.93 of w times the contact area."""
    body = Body(500e-6, 210e9, 0.25)
    grid = Grid((64, 64), (0.5e-6, 0.5e-6))
    contact = Contact(Pair(body, body), smooth(grid), adhesion=JKRLimit(1e-4))
    state = solve(contact, 4e-7)
    gain = 1e-4 * state.contact_area
    assert state.adhesive_work == approx(gain, rel=1e-12)
    assert state.work_error == approx(0.65 * gain, rel=1e-12)
