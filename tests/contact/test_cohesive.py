"""Attraction of finite range: the axisymmetric reference, energies, limits and bad input."""

import csv
import itertools
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cohesive_spheres import E_STAR, LENGTH, Z0, W, approach, pair_of, sphere
from contact_keys import contact_of
from restitution.collision import collide
from restitution.contact.cohesive.loading import load_cohesive
from restitution.contact.cohesive.separation import separation_of
from restitution.contact.cohesive.steps import follow
from restitution.contact.contact import smooth
from restitution.contact.loading import solve, step
from restitution.contact.path import unloading_path
from restitution.contact.prescribed.force import solve_at_force
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.errors import CaseError, DomainError
from restitution.numerics.grid import Grid
from restitution.numerics.quadrature import integrate_curve
from restitution.theory import JKR, Hertz, LennardJones
from tolerance import approx


def reference(tabor):
    file = Path(__file__).parents[2] / "evidence/cohesive/cohesive_reference.csv"
    with open(file) as lines:
        rows = [row for row in csv.DictReader(lines) if float(row["tabor_parameter"]) == tabor]
    return {key: float(value) for key, value in rows[-1].items()}


@pytest.mark.parametrize("tabor", [0.1, 0.5, 1.0, 2.0])
def test_the_axisymmetric_reference(tabor):
    depth = min(3 * tabor, 2.0)  # in contact; deeper ones take much longer
    contact = sphere(tabor, depth)
    state = solve(contact, depth * Z0)
    path = list(unloading_path(state))
    jkr = JKR(contact.pair.radius, E_STAR, W)
    exact = reference(tabor)
    pull_off = separation_of(path).pull_off_force / float(jkr.pull_off_force)
    assert pull_off == approx(exact["pull_off_over_jkr"], rel=0.01)
    lost = path[-1].adhesive_loss / float(jkr.hysteresis_loss)
    # at µ = 0.1 and 0.5 nothing is lost, and no jump is reported
    assert lost == approx(exact["hysteresis_over_jkr"], rel=0.04, abs=1e-12)
    assert path[-1].jumps == (2 if exact["hysteresis"] else 0)
    for states, key in (([*approach(contact)], "jump_in"), (path, "jump_out")):
        before = [a for a, b in itertools.pairwise(states) if b.jumps > a.jumps]
        at = [state.indentation / Z0 for state in before]
        assert at == approx([exact[f"{key}_over_z0"]] if exact["hysteresis"] else [], rel=0.04)


def test_rigid_spheres_are_bradleys():
    contact = sphere(0.02, 0.0)
    law = LennardJones(W, Z0)
    for gap in (5.0, 2.0, 1.1):
        state = solve_far(contact, (1 - gap) * Z0)
        R = contact.pair.radius
        assert state.force == approx(law.rigid_sphere_force(gap * Z0, R), rel=0.01)
        assert state.loading_work == approx(law.rigid_sphere_energy(gap * Z0, R), rel=0.01)


def solve_far(contact, indentation):
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    return [begin, *follow(begin, indentation, residual=1e-8)][-1]


def test_without_attraction_it_is_hertz():
    # A weak law of short range: force and area of Hertz, shifted by the compressed range.
    contact = sphere(0.5, 50.0, work_of_adhesion=0.05 * W, cells=2.0)
    contact = replace(contact, pair=pair_of(0.5))
    state = solve(contact, 50 * Z0)
    hertz = Hertz(contact.pair.radius, E_STAR)
    assert state.force == approx(hertz.force((50 - 0.33) * Z0), rel=1e-3)
    assert state.contact_area == approx(math.pi * contact.pair.radius * (50 + 3.7) * Z0, rel=0.02)


def test_a_cycle_without_jump_costs_nothing():
    contact = sphere(0.5, 2.0)
    collision = collide(solve(contact, 2 * Z0))
    assert collision.adhesive_loss == 0.0
    assert collision.unloading_work == approx(collision.loading_work, rel=1e-9)


def test_the_energy_estimate_holds_within_its_error():
    state = solve(sphere(1.0, 8.0), 8 * Z0)
    exact, estimate = collide(state), collide(state, method="energy-estimate")
    off = estimate.unloading_work - exact.unloading_work
    assert off == approx(exact.adhesive_loss, rel=1e-3)
    assert 0 <= off <= estimate.unloading_work_error


def test_the_work_of_the_force_is_that_of_the_energies():
    contact = sphere(1.0, 4.0)
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    states = [begin, *follow(begin, 4 * Z0, residual=1e-8, accuracy=2e-5)]
    depth, force = (
        np.array([getattr(state, name) for state in states]) for name in ("indentation", "force")
    )
    by_force = integrate_curve(depth, force)
    by_energy = states[-1].loading_work - begin.loading_work
    assert by_force == approx(by_energy, abs=2e-3 * states[-1].stored_energy)
    assert states[-1].jumps >= 1


@settings(max_examples=4, deadline=None)
@given(
    tabor=st.floats(0.3, 1.2),
    depth=st.floats(0.5, 4.0),
    rough=st.floats(0.0, 1.0),
    seed=st.integers(0, 10**6),
    hard=st.sampled_from([math.inf, 0.01, 0.002]),
)
def test_energies_balance_in_random_contacts(tabor, depth, rough, seed, hard):
    contact = sphere(tabor, depth, rough=rough, seed=seed, yield_pressure=hard * E_STAR)
    state = solve(contact, depth * Z0)
    path = list(unloading_path(state))
    found = separation_of(path)
    end = path[-1]
    # what was put in is stored, dissipated or returned
    assert state.loading_work == approx(
        state.potential_energy + state.plastic_work + state.adhesive_loss, rel=1e-9
    )
    lost = end.adhesive_loss - state.adhesive_loss + end.plastic_work - state.plastic_work
    assert found.unloading_work == approx(state.potential_energy - lost, rel=1e-9, abs=1e-24)
    assert found.unloading_work <= state.stored_energy + max(state.interaction_energy, 0.0)
    depths, forces = ([getattr(s, k) for s in path] for k in ("indentation", "force"))
    rest = -end.potential_energy  # work of the rest of the way
    by_force = -integrate_curve(depths, forces) - rest
    scale = state.stored_energy + abs(state.interaction_energy)
    assert by_force == approx(found.unloading_work, abs=max(3 * found.error, 2e-3 * scale))
    assert min(s.adhesive_loss for s in path) >= 0
    assert all(b.adhesive_loss >= a.adhesive_loss for a, b in itertools.pairwise(path))


def test_yield_bounds_the_pressure_and_accumulates():
    bound = 0.0015 * E_STAR
    contact = sphere(1.0, 6.0, yield_pressure=bound)
    shallow, deep = solve(contact, 3 * Z0), solve(contact, 6 * Z0)
    assert deep.box_pressure.max() <= bound * (1 + 1e-5)
    assert deep.plastic_work > shallow.plastic_work > 0
    assert deep.plastic_work == approx(bound * deep.plastic_volume, rel=1e-9)
    further = solve(contact, 6 * Z0, start=shallow)
    assert further.plastic_volume == approx(deep.plastic_volume, rel=1e-3)
    back = step(deep, 5 * Z0)
    assert (back.plastic_displacement >= deep.plastic_displacement).all()
    assert not back.is_first_loading


def test_a_growing_bound():
    contact = sphere(1.0, 6.0, yield_strength=8e-4 * E_STAR)
    state = solve(contact, 6 * Z0)
    assert state.plastic_work > 0
    assert (state.box_pressure <= state.bound[state.box] * (1 + 1e-5)).all()
    assert state.plastic_work <= state.bound.max() * state.plastic_volume
    assert collide(state).unloading_work < state.stored_energy


def test_prescribed_velocity_and_force():
    contact = sphere(1.0, 8.0)
    sticking = float(JKR(contact.pair.radius, E_STAR, W).sticking_velocity(contact.pair.mass))
    state = solve_at_velocity(contact, 0.5 * sticking)
    collision = collide(state)
    assert collision.impact_velocity == approx(0.5 * sticking, rel=1e-4)
    # e² = 1 − (loss/W), with the loss of the reference
    share = reference(1.0)["hysteresis_over_jkr"] / 0.25
    assert collision.restitution**2 == approx(1 - share, abs=0.01)
    assert collision.restitution_error < 0.01
    pressed = solve_at_force(contact, state.force)
    assert pressed.indentation == approx(state.indentation, rel=1e-3)


def test_contact_is_where_the_law_is_stable():
    state = solve(sphere(1.0, 3.0), 3 * Z0)
    touching = state.box_touching
    assert 0 < touching.sum() < touching.size
    assert (state.box_pressure[~touching] < 0).all()
    assert state.contact_nodes == touching.sum() == state.patch_sizes()[0]


def test_a_coarse_grid_is_refused():
    contact = sphere(1.0, 2.0)
    zone = contact.adhesion.zone_length(contact.pair)
    coarse = replace(contact, surface=smooth(Grid(40, 1.01 * 0.3 * zone)))
    needed = contact.adhesion.coarsest_spacing(contact.pair)
    assert needed == approx(0.3 * LENGTH)
    with pytest.raises(CaseError, match=f"needs {1e9 * needed:.4g} nm or less"):
        solve(coarse, Z0)


def test_a_small_grid_is_refused():
    contact = sphere(1.0, 0.0)
    with pytest.raises(DomainError, match="edge"):
        solve(contact, 60 * Z0)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"plasticity": "truncated", "yield_pressure": 1e9}, "truncated"),
        ({"equilibrium_separation": -1e-10}, "equilibrium_separation"),
    ],
)
def test_bad_input(options, words):
    valid = {"work_of_adhesion": W, "adhesion": "cohesive"}
    with pytest.raises(CaseError, match=words) as refusal:
        contact_of(pair_of(1.0), smooth(Grid(8, 1e-8)), **{**valid, **options})
    assert "\n" not in str(refusal.value)


def test_the_error_of_unloading_is_that_of_the_steps_and_of_the_grid():
    path = list(unloading_path(solve(sphere(1.0, 2.0), 2 * Z0)))
    found, end = separation_of(path), path[-1]
    lost = end.adhesive_loss - path[0].adhesive_loss
    depth, force = ([getattr(state, key) for state in path] for key in ("indentation", "force"))
    by_force = end.potential_energy - integrate_curve(depth, force)
    steps = max(end.work_error - path[0].work_error, abs(by_force - found.unloading_work))
    spacing = path[0].contact.grid.spacing[0] / path[0].contact.adhesion.coarsest_spacing(
        path[0].contact.pair
    )
    assert steps > 0
    assert lost > 0
    assert found.error == approx(steps + 0.05 * spacing**2 * lost, rel=1e-6)
