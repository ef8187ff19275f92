"""Impacts one after the other: energy, volume, memory, places, shares."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest

from restitution import (
    Body,
    Cohesive,
    ConstantBound,
    Contact,
    Elastic,
    ExpandingCavity,
    Grid,
    JKRLimit,
    Pair,
    RestitutionError,
    RunIn,
    Surface,
    Truncated,
    generate_surface,
    solve,
    solve_at_velocity,
)
from restitution.contact.patch.law import PatchRepulsion
from restitution.numerics.intervals import half_interval
from restitution.repeated import run_in
from restitution.repeated.run_in import nominal_area
from restitution.repeated.velocities import drawn, in_turn
from tolerance import approx

GRID = Grid((64, 64), (0.2e-6, 0.2e-6))
BALL = Body(50e-6, 210e9, 0.3, 7850)
WALL = Body(math.inf, 210e9, 0.3)
V = 0.2


def rough(seed=1, grid=GRID):
    waves = {"rms": 15e-9, "correlation_length": (1e-6, 1e-6)}
    return generate_surface(grid, kind="gaussian", seed=seed, **waves)


def contact_of(plasticity=None, pair=None, **more):
    models = {"plasticity": plasticity or ConstantBound(1e9), "yields": "first", **more}
    return Contact(pair or Pair(BALL, BALL), rough(), **models)


MIDDLE = 32, 32


def test_the_first_impact_is_that_of_the_new_bodies():
    contact = contact_of()
    hit = RunIn(contact, place="same").hit(V, MIDDLE, MIDDLE)
    state = solve_at_velocity(contact, V)
    assert hit.restitution == approx(math.sqrt(state.stored_energy / state.loading_work))
    assert hit.force == approx(state.force, rel=1e-5)


@pytest.mark.parametrize("plasticity", [ConstantBound(1e9), ExpandingCavity(4e8)])
def test_the_rebound_of_an_impact_hits_the_same_place_elastically(plasticity):
    """Reloading follows the unloading curve, whose work is the kinetic energy of the rebound."""
    runs = RunIn(contact_of(plasticity), place="same")
    first = runs.hit(V, MIDDLE, MIDDLE)
    again = runs.hit(first.restitution * V * (1 - 1e-4), MIDDLE, MIDDLE)
    assert first.restitution < 0.9
    assert again.restitution == approx(1, abs=1e-6)
    assert again.plastic_volume < 1e-4 * first.plastic_volume


def test_impacts_at_one_place_and_velocity_become_elastic():
    runs = RunIn(contact_of(), place="same")
    e = [hit.restitution for hit in itertools.islice(runs.impacts(V), 6)]
    assert (np.diff(e) > 0).all()
    assert e[0] < 0.8
    assert e[-1] > 0.95


@pytest.mark.parametrize(
    ("plasticity", "off"), [(ConstantBound(1e9), 3e-6), (ExpandingCavity(4e8), 3e-4)]
)
def test_the_energy_of_every_impact_balances(plasticity, off):
    runs = RunIn(contact_of(plasticity), rough(7), seed=3)
    kinetic = 0.5 * Pair(BALL, BALL).mass * V**2
    for hit in itertools.islice(runs.impacts(V), 5):
        assert hit.loading_work == approx(kinetic, rel=off)
        assert hit.unloading_work + hit.plastic_work == approx(hit.loading_work)
        assert hit.unloading_work == approx(hit.restitution**2 * hit.loading_work)


@pytest.mark.parametrize("plasticity", [ConstantBound(1e9), ExpandingCavity(4e8)])
def test_the_depth_of_an_impact_is_expected_from_the_last_one(plasticity, monkeypatch):
    """So near that the search for it needs few solves."""
    depths = []

    def recorded(contact, velocity, near):
        state = solve_at_velocity(contact, velocity, near=near)
        depths.append((near, state.indentation))
        return state

    monkeypatch.setattr(run_in, "solve_at_velocity", recorded)
    runs = RunIn(contact_of(plasticity), seed=3)
    for _ in itertools.islice(runs.impacts(itertools.cycle([V, 0.5 * V])), 8):
        pass
    near, depth = np.array(depths[1:]).T
    assert near == approx(depth, rel=0.15)


def test_the_loading_work_is_the_integral_of_the_force_on_worn_surfaces():
    contact = contact_of(ConstantBound(1e9))
    runs = RunIn(contact, place="same")
    runs.hit(V, MIDDLE, MIDDLE)
    worn = replace(contact, surface=runs.surfaces[0])
    hit = runs.hit(V, MIDDLE, MIDDLE)
    depths = hit.indentation * (np.arange(1, 81) / 80) ** 1.5
    force = [0.0, *(solve(worn, d).force for d in depths.tolist())]
    work = np.trapezoid(force, [0.0, *depths])
    assert hit.loading_work == approx(work, rel=1e-3)


@pytest.mark.parametrize("yields", ["first", "second", "both"])
def test_the_surfaces_fall_by_the_plastic_volume(yields):
    other = rough(7)
    contact = contact_of(yields=yields)
    runs = RunIn(contact, other, seed=5)
    volume = sum(hit.plastic_volume for hit in itertools.islice(runs.impacts(V), 4))
    fallen = [
        float((old.height - new.height).sum()) * GRID.cell_area
        for old, new in zip((contact.surface, other), runs.surfaces, strict=True)
    ]
    shares = {"first": (1, 0), "second": (0, 1), "both": (0.5, 0.5)}[yields]
    assert fallen == [approx(share * volume, rel=1e-9, abs=1e-9 * volume) for share in shares]


def test_a_place_that_has_yielded_yields_later_under_the_bound_that_grows():
    """As in J2 (evidence/run_in)."""
    contact = contact_of(ExpandingCavity(4e8))
    runs = RunIn(contact, place="same")
    first = runs.hit(0.05, MIDDLE, MIDDLE)
    state = solve_at_velocity(replace(contact, surface=runs.surfaces[0]), 0.05)
    forgetful = math.sqrt(state.stored_energy / state.loading_work)
    second = runs.hit(0.05, MIDDLE, MIDDLE)
    assert second.restitution > first.restitution + 0.1
    assert second.restitution > forgetful + 0.015


def test_of_two_bodies_that_yield_the_new_one_is_the_softer_one():
    contact = contact_of(ExpandingCavity(4e8), yields="both")
    runs = RunIn(contact, rough(7))
    runs.hit(V, MIDDLE, MIDDLE)
    before = [surface.height for surface in runs.surfaces]
    runs.hit(V, MIDDLE, (0, 0))  # the first body where it has been hit, the second one elsewhere
    given = [
        float((old - new.height).sum()) for old, new in zip(before, runs.surfaces, strict=True)
    ]
    assert given[0] < 0.9 * given[1]


def test_a_window_sees_the_periodic_surface_around_the_place():
    contact = contact_of()
    hit = RunIn(contact).hit(V, (3, 60), MIDDLE)
    moved = np.roll(contact.surface.height, (32 - 3, 32 - 60), (0, 1))
    state = solve_at_velocity(replace(contact, surface=Surface(moved, GRID)), V)
    assert hit.loading_work == approx(state.loading_work, rel=5e-6)
    assert hit.restitution**2 == approx(state.stored_energy / state.loading_work, rel=1e-5)


def test_a_track_on_a_wall_is_at_one_place():
    contact = contact_of(pair=Pair(BALL, WALL), yields="second")
    runs = RunIn(contact, place="track", seed=2)
    for _ in itertools.islice(runs.impacts(V), 4):
        pass
    rows, columns = np.nonzero(runs.surfaces[1].height)
    assert abs(rows - 32).max() < 20
    assert abs(columns - 32).max() < 20
    assert not (runs.surfaces[0].height != contact.surface.height).any()


def test_random_places_are_those_of_the_seed():
    def e(seed):
        return [
            hit.restitution
            for hit in itertools.islice(RunIn(contact_of(), seed=seed).impacts(V), 3)
        ]

    assert e(1) == e(1)
    assert e(1) != e(2)


def test_probes_leave_the_surfaces_as_they_are():
    runs = RunIn(contact_of())
    probes = list(runs.probe(V, 3, 1))
    assert len({probe.restitution for probe in probes}) == 3
    assert runs.count == runs.coverage == 0
    assert (runs.surfaces[0].height == contact_of().surface.height).all()


def test_roughness_is_flattened_and_restitution_grows():
    runs = RunIn(contact_of(), seed=1)
    hits = list(itertools.islice(runs.impacts(V), 60))
    e = [hit.restitution for hit in hits]
    assert np.mean(e[-15:]) > np.mean(e[:15]) + 0.05
    assert hits[-1].coverage == approx(60 * nominal_area(Pair(BALL, BALL), 1e9, V) / (12.8e-6) ** 2)


def test_the_order_of_the_impacts_does_not_matter_in_the_steady_state():
    """Slow and fast ones in turn, at random, or many slow ones first: one distribution of COR."""

    def probed(runs):
        return np.array([hit.restitution for hit in runs.probe(V, 30, 9)])

    def worn(velocities):
        runs = RunIn(contact_of(), seed=4)
        for _ in itertools.islice(runs.impacts(velocities), 100):
            pass
        return probed(runs)

    speeds = [0.5 * V, V]
    slow_first = itertools.chain(itertools.repeat(speeds[0], 40), in_turn(speeds))
    turn, *others = map(worn, (in_turn(speeds), drawn(speeds, [1, 1], 5), slow_first))
    assert turn.mean() > probed(RunIn(contact_of())).mean() + 0.03
    for e in others:
        interval = half_interval(30) * math.hypot(e.std(ddof=1), turn.std(ddof=1))
        assert abs(e.mean() - turn.mean()) < 0.5 * interval
        assert e.std() == approx(turn.std(), rel=0.25)


@pytest.mark.parametrize(
    ("adhesion", "radius", "spacing", "velocity"),
    [
        (JKRLimit(0.2), 10e-6, 100e-9, 1.5),
        (Cohesive(0.05, 3e-9), 2e-6, 16e-9, 1.5),
    ],
    ids=["jkr", "cohesive"],
)
def test_flattened_asperities_adhere_more(adhesion, radius, spacing, velocity):
    grid = Grid((48, 48), (spacing, spacing))
    waves = {"rms": 8e-9 if spacing > 5e-8 else 3e-9, "correlation_length": (6 * spacing,) * 2}
    surface = generate_surface(grid, kind="gaussian", seed=1, **waves)
    ball = Body(radius, 70e9, 0.3, 2500)
    model = {"plasticity": ConstantBound(1e9), "adhesion": adhesion, "yields": "first"}
    runs = RunIn(Contact(Pair(ball, ball), surface, **model), place="same")
    first, second = itertools.islice(runs.impacts(velocity), 2)
    assert second.restitution > first.restitution
    assert second.coverage > first.coverage
    assert second.pull_off_force > 1.05 * first.pull_off_force


def test_elastic_bodies_keep_their_surfaces():
    runs = RunIn(contact_of(Elastic(), yields=None))
    (hit,) = itertools.islice(runs.impacts(V), 1)
    assert hit.restitution == 1
    assert (runs.surfaces[0].height == contact_of().surface.height).all()


def slope(grid=GRID):
    return Surface(np.add.outer(np.linspace(0, 1e-6, 64), np.zeros(64)), grid)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: RunIn(replace(contact_of(), surface=slope())), "does not repeat"),
        (lambda: RunIn(contact_of(Truncated(1e9))), "single impact"),
        (
            lambda: RunIn(contact_of(adhesion=PatchRepulsion((rough(),), 1e-6))),
            "no PatchRepulsion",
        ),
        (lambda: RunIn(contact_of(), place="track"), "needs a wall"),
        (lambda: RunIn(contact_of(), place="there"), "not one of random, same, track"),
        (lambda: RunIn(contact_of(), rough(grid=Grid((32, 32), (4e-7, 4e-7)))), "another grid"),
        (lambda: RunIn(contact_of(pair=Pair(WALL, WALL), periodic=True)), "do not collide"),
        (lambda: RunIn(contact_of()).hit(-V, MIDDLE, MIDDLE), "velocity: -0.2 m/s is not positive"),
        (lambda: next(RunIn(contact_of()).impacts(30.0)), "larger than the surface"),
    ],
)
def test_impossible_sequences_are_refused(make, words):
    with pytest.raises(RestitutionError, match=words):
        make()
