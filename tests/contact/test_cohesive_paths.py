"""Paths of attractions of finite range: steps, jumps, and states that another path has computed."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cohesive_spheres import E_STAR, Z0, approach, sphere
from restitution.collision import collide
from restitution.contact.bodies import Body, Pair
from restitution.contact.cohesive import steps as cohesive_steps
from restitution.contact.cohesive.equilibrium import CohesiveState, FarEquilibriumError
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.cohesive.loading import load_cohesive, load_until
from restitution.contact.cohesive.separation import separation_of
from restitution.contact.cohesive.steps import follow
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.models import RESTITUTION_ERROR
from restitution.contact.path import unloading_path
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.numerics.grid import Grid
from restitution.surfaces import generate_surface
from tolerance import approx


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


@pytest.mark.parametrize("seed", [1, 3])
def test_a_long_step_under_pressure_is_halved_without_a_search_for_a_jump(monkeypatch, seed):
    """Its nodes move farther than a jump would; such paths took up to 45 solves."""
    tried, left, make = [], [], cohesive_steps._try

    def watched(state, *options):
        tried.append(state)
        try:
            return make(state, *options)
        except FarEquilibriumError:
            left.append(state.force)
            raise

    monkeypatch.setattr(cohesive_steps, "_try", watched)
    contact = rough_silica(70e9, rms=2e-9, length=50e-9, seed=seed)
    begin = load_cohesive(contact, -math.inf, start=None, residual=1e-8)
    end = [*follow(begin, 8e-9, residual=1e-8, accuracy=2e-3)][-1]
    assert end.indentation == 8e-9
    assert max(left, default=0.0) <= 0
    assert len(tried) <= 22


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


def unloaded(contact, depths, *, share):
    """Pull-off and unloading work from each of `depths`, with or without known states."""
    found, back, state = [], (), None
    for depth in depths:
        state = solve(contact, depth, start=state)
        back = list(unloading_path(state, known=back if share else ()))
        end = collide(state, back)
        found.append((end.unloading_work, end.pull_off_force, end.convolutions, end.adhesive_loss))
    return np.array(found).T


def rough_silica(youngs_modulus, limit=math.inf, *, rms=1e-9, length=60e-9, seed=1):
    body = Body(radius=5e-6, youngs_modulus=youngs_modulus, poissons_ratio=0.17)
    surface = generate_surface(
        Grid(96, 4e-9), kind="gaussian", rms=rms, correlation_length=length, seed=seed
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


def test_an_elastic_contact_without_jumps_solves_its_unloading_once():
    contact = rough_silica(70e9)
    shared, alone = (unloaded(contact, DEPTHS, share=share) for share in (True, False))
    assert shared[2][0] == alone[2][0] > 0
    assert not shared[2][1:].any()
    assert shared[1] == approx(np.full(3, shared[1][0]), rel=1e-12)
    assert shared[0] == approx(alone[0], rel=1e-6)


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


def test_losses_by_jumps_do_not_depend_on_the_accuracy_of_steps():
    """With finer steps, errors of loose solves would count as jumps, and lose energy each time."""
    body = Body(radius=5e-6, youngs_modulus=24.1e9, poissons_ratio=0.3, density=1540)
    grid = Grid((224, 224), (1e-9, 1e-9))
    surface = generate_surface(grid, kind="gaussian", rms=0.15e-9, correlation_length=50e-9, seed=1)
    contact = Contact(Pair(body, body), surface, adhesion=Cohesive(0.05))
    found = []
    for share in (1.0, 0.1):
        accuracy = share * cohesive_steps.ACCURACY
        state = load_cohesive(contact, 1.3e-9, start=None, residual=1e-8, accuracy=accuracy)
        path = list(unloading_path(state, tolerance=share * RESTITUTION_ERROR))
        found.append((path[-1].jumps, path[-1].adhesive_loss))
    (jumps, loss), (same, finer) = found
    assert jumps == same == 2
    assert 1e-20 < loss == approx(finer, rel=0.02)


@pytest.mark.parametrize("seed", [1, 4])
def test_losses_by_jumps_do_not_depend_on_where_the_steps_end(seed):
    """Neither is the largest tension within a step a jump, nor is a jump within a step missed."""
    body = Body(radius=5e-6, youngs_modulus=24.1e9, poissons_ratio=0.3, density=1540)
    grid = Grid((112, 112), (1.5e-9, 1.5e-9))
    shape = {"rms": 0.15e-9, "correlation_length": 20e-9, "seed": seed}
    surface = generate_surface(grid, kind="gaussian", **shape)
    contact = Contact(Pair(body, body), surface, adhesion=Cohesive(0.05))
    losses = []
    for share in (1.0, 0.8, 0.6):
        accuracy = share * cohesive_steps.ACCURACY
        state = load_cohesive(contact, 0.2e-9, start=None, residual=1e-8, accuracy=accuracy)
        losses.append(state.adhesive_loss)
    assert min(losses) > 1e-19
    assert max(losses) < 1.03 * min(losses)
