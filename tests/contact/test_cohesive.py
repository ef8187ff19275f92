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

from contact_keys import contact_of
from restitution.collision import collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive import steps as cohesive_steps
from restitution.contact.cohesive.equilibrium import CohesiveState, FarEquilibriumError
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.cohesive.loading import load_cohesive, load_until
from restitution.contact.cohesive.separation import separation_of
from restitution.contact.cohesive.steps import follow
from restitution.contact.contact import Contact, smooth
from restitution.contact.loading import solve, step
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.prescribed.force import solve_at_force
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.errors import CaseError, DomainError
from restitution.numerics.grid import Grid
from restitution.numerics.quadrature import integrate_curve
from restitution.surfaces import Surface, generate_surface
from restitution.theory import JKR, Hertz, LennardJones
from tolerance import approx

W, Z0, E_STAR = 0.05, 0.3e-9, 1e11
LENGTH = E_STAR * Z0**2 / W  # of the cohesive zone


def pair_of(tabor):
    """Two equal spheres with a Tabor parameter."""
    radius = tabor**3 * E_STAR**2 * Z0**3 / W**2
    body = Body(2 * radius, 2 * E_STAR * (1 - 0.3**2), 0.3, 2500.0)
    return Pair(body, body)


def sphere(tabor, depth, *, cells=0.3, rough=0.0, seed=0, **options):
    """A cohesive contact on a grid for loading to `depth` (in z0); `cells` over the zone length."""
    pair = pair_of(tabor)
    h = min(cells * LENGTH, 0.25 * math.sqrt(pair.radius * Z0))
    reach = math.sqrt(2 * pair.radius * Z0 * (9 + tabor + max(depth, 0.0)))
    n = 2 * int(reach / h + 2)
    surface = smooth(Grid(n, h))
    if rough:
        rng, x = np.random.default_rng(seed), surface.grid.x
        height = np.zeros((n, n))
        for _ in range(8):
            q = 2 * np.pi * rng.integers(-4, 5, 2) / (n * h)
            height += np.cos(q[0] * x[:, None] + q[1] * x + rng.uniform(0, 6.3))
        surface = Surface(rough * Z0 * height / max(height.std(), 1e-30), surface.grid)
    options = {"adhesion": "cohesive", "work_of_adhesion": W, **options}
    return contact_of(pair, surface, equilibrium_separation=Z0, **options)


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


def approach(contact):
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    yield from follow(begin, 0.5 * Z0, residual=1e-8)


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


def test_each_step_adds_its_error(monkeypatch):
    """Smooth steps add what they leave unaccounted for, jumps their uncertainty."""
    steps, accounted = [], cohesive_steps._accounted

    def watched(state, trial, is_smooth):
        new = accounted(state, trial, is_smooth)
        steps.append((state, trial, is_smooth, new))
        return new

    monkeypatch.setattr(cohesive_steps, "_accounted", watched)
    [*approach(sphere(1.0, 1.0))]
    assert {is_smooth for _, _, is_smooth, _ in steps} == {False, True}
    for state, trial, is_smooth, new in steps:
        added = new.work_error - state.work_error
        left = state.unaccounted + trial.by_quartic - trial.change
        if is_smooth:
            assert new.unaccounted == approx(left, rel=1e-9)
            assert added == approx(abs(left) - abs(state.unaccounted), rel=1e-6)
        else:
            lost = max(trial.by_trapezium - trial.change, 0.0)
            assert added == approx(min(trial.uncertainty, max(lost, abs(trial.change))), rel=1e-9)
            assert added > 0


def test_a_jump_is_bracketed_by_solves_that_end_early(monkeypatch):
    """Solves that would pass the jump end near the branch; states beyond it are used again."""
    tried, make = [], cohesive_steps._try

    def watched(state, at, residual, guide, reach):
        try:
            step = make(state, at, residual, guide, reach)
        except FarEquilibriumError as far:
            tried.append(("left", far.convolutions))
            raise
        kind = "known" if isinstance(guide, CohesiveState) else "solved"
        tried.append((kind, step.state.convolutions))
        return step

    monkeypatch.setattr(cohesive_steps, "_try", watched)
    states = [*approach(sphere(1.0, 1.0))]
    assert states[-1].jumps == 1
    spent = {kind: [n for name, n in tried if name == kind] for kind, _ in tried}
    assert max(spent["left"]) < 0.5 * max(spent["solved"])
    assert sum(spent["known"]) <= len(spent["known"])
    # The path counts all of them, and those of larger boxes.
    path = sum(state.convolutions for state in states)
    assert sum(n for kind in spent.values() for n in kind) == approx(path, rel=0.005)


@pytest.mark.parametrize("of_step", [0.0, 2e-6, 2e-5])
def test_a_step_after_a_jump_loses_no_energy_by_its_length(monkeypatch, of_step):
    """Steps of 0.25 z0 lost four times as much, and had a pull-off force 3 % too small."""
    monkeypatch.setattr(cohesive_steps, "_OF_STEP", of_step)
    contact = sphere(1.2, 4.0, rough=1.0, seed=5)
    state = load_cohesive(contact, 4 * Z0, start=None, residual=1e-8)
    found = separation_of([*unloading_path(state)])
    # Steps 25 times finer lose 1.05e-17 J.
    assert state.adhesive_loss < 1.05e-17 + state.work_error
    assert found.pull_off_force == approx(2.8532e-5, rel=1e-3)


def test_increments_of_plastic_work_add_their_error(monkeypatch):
    monkeypatch.setattr(ExpandingCavity, "work", lambda *_: (0.0, 1e-20))
    tried, make = [], cohesive_steps._try

    def watched(state, *options):
        tried.append((state, make(state, *options)))
        return tried[-1][1]

    monkeypatch.setattr(cohesive_steps, "_try", watched)
    contact = sphere(0.5, 2.0, yield_strength=0.02 * E_STAR)
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    for _ in zip(follow(begin, 0.5 * Z0, residual=1e-8), range(5), strict=False):
        pass
    assert all(
        trial.state.work_error == approx(state.work_error + 1e-20, rel=1e-9)
        for state, trial in tried
        if trial.state.indentation > state.indentation
    )


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


def unloaded(contact, depths, *, share):
    """Pull-off and unloading work from each of `depths`, with or without known states."""
    found, back, state = [], (), None
    for depth in depths:
        state = solve(contact, depth, start=state)
        back = list(unloading_path(state, known=back if share else ()))
        end = collide(state, back)
        found.append((end.unloading_work, end.pull_off_force, end.convolutions, end.adhesive_loss))
    return np.array(found).T


def rough_silica(youngs_modulus, limit=math.inf):
    body = Body(radius=5e-6, youngs_modulus=youngs_modulus, poissons_ratio=0.17)
    surface = generate_surface(
        Grid(96, 4e-9), kind="gaussian", rms=1e-9, correlation_length=60e-9, seed=1
    )
    return Contact(
        Pair(body, body), surface, plasticity=ConstantBound(limit), adhesion=Cohesive(0.05)
    )


DEPTHS = (0.5e-9, 1.5e-9, 3e-9)


@pytest.mark.parametrize("limit", [math.inf, 0.5e9])
def test_a_contact_without_jumps_unloads_through_the_states_of_loading(limit):
    """After yield the surfaces differ, so every unloading is computed."""
    contact = rough_silica(70e9, limit)
    found = unloaded(contact, DEPTHS, share=False)
    state = solve(contact, DEPTHS[-1])
    afresh = list(unloading_path(replace(state, before=None)))
    end = collide(state, afresh)
    assert end.unloading_work == approx(found[0][-1], rel=1e-3)
    assert end.pull_off_force == approx(found[1][-1], rel=2e-3)
    if math.isinf(limit):
        assert state.jumps == 0
        assert found[2][-1] < 0.4 * end.convolutions
        assert np.ptp(found[1]) < 1e-3 * found[1].max()
    else:
        assert found[2][-1] == approx(end.convolutions, rel=0.3)


def test_a_contact_that_jumped_joins_the_unloading_from_a_shallower_depth():
    contact = sphere(1.0, 3.0)
    assert solve(contact, Z0).jumps > 0
    depths = (Z0, 2 * Z0, 3 * Z0)
    joined, alone = (unloaded(contact, depths, share=share) for share in (True, False))
    assert joined[0] == approx(alone[0], rel=1e-6)
    assert joined[1] == approx(alone[1], rel=1e-6)
    assert joined[3] == approx(alone[3], rel=1e-6)
    assert joined[2][1:].sum() < 0.7 * alone[2][1:].sum()


def test_a_shallower_state_is_loaded_from_the_path_to_a_deeper_one():
    contact = rough_silica(70e9, 0.5e9)
    deep = solve(contact, DEPTHS[-1])
    state, afresh = solve(contact, DEPTHS[0], start=deep), solve(contact, DEPTHS[0])
    assert state.force == approx(afresh.force, rel=1e-3)
    assert state.loading_work == approx(afresh.loading_work, rel=1e-3)
    assert state.convolutions < 0.5 * afresh.convolutions


def test_a_path_goes_on_where_the_distance_is_estimated_too_small():
    goal = 8 * Z0
    for short in (lambda *_: 0.0, lambda *_: -1e-9):
        before, after = load_until(
            sphere(0.5, 2.0),
            lambda state: state.indentation >= goal,
            short,
            start=None,
            residual=1e-8,
        )
        assert before.force > 0
        assert before.indentation < goal <= after.indentation < goal + Z0


def test_separation_does_not_depend_on_the_length_of_the_steps(monkeypatch):
    """The smallest gap reaches that of the largest attraction between two states of unloading."""
    contact = sphere(0.5, 2.0)
    state = replace(solve(contact, 2 * Z0), before=None)
    found = [separation_of([*unloading_path(state)]).separation_indentation]
    for name, value in (("_UNDER_TENSION", 0.05), ("_GROWTH", 1.1)):
        monkeypatch.setattr(cohesive_steps, name, value)
    found.append(separation_of([*unloading_path(state)]).separation_indentation)
    assert found[0] == approx(found[1], abs=0.01 * Z0)


def test_loading_with_a_larger_tolerance_takes_fewer_solves_and_comes_near():
    fine = sphere(1.0, 12.0, rough=0.5, yield_pressure=4e9)
    coarse = replace(fine, adhesion=fine.adhesion.with_work_tolerance(0.04))
    ends = [solve(contact, 12 * Z0) for contact in (fine, coarse)]
    assert ends[1].convolutions < 0.6 * ends[0].convolutions
    assert ends[1].loading_work == approx(ends[0].loading_work, rel=0.03)
    assert ends[1].loading_work != ends[0].loading_work
