import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from restitution.contact.contact import Contact, smooth
from restitution.contact.loading import solve, step
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.prescribed import force as prescribed_force
from restitution.contact.prescribed.force import solve_at_force
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from tolerance import approx

UM, NM = 1e-6, 1e-9
P_Y = 750e6
MODELS = [(np.inf, "equilibrium"), (P_Y, "equilibrium"), (2e8, "equilibrium"), (P_Y, "truncated")]
R, E_STAR = 250 * UM, 112e9


@pytest.mark.parametrize("rms", [0.0, 10 * NM])
@pytest.mark.parametrize(("p_y", "plasticity"), MODELS)
def test_the_force_is_met_and_the_depth_found(rough_contact, rms, p_y, plasticity):
    contact = rough_contact(rms=rms, yield_pressure=p_y, plasticity=plasticity)
    known = solve(contact, 40 * NM, residual=1e-10)
    found = solve_at_force(contact, known.force)
    assert found.force == approx(known.force, rel=1e-8)
    assert found.indentation == approx(known.indentation, rel=1e-7)
    assert_allclose(found.pressure, known.pressure, atol=1e-5 * known.pressure.max())
    assert found.loading_work == approx(known.loading_work, rel=2e-5)
    assert found.residual <= 1e-9
    assert found.convolutions > known.convolutions


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 1000), st.floats(-4, 0), st.sampled_from(MODELS[:3]))
def test_any_force_is_met(rough_contact, seed, decades, model):
    """The forces go down to one yielding node, where a range of depths has the same force."""
    contact = rough_contact((36, 30), seed=seed, yield_pressure=model[0])
    force = 5e-3 * 10**decades
    state = solve_at_force(contact, force)
    assert state.force == approx(force, rel=1e-8)
    assert state.force == approx(solve(contact, state.indentation, residual=1e-11).force, rel=1e-7)


def test_smooth_spheres_sink_as_hertz_says(pair):
    """With 64 nodes over 10.2 um, 25 per contact radius, the error is 0.2 %."""
    contact = Contact(pair, smooth(Grid((64, 64), (0.16 * UM, 0.16 * UM))))
    depth = (4 * UM) ** 2 / R
    force = 4 / 3 * E_STAR * np.sqrt(R) * depth**1.5
    state = solve_at_force(contact, force)
    assert state.indentation == approx(depth, rel=2e-3)
    assert state.contact_area == approx(np.pi * R * depth, rel=2e-2)


@pytest.mark.parametrize("factor", [1e-3, 0.5, 1.0, 1.7])
@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_any_state_may_be_the_start(rough_contact, factor, plasticity):
    contact = rough_contact(yield_pressure=P_Y, plasticity=plasticity)
    cold = solve_at_force(contact, 5e-3)
    start = solve(contact, factor * cold.indentation)
    warm = solve_at_force(contact, 5e-3, start=start)
    assert warm.force == approx(5e-3, rel=1e-8)
    assert warm.indentation == approx(cold.indentation, rel=1e-7)
    assert warm.loading_work == approx(cold.loading_work, rel=5e-5)


def test_the_force_loads_the_undeformed_bodies_whatever_the_start(rough_contact):
    contact = rough_contact(yield_pressure=P_Y)
    cold = solve_at_force(contact, 5e-3)
    worn = step(solve(contact, 1.2 * cold.indentation), 0.5 * cold.indentation)
    assert solve_at_force(contact, 5e-3, start=worn).indentation == approx(
        cold.indentation, rel=1e-7
    )


def test_a_force_on_the_plateau_of_one_yielded_node_has_a_depth(pair):
    grid = Grid((33, 33), (0.25 * UM, 0.25 * UM))
    z = np.zeros(grid.nodes)
    z[16, 16] = 100 * NM
    contact = Contact(pair, Surface(z, grid), plasticity=ConstantBound(P_Y))
    one = P_Y * grid.cell_area
    depths = []
    for force in (0.9 * one, one, 1.1 * one):
        state = solve_at_force(contact, force)
        assert state.force == approx(force, rel=1e-8)
        depths.append(state.indentation)
    assert depths[0] < 5 * NM < 90 * NM < depths[2]


@pytest.mark.parametrize("force", [0.0, -1.0, np.nan, np.inf])
def test_a_force_that_is_none_is_refused(rough_contact, force):
    with pytest.raises(CaseError, match=r"^force: .*is not positive"):
        solve_at_force(rough_contact(), force)


@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_more_than_the_grid_carries_is_refused_at_once(rough_contact, plasticity):
    contact = rough_contact(yield_pressure=P_Y, plasticity=plasticity)
    capacity = P_Y * 24 * 20 * 0.3 * UM**2  # 0.108 N
    for force in (1.0001 * capacity, 2 * capacity):
        with pytest.raises(DomainError) as refusal:
            solve_at_force(contact, force)
        assert f"force: {force:.4g} N" in str(refusal.value)
        assert "(0.108 N); use a larger grid or a smaller force" in str(refusal.value)
    with pytest.raises(DomainError, match="reaches the edge"):
        solve_at_force(contact, 0.999 * capacity)


def test_an_elastic_contact_that_reaches_the_edge_is_refused(rough_contact):
    with pytest.raises(DomainError, match="reaches the edge"):
        solve_at_force(rough_contact(), 1.0)


def test_a_force_that_is_missed_is_reported_with_how_far(rough_contact, monkeypatch):
    def jumps(*arguments, **options):
        state = solve(*arguments, **options)
        return replace(state, box_pressure=1.25 * state.box_pressure)

    found = solve_at_force(rough_contact(), 5e-3)
    monkeypatch.setattr(prescribed_force, "solve", jumps)
    depth = re.escape(f"{1e9 * found.indentation:.6g}")
    message = rf"^force: 0\.005 N .* error of 2\.5e-01, at an indentation of {depth} nm, because"
    with pytest.raises(NotConvergedError, match=message):
        solve_at_force(rough_contact(), 5e-3)
