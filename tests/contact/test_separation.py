"""Unloading to separation: its end, and the error raised without separation."""

import itertools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, collide, generate_surface, smooth, solve
from restitution.case.models import adhesion_of
from restitution.contact.cohesive import separation as cohesive_separation
from restitution.contact.jkr import separation
from restitution.contact.jkr.approach import HertzianApproach, PullIncrements
from restitution.contact.jkr.detachment import CrackClosure
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.plasticity.bound import ConstantBound
from restitution.errors import NotConvergedError
from tolerance import approx

STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)


@pytest.fixture(scope="module")
def pressed():
    grid = Grid((31, 31), (0.15e-6, 0.15e-6))
    contact = Contact(
        Pair(STEEL, STEEL), smooth(grid), adhesion=JKRLimit(0.09, approach=HertzianApproach())
    )
    return solve(contact, 3e-9)


def test_the_way_back_ends_without_contact(pressed):
    path = list(separation.separate(pressed))
    assert path[0] is pressed
    assert separation.separation_of(path).steps == len(path[1:])
    assert path[-1].contact_nodes == 0
    assert all(state.contact_nodes for state in path[:-1])
    assert all(np.diff([state.indentation for state in path]) < 0)


def test_bodies_that_do_not_part_are_said_so(pressed, monkeypatch):
    monkeypatch.setattr(separation, "_MOST_STEPS", 3)
    with pytest.raises(NotConvergedError, match="have not separated after 3 steps") as refusal:
        list(separation.separate(pressed))
    assert "check work_of_adhesion (0.09 J/m2)" in str(refusal.value)


def loaded(detachment, n=40, depth=3.5e-9):
    grid = Grid((n, n), (0.15e-6, 0.15e-6))
    contact = Contact(
        Pair(STEEL, STEEL),
        smooth(grid),
        adhesion=adhesion_of(work_of_adhesion=0.09, approach="hertzian", detachment=detachment),
    )
    return solve(contact, depth)


def test_a_smaller_error_takes_more_steps():
    """The tension limit releases nodes late, so its error depends on the steps."""
    state = loaded("pohrt-popov", 31, 3e-9)
    steps = [
        separation.separation_of(list(separation.separate(state, tolerance=tolerance))).steps
        for tolerance in (0.05, 0.002)
    ]
    assert steps[1] > steps[0]


def test_an_error_above_the_asked_one_takes_finer_steps(monkeypatch):
    state = loaded("pohrt-popov")
    steps = len(list(separation.separate(state, tolerance=5e-4)))
    monkeypatch.setattr(separation, "_REFINEMENTS", (1,))
    path = list(separation.separate(state, tolerance=5e-4))
    found = separation.separation_of(path)
    e = (found.unloading_work / state.loading_work) ** 0.5
    assert 0.5 * e * found.error / found.unloading_work > 5e-4
    assert steps > len(path)


def test_steps_stop_where_the_grid_has_the_larger_error(monkeypatch):
    """Finer steps do not reduce the error of the grid, a fraction of w times the area."""
    state = loaded("crack-closure")
    monkeypatch.setattr(separation, "_REFINEMENTS", (1,))
    once = list(separation.separate(state, tolerance=1e-6))
    monkeypatch.setattr(separation, "_REFINEMENTS", (1, 2, 4))
    error = separation.separation_of(once).error
    fraction = error / (state.contact.adhesion.work_of_adhesion * state.contact_area)
    monkeypatch.setattr(CrackClosure, "small_error", 1.01 * fraction)
    assert len(list(separation.separate(state, tolerance=1e-6))) == len(once)
    monkeypatch.setattr(CrackClosure, "small_error", 0.99 * fraction)
    assert len(list(separation.separate(state, tolerance=1e-6))) > len(once)


def test_the_error_holds_what_the_grid_takes_in_letting_go(pressed):
    """Crack closure releases at 0.985 to 0.99 of w, in steps of any size."""
    path = list(separation.separate(pressed))
    found, whole = separation.separation_of(path), collide(pressed, path)
    surface_energy = pressed.contact.adhesion.work_of_adhesion * pressed.contact_area
    added = whole.unloading_work_error - found.error
    assert 0.01 * surface_energy < added < 0.02 * surface_energy


def test_no_step_jumps_over_the_tension():
    """Steps of a tenth of the recovery gave half of this pull-off force; finer steps 2.2e-4 N.

    The grid does not resolve these asperities (a_c/h = 0.8 to 2).
    """
    grid = Grid((128, 128), (0.25e-6, 0.25e-6))
    surface = generate_surface(grid, kind="gaussian", rms=0.1e-6, correlation_length=2e-6, seed=2)
    contact = Contact(
        Pair(STEEL, STEEL), surface, plasticity=ConstantBound(750e6), adhesion=JKRLimit(0.09)
    )
    path = list(separation.separate(solve(contact, 200e-9)))
    assert sum(state.force < 0 for state in path) > 15
    assert separation.separation_of(path).pull_off_force == approx(2.2e-4, rel=0.08)


def test_a_seed_that_lets_go_of_everything_is_parted_and_returns_nothing():
    """A surface this soft yields by more than the pull of 0.1 nm, so no node stays in contact."""
    contact = Contact(
        Pair(STEEL, STEEL),
        smooth(Grid(32, 0.5e-6)),
        plasticity=ConstantBound(1e6),
        adhesion=JKRLimit(1e-3, approach=PullIncrements()),
    )
    state = solve(contact, 1e-10)
    assert (state.contact_nodes, state.force, state.contact_area) == (0, 0.0, 0.0)
    assert state.plastic_volume > 0
    assert [each is state for each in separation.separate(state)] == [True]
    collision = collide(state)
    assert collision.sticks
    assert (collision.restitution, collision.pull_off_force) == (0.0, 0.0)


def test_energy_that_is_not_accounted_for_is_an_error(pressed):
    """The energy lost between states must equal the work of the steps."""
    path = list(separation.separate(pressed))
    before = separation.separation_of(path)
    missing = 0.1 * before.unloading_work
    wrong = [*path[:-1], replace(path[-1], adhesive_work=path[-1].adhesive_work + missing)]
    after = separation.separation_of(wrong)
    assert after.error == approx(before.error + abs(missing), rel=0.05)


@pytest.mark.parametrize(
    ("detachment", "late_share"), [("crack-closure", 0.15), ("pohrt-popov", 0.5)]
)
def test_the_error_of_unloading_is_the_sum_of_its_parts(detachment, late_share, monkeypatch):
    """Steps, late release and what the energies of the states leave unaccounted for."""
    path = list(separation.separate(loaded(detachment)))
    depth = np.array([state.indentation for state in path])
    force = np.array([state.force for state in path])
    by_trapezoids = -np.trapezoid(force, depth)
    late = -sum(
        separation._late_force(state) * (state.indentation - before.indentation)
        for before, state in itertools.pairwise(path)
    )
    given = path[0].loading_work - path[-1].loading_work
    unaccounted = abs(given - (by_trapezoids - late))
    curve = separation.unloading_curve(path)
    steps = abs(curve.work() - curve.halved().work())
    expected = steps + unaccounted + (0.0 if curve.balanced else late_share * abs(late))
    found = separation.separation_of(path)
    assert min(steps, unaccounted) > 1e-3 * expected
    if found.unloading_work < path[0].stored_energy:
        assert found.error == approx(expected, rel=1e-6)

    # Unloading returns at most the elastic energy; what is cut off is an error.
    limit = 0.5 * curve.work()
    monkeypatch.setattr(type(path[0]), "stored_energy", property(lambda _: limit))
    limited = separation.separation_of(path)
    given = path[0].loading_work - path[-1].loading_work
    unaccounted = abs(given - (by_trapezoids - late))
    assert curve.balanced == (detachment == "crack-closure")
    if curve.balanced:
        assert limited.unloading_work == limit
        assert limited.error == approx(steps + curve.work() - limit + unaccounted, rel=1e-6)


def test_the_largest_tension_is_that_of_a_parabola():
    """Through the state of the largest tension and both beside it, unless one of them jumped."""

    def path(depths, jumps=(0, 0, 0, 0)):
        states = (3e4 * (x - 0.3) ** 2 - 5 for x in depths)
        numbers = zip(depths, states, jumps, strict=True)
        return [SimpleNamespace(indentation=x, force=F, jumps=n) for x, F, n in numbers]

    inside = path((0.32, 0.31, 0.298, 0.28))
    assert cohesive_separation._largest_tension(inside) == approx(5.0, rel=1e-9)
    coarse = -inside[2].force
    assert coarse < 5 * (1 - 1e-3)
    for jumps in ((0, 0, 0, 1), (0, 1, 1, 1), (0, 0, 1, 1)):
        jumped = path((0.32, 0.31, 0.298, 0.28), jumps)
        expected = 5.0 if jumps == (0, 1, 1, 1) else coarse
        assert cohesive_separation._largest_tension(jumped) == approx(expected, rel=1e-9)
    for ends in (inside[2:], inside[:3]):
        assert cohesive_separation._largest_tension(ends) == coarse
    assert cohesive_separation._largest_tension(path((0.35, 0.34, 0.33, 0.32))) == 0.0
