"""The bound of `expanding-cavity` on concentric waves: ridges, and the depth of each asperity."""

import math

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, smooth
from restitution.collision import collide
from restitution.contact.path import loading_path
from restitution.contact.plasticity.cavity import ExpandingCavity, yield_bound
from tolerance import approx

Y = 1e9
BODY = Body(1e-3, 420e9, 0.3, 7850.0)  # two such bodies have the E* of 210 GPa on a rigid flat
PAIR = Pair(BODY, BODY)
ONSET = 1.295 * math.exp(0.736 * 0.3)
FIRST = (math.pi * ONSET * Y / (2 * PAIR.contact_modulus)) ** 2 * PAIR.radius  # 60 nm


def waves(amplitude, wavelength=4e-6, nodes=96):
    grid = Grid((nodes, nodes), (wavelength / 24, wavelength / 24))
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    height = -amplitude * (1 - np.cos(2 * np.pi * r / wavelength))
    return Contact(PAIR, Surface(height, grid), plasticity=ExpandingCavity(Y))


def test_rings_are_elongated_and_round_asperities_are_not():
    ball = Contact(PAIR, smooth(Grid(96, 0.5e-6)), plasticity=ExpandingCavity(Y))
    assert ball.elongation == approx(0, abs=1e-9)
    contact = waves(1e-7)
    middle = contact.grid.nodes[0] // 2
    assert contact.elongation[middle, middle] < 0.01
    crest = middle + 24  # one wavelength from the axis
    assert contact.elongation[crest, middle] > 0.95
    assert contact.elongation[middle, crest] > 0.95


def test_the_bound_of_a_ridge_falls_back_once_asperities_have_merged():
    """At depth only steep rings have a larger bound than round asperities."""

    def over_round(contact, depth):
        bound, _ = yield_bound(contact, depth, 1e-8)
        box = np.s_[:, contact.grid.nodes[1] // 2]
        object.__setattr__(contact, "elongation", np.zeros(contact.grid.nodes))
        plain, _ = yield_bound(contact, depth, 1e-8)
        return (bound / plain)[box].max()

    assert over_round(waves(1e-7), 2e-7) > 1.25
    assert over_round(waves(1e-9), 2e-7) < 1.1


def test_the_bound_takes_the_depth_of_each_asperity():
    """A ring whose crest has a gap h_c is deformed by δ − h_c, not by δ."""
    contact = waves(1e-7)
    middle = contact.grid.nodes[0] // 2
    crest = middle + 24, middle
    first = contact.crest_gap[crest]
    assert first == approx((4e-6) ** 2 / (2 * PAIR.radius), rel=1e-9)
    factor = 1.11 * contact.first_yield_pressure
    just, deep = (yield_bound(contact, depth, 1e-8)[0] for depth in (1.001 * first, 4 * first))
    assert just[crest] == approx(factor, rel=0.01)  # elastic at 2δ, but not at δ
    assert deep[crest] > 1.5 * factor
    object.__setattr__(contact, "crest_gap", np.zeros(contact.grid.nodes))
    alone, _ = yield_bound(contact, 1.001 * first, 1e-8)
    assert alone[crest] > 1.3 * factor
    assert alone[middle, middle] == approx(just[middle, middle], rel=1e-9)  # it touches first


def test_a_ring_that_has_just_come_into_contact_is_that_of_finite_elements():
    """A = 0.1 µm, λ = 4 µm, ω = 0.5, extrapolated (evidence/finite_elements)."""
    contact, depth = waves(1e-7, nodes=120), 0.5 * FIRST
    *_, state = loading_path(contact, np.geomspace(1e-10, depth, 25))
    assert collide(state).restitution == approx(0.89814, rel=0.04)
    assert state.force == approx(0.018679, rel=0.04)


@pytest.mark.parametrize("amplitude", [3e-8, 1e-7])
def test_nothing_flows_back_where_rings_merge(amplitude):
    before = 0.0
    for state in loading_path(waves(amplitude, nodes=160), np.geomspace(2e-9, 1.2e-7, 60)):
        fallen = (before - state.plastic_displacement).max()
        assert fallen <= 1e-5 * state.indentation
        before = state.plastic_displacement
