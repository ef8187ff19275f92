"""A model of plasticity and a law of adhesion of one's own, each in one file, without a change."""

from itertools import groupby, pairwise
from pathlib import Path

import numpy as np
import pytest
from own_exponential import Exponential
from own_soft_ring import SoftOutside
from scipy.interpolate import PchipInterpolator

import restitution as rs
from restitution.contact.checks.inputs import doubtful, impossible
from restitution.contact.checks.model_error import model_error, pull_off_error
from tolerance import approx

STEEL = rs.Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.3, density=7850.0)
PAIR = rs.Pair(STEEL, STEEL)
SOFT = rs.Body(radius=2e-6, youngs_modulus=5e9, poissons_ratio=0.4, density=1100.0)


@pytest.mark.parametrize("name", ["own_soft_ring", "own_exponential"])
def test_a_model_is_one_short_file(name):
    text = (Path(__file__).parent / f"{name}.py").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 60


def work_of(path):
    """Work (J) of the force along a path, by the trapezium rule."""
    return np.trapezoid([s.force for s in path], [s.indentation for s in path])


def work_with_jumps(path):
    """Work (J) of the force along a path: cubics between jumps, the trapezium rule in them."""
    work = 0.0
    for _, states in groupby(path, key=lambda state: state.jumps):
        x, force = np.array(sorted((state.indentation, state.force) for state in states)).T
        work -= PchipInterpolator(x, force).integrate(x[0], x[-1]) if len(x) > 1 else 0.0
    return work + sum(work_of(pair) for pair in pairwise(path) if pair[0].jumps != pair[1].jumps)


@pytest.fixture(scope="module")
def yielding():
    grid = rs.Grid((64, 64), (0.4e-6, 0.4e-6))
    return rs.Contact(PAIR, rs.smooth(grid), plasticity=SoftOutside(2e9, 0.8e9, 4e-6))


def test_a_bound_that_depends_on_the_place(yielding):
    depths = 300e-9 * np.linspace(0, 1, 61)[1:] ** 1.5
    path = list(rs.loading_path(yielding, depths))
    deepest = path[-1]
    r = np.hypot(yielding.grid.x[:, None], yielding.grid.y[None, :])
    assert deepest.pressure[r < 4e-6].max() == approx(2e9)
    assert deepest.pressure[r >= 4e-6].max() == approx(0.8e9)
    assert deepest.loading_work == approx(work_of(path), rel=3e-3)
    assert deepest.plastic_work > 0
    bound = np.where(r < 4e-6, 2e9, 0.8e9)
    dissipated = float((bound * deepest.plastic_displacement).sum()) * yielding.grid.cell_area
    assert deepest.plastic_work == approx(dissipated)
    back = list(rs.unloading_path(deepest, steps=40))
    collision = rs.collide(deepest)
    assert -work_of(back) == approx(collision.unloading_work, rel=5e-3)
    assert collision.restitution == approx(
        (deepest.stored_energy / (deepest.stored_energy + deepest.plastic_work)) ** 0.5
    )
    assert 0 < collision.restitution < 1
    assert back[-1].force == approx(0, abs=1e-9 * deepest.force)


def test_a_step_and_other_ways_to_prescribe_know_the_bound(yielding):
    state = rs.solve(yielding, 200e-9)
    assert rs.step(rs.step(state, 150e-9), 250e-9).force == approx(
        rs.solve(yielding, 250e-9).force, rel=1e-5
    )
    assert rs.solve_at_force(yielding, state.force).indentation == approx(200e-9, rel=1e-5)
    velocity = rs.collide(state).impact_velocity
    assert rs.solve_at_velocity(yielding, velocity).indentation == approx(200e-9, rel=1e-5)


def test_a_model_without_comparison_states_the_largest_error(yielding):
    state = rs.solve(yielding, 300e-9)
    e = rs.collide(state).restitution
    assert 0.1 < model_error(state, e) <= max(e, 1 - e)
    assert "hard spot" in repr(yielding)
    assert impossible(yielding, 300e-9) is None
    assert doubtful(yielding, 1e-9)


@pytest.fixture(scope="module")
def sticky():
    grid = rs.Grid((56, 56), (4e-9, 4e-9))
    law = Exponential(work_of_adhesion=0.06, equilibrium_separation=0.6e-9, reach=0.25e-9)
    return rs.Contact(rs.Pair(SOFT, SOFT), rs.smooth(grid), adhesion=law)


def test_a_law_of_traction_keeps_the_energy_balance(sticky):
    state = rs.solve(sticky, 5e-9)
    back = list(rs.unloading_path(state))
    end = back[-1]
    given = state.potential_energy - end.potential_energy
    lost = end.adhesive_loss - state.adhesive_loss
    assert -work_with_jumps(back) == approx(given - lost, rel=0.002)
    assert abs(end.unaccounted) < 2e-3 * state.stored_energy
    collision = rs.collide(state, back)
    assert collision.unloading_work == approx(state.potential_energy - lost, rel=1e-9)
    assert 0 < collision.restitution < 1
    radius = sticky.pair.radius
    rigid, jkr = (factor * np.pi * 0.06 * radius for factor in (2.0, 1.5))
    assert 0.95 * jkr < collision.pull_off_force < 1.02 * rigid
    assert pull_off_error(state, 1.0) == approx(0.02)


def test_a_law_of_traction_also_yields(sticky):
    contact = rs.Contact(
        sticky.pair,
        sticky.surface,
        plasticity=rs.ConstantBound(8e7),
        adhesion=sticky.adhesion,
    )
    state = rs.solve(contact, 5e-9)
    assert state.box_pressure.max() == approx(8e7, rel=1e-6)
    assert state.plastic_work == approx(8e7 * state.plastic_volume, rel=1e-6)
    assert rs.collide(state).restitution < rs.collide(rs.solve(sticky, 5e-9)).restitution


def test_defaults_agree_with_the_closed_forms():
    """What a law need not define, for a law that defines it in closed form."""
    law = rs.Cohesive(0.05, 0.3e-9)
    inverse, defaults = rs.CohesiveLaw.gap_at, rs.CohesiveLaw
    pressure = np.array([0.0, 1e8, 5e9])
    assert inverse(law, pressure) == approx(law.gap_at(pressure), rel=1e-6)
    for gap in (0.25e-9, 0.5e-9):
        assert defaults.largest_softening(law, gap) == approx(law.largest_softening(gap), rel=0.02)
        for name in ("rigid_sphere_force", "rigid_sphere_energy"):
            found = getattr(defaults, name)(law, gap, 1e-6)
            assert found == approx(getattr(law, name)(gap, 1e-6), rel=0.02)
