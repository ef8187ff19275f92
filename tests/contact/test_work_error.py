"""The error of the loading work of an adhesive contact."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from contact_keys import load
from restitution import Body, Contact, Grid, Pair, generate_surface, smooth, solve
from restitution.case.models import adhesion_of
from restitution.contact.jkr import limit
from restitution.contact.jkr import loading_work as adhesive_work
from restitution.contact.plasticity import truncated
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.cavity import ExpandingCavity
from restitution.contact.plasticity.truncated import Truncated
from tolerance import approx

BODY = Body(1e-3, 420e9, 0.3, 7850.0)
PAIR = Pair(BODY, BODY)
DEPTH = 3e-8


def adhesive(seed, approach="equilibrium"):
    grid = Grid((40, 40), (0.4e-6, 0.4e-6))
    shape = {"kind": "gaussian", "rms": 1e-8, "correlation_length": 2e-6}
    surface = generate_surface(grid, seed=seed, **shape)
    return Contact(
        PAIR,
        surface,
        plasticity=ConstantBound(3e9),
        adhesion=adhesion_of(work_of_adhesion=1.0, approach=approach),
    )


def test_it_holds_where_the_grid_pins_the_edge_of_the_contact():
    """Compared with 240 steps from first touch, on a grid that does not resolve the adhesion."""
    contact = adhesive(9)
    state = solve(contact, DEPTH)
    depths, forces, start = np.linspace(0, DEPTH, 241), [], None
    for depth in depths:
        start = load(contact, float(depth), start=start, residual=1e-6)
        forces.append(start.force)
    assert abs(np.trapezoid(forces, depths) - state.loading_work) <= state.work_error


@pytest.mark.parametrize(("approach", "share"), [("equilibrium", 0.02), ("pull-increments", 0.006)])
def test_pinning_adds_a_share_of_the_surface_energy(monkeypatch, approach, share):
    """0.02 and 0.006 of w times the area sufficed in 93 % of 29 and in 11 of 11 contacts."""
    quadrature = adhesive_work.integrate_adaptively
    monkeypatch.setattr(
        adhesive_work, "integrate_adaptively", lambda *args, **kw: (quadrature(*args, **kw)[0], 0.0)
    )
    monkeypatch.setattr(adhesive_work, "balance_of", lambda state: (state.indentation, 0.0))
    state = solve(adhesive(1, approach), DEPTH)
    assert state.work_error == approx(share * 1.0 * state.contact_area, rel=1e-9)


def test_it_holds_all_that_the_quadrature_says(monkeypatch):
    quadrature, said = adhesive_work.integrate_adaptively, []

    def listened(*args, **options):
        scale = 0.5 * (args[3] + args[4]) * (args[2] - args[1])
        assert 0 < args[5] <= 1.5e-3 * 2 * scale
        said.append(quadrature(*args, **options))
        return said[-1]

    monkeypatch.setattr(adhesive_work, "integrate_adaptively", listened)
    state = solve(adhesive(1, "pull-increments"), DEPTH)
    assert len(said) == 1
    expected = said[0][1] + 0.006 * state.contact_area
    assert state.work_error == approx(expected, rel=1e-9)


def test_a_cut_adds_ten_tolerances(monkeypatch):
    """Errors reached nine tolerances in validation contacts, whatever the quadrature stated."""
    quadrature, asked = truncated.integrate_adaptively, []

    def without_error(*args, **options):
        asked.append(args[5])
        return quadrature(*args, **options)[0], 0.0

    monkeypatch.setattr(truncated, "integrate_adaptively", without_error)
    grid = Grid((40, 40), (0.4e-6, 0.4e-6))
    contact = Contact(PAIR, smooth(grid), plasticity=Truncated(1e9))
    state = solve(contact, DEPTH)
    assert state.work_error == approx(10 * asked[0], rel=1e-9)
    assert asked[0] > 0


def test_increments_add_parts_of_what_the_growth_of_the_bound_adds():
    """The error is 1/10 for nodes that had yielded before and 1/4 for nodes that begin to yield."""
    grid = Grid((64, 64), (0.5e-6, 0.5e-6))
    contact = Contact(PAIR, smooth(grid), plasticity=ExpandingCavity(1e9))
    before = solve(contact, 1.5e-7)
    after = solve(contact, 2e-7, start=before)
    given = after.plastic_displacement - before.plastic_displacement
    growth = given * (after.bound - before.bound) * grid.cell_area
    old = before.plastic_displacement > 0
    added = 0.1 * abs(growth[old].sum()) + 0.25 * abs(growth[~old].sum())
    assert growth[old].sum() > 0 < growth[~old].sum()
    assert after.work_error - before.work_error == approx(added, rel=1e-9)


@pytest.mark.parametrize("unit", [1.0, 1e-9])
@pytest.mark.parametrize("after", [None, 0.4])
def test_a_quadrature_of_balances_adds_half_as_much_again_as_every_second_depth_changes(
    monkeypatch, after, unit
):
    """A force with a kink. The depths are first + (last − first) t^1.5, in twice as many parts."""
    asked = []

    def at(depth):
        force = max(depth / unit, 2 * depth / unit - 0.5)
        state = SimpleNamespace(indentation=depth, force=force, loading_work=0.25 * unit)
        state.contact, state.convolutions = None, 1
        return state

    def load(_, depth, _before):
        asked.append(depth)
        return at(depth)

    monkeypatch.setattr(adhesive_work, "balance_of", lambda state: (state.indentation, state.force))
    start = None if after is None else at(after * unit)
    work, error, solves = adhesive_work.work_by_balance(at(unit), start, load, 2e-3)
    first = after or 0.0
    depths = np.array(sorted({*asked, first * unit, unit})) / unit
    parts = depths.size - 1
    assert parts == (16 if after is None else 8)
    assert solves == len(asked)
    assert depths == approx(first + (1 - first) * (np.arange(parts + 1) / parts) ** 1.5)
    value, coarse = (
        CubicSpline(x, np.maximum(x, 2 * x - 0.5)).integrate(first, 1.0)
        for x in (depths, depths[::2])
    )
    assert work == approx(unit * (value + (0.25 if after else 0.0)))
    assert error == approx(1.5 * unit * abs(value - coarse), rel=1e-6)


def test_the_error_of_a_start_counts_once(monkeypatch):
    """Pinning counts at the last depth only, and the quadrature from the start on."""
    monkeypatch.setattr(adhesive_work, "integrate_adaptively", lambda *_, **__: (0.0, 3e-16))
    contact = adhesive(1, "pull-increments")
    first = solve(contact, 0.5 * DEPTH)
    second = solve(contact, DEPTH, start=first)
    pinned = [0.006 * state.contact_area for state in (first, second)]
    assert first.work_error == approx(3e-16 + pinned[0], rel=1e-9)
    assert second.work_error == approx(6e-16 + pinned[1], rel=1e-9)


def test_pinning_adds_to_the_quadrature_of_balances_once(monkeypatch):
    monkeypatch.setattr(limit, "balances_are_reliable", lambda _: True)
    monkeypatch.setattr(limit, "work_by_balance", lambda *_: (1e-12, 3e-16, 0))
    contact = adhesive(1)
    first = solve(contact, 0.5 * DEPTH)
    second = solve(contact, DEPTH, start=first)
    pinned = [0.02 * state.contact_area for state in (first, second)]
    assert first.work_error == approx(3e-16 + pinned[0], rel=1e-9)
    assert second.work_error == approx(6e-16 + pinned[1], rel=1e-9)
    assert pinned[0] > 0


def test_a_short_step_has_at_most_the_error_of_any_growing_force(monkeypatch):
    """No state is loaded between both, and a force that jumps at either end is within the error."""
    monkeypatch.setattr(adhesive_work, "balance_of", lambda state: (state.indentation, state.force))
    start, end = (
        SimpleNamespace(indentation=x, force=F, loading_work=1e-13, contact=None)
        for x, F in ((1.00e-8, 2.0e-5), (1.01e-8, 2.1e-5))
    )
    work, error, convolutions = adhesive_work.work_by_balance(end, start, lambda *_: None, 0.1)
    assert convolutions == 0
    assert work - error == approx(1e-13 + 2.0e-5 * 1e-10)
    assert work + error == approx(1e-13 + 2.1e-5 * 1e-10)
