"""Smooth elastic-plastic spheres: depend on x = δ/δ_y alone; both plasticity models."""

import math

import pytest

from restitution import Body, Contact, Grid, Pair, collide, smooth, solve
from restitution.case.models import plasticity_of
from restitution.contact.plasticity.bound import ConstantBound
from restitution.theory import FirstYield, JacksonGreen, ThorntonNing
from tolerance import approx

P_Y = 750e6


def at(pair, x, nodes_over_yield_radius, p_y=P_Y, plasticity="equilibrium"):
    """The state at δ = x δ_y on a grid that just holds it, with δ_y and F_y."""
    onset = FirstYield(pair.radius, pair.contact_modulus, p_y)
    depth_y = float(onset.indentation)
    h = math.sqrt(pair.radius * depth_y) / nodes_over_yield_radius
    n = 2 * int(1.2 * math.sqrt(2 * pair.radius * x * depth_y) / h) + 1
    contact = Contact(
        pair,
        smooth(Grid((n, n), (h, h))),
        plasticity=plasticity_of(plasticity, p_y),
    )
    return solve(contact, x * depth_y), depth_y, float(onset.force)


@pytest.mark.parametrize(
    ("x", "force", "work", "cor"),
    [
        (1.5, 1.815, 1.0990, 0.9773),
        (2, 2.720, 2.2300, 0.9379),
        (6, None, None, 0.752),
        (16, 36.08, 264.70, 0.6010),
        (36, None, None, 0.496),
    ],
)
def test_equilibrium_table(pair, x, force, work, cor):
    state, depth_y, force_y = at(pair, x, 16)
    assert collide(state).restitution == approx(cor, rel=3e-3)
    if force is not None:
        assert state.force / force_y == approx(force, rel=3e-3)
        assert state.loading_work / (force_y * depth_y) == approx(work, rel=3e-3)


@pytest.mark.parametrize(("x", "area"), [(1.5, 1.011), (2, 1.037), (6, 1.272), (16, 1.507)])
def test_equilibrium_contact_area(pair, x, area):
    """Area is counted in nodes: its error is of first order in h/a, so it is extrapolated.

    The reference values were counted on one grid and carry about that grid's error.
    """
    coarse, fine = (
        at(pair, x, n)[0].contact_area / (math.pi * pair.radius * at(pair, x, n)[0].indentation)
        for n in (16, 32)
    )
    assert 2 * fine - coarse == approx(area, rel=1e-2)
    assert 1 < fine < 2


@pytest.mark.parametrize(("x", "cor"), [(2, 0.8915), (8, 0.6238), (32, 0.4382)])
def test_truncated_table(pair, x, cor):
    state, depth_y, _ = at(pair, x, 12, plasticity="truncated")
    assert collide(state).restitution == approx(cor, rel=3e-3)
    assert state.work_error < 1e-3 * state.loading_work  # nodes yield one after the other
    law = ThorntonNing(pair.radius, pair.contact_modulus, P_Y)
    assert state.loading_work == approx(float(law.loading_work(x * depth_y)), rel=1e-3)


@pytest.mark.parametrize("x", [2, 8, 32])
def test_truncated_follows_thornton_and_ning(pair, x):
    state, depth_y, _ = at(pair, x, 24, plasticity="truncated")
    law = ThorntonNing(pair.radius, pair.contact_modulus, P_Y)
    assert state.force == approx(float(law.loading_force(x * depth_y)), rel=5e-4)
    cor = float(law.restitution_at_indentation(x * depth_y))
    assert collide(state).restitution == approx(cor, rel=0.06)


@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_scale_invariance(pair, plasticity):
    """Another radius, modulus and yield pressure at the same x: the same restitution."""
    other_body = Body(radius=3e-3, youngs_modulus=70e9, poissons_ratio=0.33, density=2700.0)
    wall = Body(radius=math.inf, youngs_modulus=3e9, poissons_ratio=0.4)
    here, *_ = at(pair, 5, 10, plasticity=plasticity)
    for other, p_y in ((Pair(other_body, other_body), 400e6), (Pair(other_body, wall), 9e6)):
        there, *_ = at(other, 5, 10, p_y, plasticity)
        assert collide(there).restitution == approx(collide(here).restitution, rel=1e-6)


@pytest.mark.parametrize("ratio", [0.001, 0.003])
@pytest.mark.parametrize("omega", [1.5, 10, 40, 110])
def test_equilibrium_follows_finite_elements(ratio, omega):
    """Jackson and Green (2005) with p_y = 2.8 S_y: within 9 %, ν = 0.25."""
    body = Body(radius=1e-3, youngs_modulus=200e9, poissons_ratio=0.25)
    pair = Pair(body, body)
    strength = ratio * pair.contact_modulus
    fit = JacksonGreen(pair.radius, pair.contact_modulus, strength, 0.25)
    depth = omega * float(fit.first_yield.indentation)
    h = math.sqrt(2 * pair.radius * depth) / 60
    contact = Contact(
        pair,
        smooth(Grid((151, 151), (h, h))),
        plasticity=ConstantBound(2.8 * strength),
    )
    force = float(fit.loading_force(depth))
    assert solve(contact, depth).force == approx(force, rel=0.09)
