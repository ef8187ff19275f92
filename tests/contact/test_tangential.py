"""Tangential boundary elements: one cell, closed forms of a sphere, energy, and theorems."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad, quad

from restitution import Body, Contact, Grid, Pair, smooth, solve, step
from restitution.contact.influence import (
    cerruti_displacement,
    love_displacement,
    shear_half_space,
)
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.tangential import shear
from restitution.errors import CaseError, NotConvergedError
from tolerance import approx

MU = 0.3
COMPLIANCES = 0.3, 0.5
UM = 1e-6


@pytest.mark.parametrize(("x", "y"), [(1.0, 0.0), (0.0, -1.2), (2.0, 1.0), (-1.0, 3.0), (9, -7)])
def test_one_cell_is_the_integral_of_the_point_force(x, y):
    def point(v, u):
        across, along = COMPLIANCES
        X, Y = x - u, y - v
        return (across * Y * Y + along * X * X) / math.hypot(X, Y) ** 3

    expected, _ = dblquad(point, -0.5, 0.5, -0.35, 0.35)
    assert cerruti_displacement(np.array(x), np.array(y), 1.0, 0.7, COMPLIANCES) == approx(
        expected, rel=1e-8
    )


def test_the_loaded_cell_itself():
    """In polar coordinates 1/r cancels; the rest is the distance to the edge in each direction."""
    across, along = COMPLIANCES

    def edge(angle):
        reach = min(0.5 / max(abs(math.cos(angle)), 1e-9), 0.35 / max(abs(math.sin(angle)), 1e-9))
        return (across * math.sin(angle) ** 2 + along * math.cos(angle) ** 2) * reach

    expected = 4 * quad(edge, 0, math.pi / 2, points=[math.atan2(0.35, 0.5)])[0]
    found = cerruti_displacement(np.array(0.0), np.array(0.0), 1.0, 0.7, COMPLIANCES)
    assert found == approx(expected, rel=1e-10)


@given(st.integers(-40, 40), st.integers(-40, 40), st.floats(0.3, 3))
def test_equal_compliances_are_those_of_normal_pressure(i, j, h):
    """1/r along both directions: Love's displacement under pressure, with α = 1/(πE*)."""
    x, y, E = np.array(float(i)), np.array(j * h), 2.5
    same = (1 / (math.pi * E),) * 2
    assert cerruti_displacement(x, y, 1.0, h, same) == approx(
        float(love_displacement(x, y, 1.0, h, E)), rel=1e-9
    )


@given(st.integers(0, 40), st.integers(0, 40), st.floats(0.3, 3))
def test_axes_can_be_swapped(i, j, h):
    x, y = np.array(float(i)), np.array(j * h)
    assert cerruti_displacement(x, y, 1.0, h, (0.2, 0.7)) == approx(
        float(cerruti_displacement(y, x, h, 1.0, (0.7, 0.2))), rel=1e-12
    )


def test_the_operator_is_the_sum_over_cells():
    rng, (nx, ny), (hx, hy) = np.random.default_rng(1), (7, 5), (0.4, 0.3)
    q = rng.normal(size=(nx, ny))
    i, j = np.arange(nx) * hx, np.arange(ny) * hy
    dx = i[:, None, None, None] - i[None, None, :, None]
    dy = j[None, :, None, None] - j[None, None, None, :]
    u = np.einsum("ijkl,kl->ij", cerruti_displacement(dx, dy, hx, hy, COMPLIANCES), q)
    found = shear_half_space((nx, ny), (hx, hy), COMPLIANCES)(q)
    assert np.abs(found - u).max() < 1e-13 * np.abs(u).max()


def test_the_mean_compliance_is_that_of_the_tangential_modulus():
    pair = Pair(Body(1e-3, 70e9, 0.2), Body(2e-3, 210e9, 0.35))
    assert sum(pair.shear_compliances) / 2 == approx(1 / (math.pi * pair.tangential_modulus))


def sphere(nodes=96, poissons_ratio=0.3, part=0.8):
    """A smooth sphere on a grid, whose contact radius is `part` of half the grid."""
    body = Body(500 * UM, 210e9, poissons_ratio, 7850)
    pair, size = Pair(body, body), 16 * UM
    a = part * size / 2
    state = solve(Contact(pair, smooth(Grid(nodes, size / nodes))), a**2 / pair.radius)
    return state, a


def largest_displacement(state, a):
    """The displacement (m) at which Cattaneo and Mindlin's contact slides."""
    return 3 * MU * state.force / (4 * state.contact.pair.tangential_modulus * a)


@pytest.mark.parametrize(("nodes", "error"), [(48, 6e-3), (192, 1.5e-3)])
@pytest.mark.parametrize("poissons_ratio", [0.0, 0.3, 0.5])
def test_a_circle_that_sticks_has_the_stiffness_2_a_g(nodes, error, poissons_ratio):
    """T/U = 2aG*, with 1/G* = Σ (2 − ν)/(4G): exact also if the traction along y is neglected,
    because the displacement of the stuck circle along y is zero (Johnson 1985, eq. 3.86)."""
    state, a = sphere(nodes, poissons_ratio)
    moved = shear(state, 1e-6 * a, 1e6)
    assert moved.sticking[moved.normal.pressure_on(moved.box) > 0].all()
    expected = 2 * a * state.contact.pair.tangential_modulus
    assert moved.force / moved.displacement == approx(expected, rel=error)


@pytest.mark.parametrize("poissons_ratio", [0.0, 0.45])
def test_partial_slip_is_that_of_cattaneo_and_mindlin(poissons_ratio):
    errors = []
    for nodes in (48, 96, 192):
        state, a = sphere(nodes, poissons_ratio)
        for part in (0.2, 0.5, 0.9):
            place = largest_displacement(state, a) * (1 - (1 - part) ** (2 / 3))
            moved = shear(state, place, MU)
            errors.append(moved.force / (part * MU * state.force) - 1)
            stuck = math.sqrt(moved.sticking.sum() * state.contact.grid.cell_area / math.pi)
            # The sticking circle is known to half a cell.
            assert abs(stuck - a * (1 - part) ** (1 / 3)) < 0.5 * state.contact.grid.spacing[0]
    coarse, medium, fine = np.abs(errors).reshape(3, 3).max(axis=1)
    assert coarse < 1e-3
    assert fine < 1e-4
    assert fine < medium < coarse


def loop(state, far, steps):
    """The states of a loop between ±far that begins at far."""
    path = far * np.concatenate(
        [np.linspace(0, 1, 9)[1:], np.cos(np.linspace(0, 2, steps + 1) * math.pi)]
    )
    moved = None
    for place in path:
        moved = shear(state, float(place), MU, history=moved)
        yield moved


def test_the_loop_loses_the_energy_of_mindlin_and_deresiewicz():
    part, errors = 0.6, []
    for nodes, steps in ((48, 32), (96, 64)):
        state, a = sphere(nodes)
        N, G = state.force, state.contact.pair.tangential_modulus
        far = largest_displacement(state, a) * (1 - (1 - part) ** (2 / 3))
        states = list(loop(state, far, steps))
        loss = (18 * (MU * N) ** 2 / (5 * a * G)) * (
            1 - (1 - part) ** (5 / 3) - 5 * part / 6 * (1 + (1 - part) ** (2 / 3))
        )
        errors.append(abs((states[-1].friction_loss - states[8].friction_loss) / loss - 1))
        # The loop closes, and the way there is twice Cattaneo and Mindlin's curve.
        assert states[-1].force == approx(states[8].force, rel=1e-4)
        middle = next(each for each in states[9:] if abs(each.displacement) < 1e-9 * far)
        share = 0.5 * far / largest_displacement(state, a)
        expected = states[8].force - 2 * MU * N * (1 - (1 - share) ** 1.5)
        assert middle.force == approx(expected, abs=2e-3 * states[8].force)
    assert errors[0] < 1e-2
    assert errors[1] < 0.3 * errors[0]


def wandering(contact, depths, places, friction=MU):
    """States of a path of depths (m) and tangential displacements (m)."""
    normal, moved = None, None
    for depth, place in zip(depths, places, strict=True):
        normal = solve(contact, depth) if normal is None else step(normal, depth)
        moved = shear(normal, place, friction, history=moved)
        yield moved


@settings(max_examples=8)
@given(st.integers(0, 1000), st.just(0.0) | st.floats(0.01, 1.5))
def test_work_is_stored_or_lost(rough_contact, seed, friction):
    rng = np.random.default_rng(seed)
    contact = rough_contact((36, 30), seed=seed, rms=20e-9, yield_pressure=3e9)
    depths = 60e-9 * rng.uniform(0.2, 1, 8)
    places = 20e-9 * rng.uniform(-1, 1, 8)
    work = loss = energy = place = force = 0.0
    for moved in wandering(contact, depths, places, friction):
        work += 0.5 * (moved.force + force) * (moved.displacement - place)
        place, force = moved.displacement, moved.force
        q = moved.box_traction
        pushed = moved.normal.pressure_on(moved.box)
        assert (np.abs(q) <= friction * pushed).all()
        loss, energy = moved.friction_loss, moved.stored_energy
        u = shear_half_space(q.shape, contact.grid.spacing, contact.pair.shear_compliances)(q)
        assert energy == approx(
            0.5 * float((q * u).sum()) * contact.grid.cell_area, rel=1e-6, abs=1e-20
        )
        assert work == approx(energy + loss, rel=1e-9, abs=1e-12 * 20e-9)


def test_slip_and_stick_obey_coulomb(rough_contact):
    contact = rough_contact(rms=20e-9)
    states = list(wandering(contact, [40e-9, 80e-9, 60e-9, 70e-9], [3e-9, 9e-9, 4e-9, 5e-9]))
    for before, after in pairwise(states):
        # The slip before the step, on all of the box after it.
        K = shear_half_space(
            contact.grid.nodes, contact.grid.spacing, contact.pair.shear_compliances
        )
        whole = np.zeros(contact.grid.nodes)
        whole[before.box] = before.box_traction
        slid = after.slip - (before.displacement - K(whole)[after.box])
        limit, q = MU * after.normal.pressure_on(after.box), after.box_traction
        scale = 1e-7 * np.abs(after.box_displacement).max()
        assert np.abs(slid[after.sticking]).max() < scale
        slips = (limit > 0) & ~after.sticking
        assert slips.any()
        assert (slid[slips] * np.sign(q[slips]) > -scale).all()


@pytest.mark.parametrize("yield_pressure", [math.inf, 3e9])
def test_bodies_without_poisson_effect_follow_the_difference_of_two_normal_states(
    rough_contact, pair, yield_pressure
):
    """Jäger (1995), Ciavarella (1998): with ν = 0, q = µ [p(δ) − p(δ*)] exactly, for any roughness.

    After yield, p(δ*) is a state of unloading."""
    body = Body(500 * UM, 210e9, 0.0, 7850)
    contact = rough_contact(pair=Pair(body, body), rms=20e-9, yield_pressure=yield_pressure)
    state = solve(contact, 80e-9)
    assert (state.plastic_work > 0) == math.isfinite(yield_pressure)
    for back in (10e-9, 30e-9):
        before = step(state, 80e-9 - back)
        moved = shear(state, MU * back, MU)  # G* = E*
        expected = MU * (state.pressure - before.pressure)[moved.box]
        assert np.abs(moved.box_traction - expected).max() < 1e-6 * state.pressure.max()
        assert moved.force == approx(MU * (state.force - before.force), rel=1e-6)


@pytest.mark.parametrize("seed", range(4))
def test_the_neglected_traction_changes_the_stiffness_by_less_than_one_per_cent(
    rough_contact, seed
):
    """Both components of the traction on the stuck nodes, as a dense system."""
    body = Body(500 * UM, 210e9, 0.45, 7850)
    contact = rough_contact((36, 30), pair=Pair(body, body), rms=40e-9, seed=seed)
    state = solve(contact, 60e-9)
    i, j = np.nonzero(state.pressure > 0)
    (hx, hy), (across, along) = contact.grid.spacing, contact.pair.shear_compliances
    x, y = hx * (i[:, None] - i), hy * (j[:, None] - j)
    # u_x due to q_y: the cell integral of (β − α) xy/r³, whose antiderivative is −r.
    cross = np.zeros(x.shape)
    for sx, sy in ((1, 1), (-1, -1), (1, -1), (-1, 1)):
        cross -= sx * sy * (along - across) * np.hypot(x + sx * hx / 2, y + sy * hy / 2)
    C = np.block(
        [
            [cerruti_displacement(x, y, hx, hy, (across, along)), cross],
            [cross, cerruti_displacement(x, y, hx, hy, (along, across))],
        ]
    )
    both = np.linalg.solve(C, np.repeat([1.0, 0.0], i.size))[: i.size].sum() * hx * hy
    stiffness = shear(state, 1e-12, 1e6).force / 1e-12
    assert stiffness < both * (1 + 1e-6)
    assert stiffness == approx(both, rel=1e-2)


def test_a_growing_contact_sticks_as_in_mindlin_and_deresiewicz():
    """Constant direction of a growing force within friction: T = ∫ 2aG* dU without slip."""
    state, _ = sphere(96)
    pair, contact = state.contact.pair, state.contact
    depths = state.indentation * np.linspace(0.02, 1, 50)
    slope = 0.5 * MU * pair.contact_modulus / pair.tangential_modulus
    *_, last = wandering(contact, depths, slope * depths)
    radius = np.sqrt(pair.radius * depths)
    expected = 2 * pair.tangential_modulus * slope * (2 / 3) * radius[-1] * depths[-1]
    assert last.force == approx(expected, rel=1e-2)
    assert last.friction_loss < 2e-3 * 0.5 * last.force * last.displacement


def test_full_slip_is_friction_times_the_normal_force(rough_contact):
    state = solve(rough_contact(), 70e-9)
    for sign in (1, -1):
        moved = shear(state, sign * 1e-5, MU)
        assert moved.force == approx(sign * MU * state.force, rel=1e-12)
        assert not moved.sticking.any()
        # From a state without force, the mean force is half of the last one.
        lost = 0.5 * abs(moved.force) * 1e-5 - moved.stored_energy
        assert moved.friction_loss == approx(lost, rel=1e-9)


def test_units_and_mirror(rough_contact):
    """Twice the modulus and pressure bound, or a reversed displacement: the same slip."""
    contact = rough_contact(rms=20e-9)
    state = solve(contact, 80e-9)
    moved, back = shear(state, 8e-9, MU), shear(state, -8e-9, MU)
    assert back.force == approx(-moved.force, rel=1e-9)
    bodies = [replace(body, youngs_modulus=420e9) for body in (contact.pair.first,) * 2]
    stiff = shear(solve(replace(contact, pair=Pair(*bodies)), 80e-9), 8e-9, MU)
    assert stiff.force == approx(2 * moved.force, rel=1e-7)
    assert (stiff.sticking == moved.sticking).all()


def test_bodies_out_of_contact_carry_no_force(rough_contact):
    contact = rough_contact()
    pressed = shear(solve(contact, 70e-9), 5e-9, MU)
    parted = step(pressed.normal, -10e-9)
    released = shear(parted, 5e-9, MU, history=pressed)
    assert released.force == 0
    assert released.stored_energy == 0
    assert released.friction_loss == approx(pressed.friction_loss + pressed.stored_energy, rel=1e-9)
    again = shear(parted, 7e-9, MU, history=released)
    assert again.force == 0
    assert again.friction_loss == released.friction_loss
    assert "0 of 0 nodes" in repr(again)


def test_bad_arguments_are_refused(rough_contact):
    state = solve(rough_contact(), 50e-9)
    with pytest.raises(CaseError, match="coefficient of friction"):
        shear(state, 1e-9, -0.1)
    with pytest.raises(CaseError, match="not a finite length"):
        shear(state, math.nan, 0.1)
    other = shear(solve(rough_contact(nodes=(20, 20)), 50e-9), 1e-9, MU)
    with pytest.raises(CaseError, match="on another grid"):
        shear(state, 1e-9, MU, history=other)
    adhesive = replace(state, contact=replace(state.contact, adhesion=JKRLimit(0.1)))
    with pytest.raises(CaseError, match="only without adhesion"):
        shear(adhesive, 1e-9, MU)
    with pytest.raises(NotConvergedError, match="tangential solve"):
        shear(state, 1e-9, MU, residual=1e-30)
