"""One solve, compared with a dense solver, closed forms and the contact conditions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal

from contact_keys import contact_of, load, models_of
from restitution.contact.bodies import Body, Pair
from restitution.contact.contact import Contact, smooth
from restitution.contact.equilibrium import candidate_box
from restitution.contact.loading import solve, step
from restitution.contact.plasticity.bound import ConstantBound
from restitution.numerics.box import bounding_box
from restitution.numerics.grid import Grid
from restitution.surfaces import Surface
from tolerance import approx

UM, NM = 1e-6, 1e-9
E_STAR = 112e9
P_Y = 750e6
DEPTH = 40 * NM  # of the rough contacts: about 60 of 480 nodes touch, half of them at 750 MPa
LIMITS = pytest.mark.parametrize("p_y", [math.inf, 2e9, P_Y, 1e8])


def with_surface(contact, height, spacing=None):
    """The same bodies on a transformed surface."""
    grid = Grid(height.shape, spacing or contact.grid.spacing)
    return replace(contact, surface=Surface(height, grid))


# --- the solution -----------------------------------------------------------------------------


@LIMITS
@pytest.mark.parametrize("seed", [0, 1])
def test_it_is_the_dense_solution_on_the_whole_grid(rough_contact, dense, p_y, seed):
    """Cropping to {h₀ < δ} is exact, on a grid that is not square and has oblong cells."""
    contact = rough_contact((16, 13), (0.8 * UM, 0.9 * UM), seed=seed, yield_pressure=p_y)
    state = solve(contact, 30 * NM, residual=1e-11)
    p = dense.pressure(contact, 30 * NM)
    assert state.pressure[state.box].size < 0.8 * p.size  # something was cropped
    assert 5 < state.contact_nodes < 0.6 * p.size
    assert_allclose(state.pressure, p, atol=1e-7 * p.max())
    gap = dense.gap(contact, p, 30 * NM)
    plastic = np.where(p >= p_y, np.maximum(-gap, 0), 0.0)
    assert (plastic.max() > 0) == (p_y <= P_Y)
    assert_allclose(state.plastic_displacement, plastic, atol=1e-8 * 30 * NM)
    area = contact.grid.cell_area
    assert state.force == approx(p.sum() * area, rel=1e-7)
    u = gap - contact.gap + 30 * NM
    assert_allclose(state.box_displacement, u[state.box], atol=1e-8 * 30 * NM)
    assert state.stored_energy == approx(0.5 * (p * u).sum() * area, rel=1e-7)
    if p_y <= P_Y:
        assert state.plastic_work == approx(p_y * plastic.sum() * area, rel=1e-6)


@pytest.mark.parametrize("nm", [1, 30, 1000])
def test_the_candidate_box_holds_all_nodes_that_overlap(rough_contact, nm):
    contact = rough_contact((16, 13), (0.8 * UM, 0.9 * UM))
    box = candidate_box(contact, nm * NM)
    assert box == bounding_box(contact.gap < nm * NM)
    assert candidate_box(contact, 0.0) is None


@settings(deadline=None, max_examples=25)
@given(
    st.integers(0, 10_000),
    st.floats(0.1, 10),
    st.floats(-1, 0.5),
    st.floats(-9, 3),
    st.sampled_from([0.2, 1.0, 3.0, math.inf]),
)
def test_the_conditions_of_contact_hold_on_the_whole_grid(
    rough_contact, dense, seed, aspect, log_rms, log_scale, yield_factor
):
    """The cases include slender cells, sizes from nm to km, and small to large roughness."""
    h = 10.0**log_scale
    sphere = Body(250 * h, 1e9, 0.499)
    contact = rough_contact(
        (15, 12), (h, aspect * h), rms=0.02 * h * 10**log_rms, seed=seed, pair=Pair(sphere, sphere)
    )
    depth = 0.03 * h * min(1, aspect) ** 2
    scale = contact.pair.contact_modulus * math.sqrt(depth / contact.pair.radius)
    contact = replace(contact, **models_of(yield_pressure=yield_factor * 0.3 * scale))
    state = load(contact, depth, start=None, residual=1e-9)
    assert state.residual <= 1e-9
    assert (state.pressure >= 0).all()
    assert (state.pressure <= contact.hardness).all()
    assert dense.violation(contact, state.pressure, depth) <= 1.1e-9
    outside = np.ones(contact.grid.nodes, dtype=bool)
    outside[state.box] = False
    assert not state.pressure[outside].any()


@LIMITS
def test_the_residual_is_what_an_independent_check_finds(rough_contact, dense, p_y):
    contact = rough_contact(yield_pressure=p_y)
    for asked in (1e-3, 1e-6, 1e-9):
        state = solve(contact, DEPTH, residual=asked)
        assert state.residual <= asked
        assert dense.violation(contact, state.pressure, DEPTH) == approx(
            state.residual, rel=1e-3, abs=1e-13
        )


@pytest.mark.parametrize("nu", [-0.999, 0.0, 0.5])
def test_bodies_matter_through_their_modulus_only(rough_contact, nu):
    sphere = Body(500 * UM, 2 * E_STAR * (1 - nu**2), nu)
    contact = rough_contact(pair=Pair(sphere, sphere))
    assert contact.pair.contact_modulus == approx(E_STAR, rel=1e-12)
    assert solve(contact, DEPTH).force == approx(solve(rough_contact(), DEPTH).force, rel=1e-9)


def one_asperity(pair, **options):
    """A smooth sphere with a spike of one node on it, off the apex."""
    grid = Grid((9, 8), (0.5 * UM, 0.2 * UM))
    z = np.zeros(grid.nodes)
    z[3, 5] = 200 * NM
    return contact_of(pair, Surface(z, grid), **options)


SELF = 2 / (math.pi * E_STAR) * UM * (0.5 * math.asinh(0.4) + 0.2 * math.asinh(2.5))


def test_one_node_is_a_spring(pair):
    state = solve(one_asperity(pair), 10 * NM, residual=1e-13)
    assert state.contact_nodes == 1
    assert state.pressure[3, 5] == approx(10 * NM / SELF, rel=1e-12)  # u = K₀₀ p
    assert state.force == approx(10 * NM / SELF * 0.1 * UM**2, rel=1e-12)
    assert state.stored_energy == approx(0.5 * 10 * NM * state.force, rel=1e-12)
    assert state.plastic_volume == 0


def test_one_node_that_yields_is_a_spring_and_a_slider(pair):
    p_y = 0.3 * 10 * NM / SELF
    state = solve(one_asperity(pair, yield_pressure=p_y), 10 * NM)
    area = 0.1 * UM**2
    assert state.pressure[3, 5] == p_y
    assert state.force == approx(p_y * area, rel=1e-12)
    assert state.plastic_displacement[3, 5] == approx(7 * NM, rel=1e-12)
    assert state.stored_energy == approx(0.5 * p_y * 3 * NM * area, rel=1e-12)
    assert state.plastic_work == approx(p_y * 7 * NM * area, rel=1e-12)
    assert state.separation_indentation == approx(7 * NM, rel=1e-12)
    # unloading is that of a spring from 7 nm
    assert step(state, 8 * NM).force == approx(p_y * area / 3, rel=1e-7)


def test_two_nodes_share(pair):
    """Two spikes of heights 0 and −c: p₁ = [K₀δ − K₁(δ − c)]/(K₀² − K₁²), p₂ by symmetry."""
    grid = Grid((9, 9), (UM, UM))
    contact = Contact(pair, smooth(grid))
    z = contact.gap.copy() - 1 * UM  # flat, deep
    z[4, 3], z[4, 6] = contact.gap[4, 3], contact.gap[4, 6] - 2 * NM
    contact = Contact(pair, Surface(z, grid))

    def corner(X, Y):
        return X * math.asinh(Y / X) + Y * math.asinh(X / Y)

    K0 = 4 * corner(0.5 * UM, 0.5 * UM) / (math.pi * E_STAR)
    K1 = 2 * (corner(3.5 * UM, 0.5 * UM) - corner(2.5 * UM, 0.5 * UM)) / (math.pi * E_STAR)
    p = np.linalg.solve([[K0, K1], [K1, K0]], [10 * NM, 8 * NM])
    state = solve(contact, 10 * NM, residual=1e-12)
    assert_allclose(state.pressure[4, [3, 6]], p, rtol=1e-9)
    assert state.contact_nodes == 2
    # at a height difference of K₁/K₀ of the depth, the first spike takes the second out of contact
    alone = solve(contact, 2 * NM / (1 - 0.99 * K1 / K0))
    assert alone.contact_nodes == 1


# --- symmetries, bounds and limits ------------------------------------------------------------


@pytest.mark.parametrize("p_y", [math.inf, P_Y])
def test_turning_the_surface_turns_the_solution(rough_contact, p_y):
    """On grids with odd numbers of nodes a flip does not move the sphere."""
    contact = rough_contact((23, 19), (0.5 * UM, 0.6 * UM), yield_pressure=p_y)
    z = contact.surface.height
    p = solve(contact, DEPTH, residual=1e-11).pressure
    close = {"atol": 1e-7 * p.max()}
    for turn in (np.flipud, np.fliplr, lambda a: a[::-1, ::-1]):
        turned = solve(with_surface(contact, turn(z).copy()), DEPTH, residual=1e-11)
        assert_allclose(turned.pressure, turn(p), **close)
    across = solve(with_surface(contact, z.T.copy(), (0.6 * UM, 0.5 * UM)), DEPTH, residual=1e-11)
    assert_allclose(across.pressure, p.T, **close)
    fortran = solve(with_surface(contact, np.asfortranarray(z)), DEPTH, residual=1e-11)
    assert_allclose(fortran.pressure, p, **close)


def test_a_larger_grid_of_the_same_spacing_changes_nothing(pair):
    small, large = (
        solve(
            Contact(
                pair,
                smooth(Grid(nodes, (0.5 * UM, 0.4 * UM))),
                plasticity=ConstantBound(P_Y),
            ),
            DEPTH,
            residual=1e-11,
        )
        for nodes in ((20, 27), (35, 44))
    )
    assert large.force == approx(small.force, rel=1e-9)
    assert large.loading_work == approx(small.loading_work, rel=1e-9)
    assert large.contact_nodes == small.contact_nodes


@settings(deadline=None, max_examples=30)
@given(
    st.integers(0, 1000),
    st.floats(1, 40),
    st.floats(1.001, 1.5),
    st.sampled_from([math.inf, 3e9, P_Y, 1e8]),
)
def test_the_force_grows_with_depth_and_so_does_all_else(rough_contact, seed, nm, factor, p_y):
    contact = rough_contact(seed=seed, yield_pressure=p_y)
    a, b = (load(contact, d * NM, start=None, residual=1e-10) for d in (nm, factor * nm))
    assert b.force >= a.force * (1 - 1e-8)  # equal for a single node at p_y
    assert b.stored_energy >= a.stored_energy * (1 - 1e-8)
    assert b.plastic_work >= a.plastic_work * (1 - 1e-8)
    assert b.contact_nodes >= a.contact_nodes
    assert (b.plastic_displacement >= a.plastic_displacement - 1e-9 * nm * NM).all()
    # ∫F dδ of an increasing force lies between its lower and upper sums
    work = b.loading_work - a.loading_work
    width = (factor - 1) * nm * NM
    slack = 1e-7 * b.loading_work
    assert a.force * width - slack <= work <= b.force * width + slack


@settings(deadline=None, max_examples=15)
@given(st.integers(0, 1000), st.floats(1e-4, 3.0), st.sampled_from([math.inf, P_Y]))
def test_roughness_shifts_the_smooth_curve_by_no_more_than_its_height(
    rough_contact, seed, height, p_y
):
    """The roughness is nowhere above the smooth sphere and touches it at the apex."""
    rough = rough_contact((32, 30), seed=seed, yield_pressure=p_y)
    z = rough.surface.height - rough.surface.height.max()
    z *= height * NM / -z.min()
    z[16, 15] = 0.0
    bare = solve(with_surface(rough, np.zeros_like(z)), DEPTH).force
    less = solve(with_surface(rough, np.zeros_like(z)), DEPTH - height * NM).force
    bumpy = solve(with_surface(rough, z), DEPTH).force
    assert less * (1 - 1e-7) <= bumpy <= bare * (1 + 1e-7)


def test_a_soft_surface_carries_its_bearing_area(rough_contact):
    """For p_y → 0 the surface yields by the whole overlap, without elastic displacement."""
    p_y = 1e-6 * E_STAR
    contact = rough_contact(yield_pressure=p_y)
    state = solve(contact, DEPTH)
    overlap = np.maximum(DEPTH - contact.gap, 0)
    area = contact.grid.cell_area
    assert state.contact_nodes == approx(np.count_nonzero(overlap), abs=1)
    assert state.force == approx(p_y * state.contact_area, rel=1e-2)
    assert_allclose(state.plastic_displacement, overlap, atol=1e-3 * DEPTH)
    assert state.plastic_work == approx(p_y * overlap.sum() * area, rel=1e-3)


def test_a_hard_surface_is_elastic(rough_contact):
    elastic, hard = (solve(rough_contact(yield_pressure=p), DEPTH) for p in (math.inf, 1e20))
    assert_array_equal(hard.pressure, elastic.pressure)
    assert hard.plastic_work == elastic.plastic_work == 0
    assert not hard.plastic_displacement.any()


def test_plateaus_and_ties_are_nothing_special(pair, dense):
    """On terraces, equal spikes and a conforming flat many nodes touch at the same indentation."""
    grid = Grid((11, 10), (0.8 * UM, 0.8 * UM))
    bare = Contact(pair, smooth(grid)).gap
    x, y = grid.x[:, None] / UM, grid.y[None, :] / UM
    inside = np.hypot(x, y) < 3.0
    spikes = np.where((np.arange(11)[:, None] % 3 == 0) & (np.arange(10) % 3 == 0), 50 * NM, 0.0)
    for z in (
        np.where(inside, bare, bare - 1 * UM),  # a flat punch
        np.where(inside, bare + spikes, bare - 1 * UM),  # spikes of one height on it
        np.where(inside, 20 * NM * np.round(bare / (20 * NM)), bare - 1 * UM),  # terraces
    ):
        for p_y in (math.inf, 2e8):
            contact = Contact(pair, Surface(z, grid), plasticity=ConstantBound(p_y))
            state = solve(contact, 5 * NM, residual=1e-10)
            p = dense.pressure(contact, 5 * NM)
            assert_allclose(state.pressure, p, atol=1e-6 * p.max())


def test_indentations_far_below_and_above_the_roughness(rough_contact):
    smooth_force = solve(rough_contact((64, 60), rms=0), 400 * NM).force
    hardly = solve(rough_contact((64, 60), rms=0.01 * NM), 400 * NM)
    assert hardly.force == approx(smooth_force, rel=1e-3)
    barely = solve(rough_contact(rms=100 * NM), 1e-3 * NM)
    assert barely.contact_nodes == 1


# --- one solve or many steps ------------------------------------------------------------------


@pytest.mark.parametrize("p_y", [2e9, P_Y, 2e8])
def test_thirty_steps_are_one_solve(rough_contact, p_y):
    contact = rough_contact(yield_pressure=p_y)
    at_once = solve(contact, DEPTH, residual=1e-11)
    stepped = solve(contact, DEPTH / 30, residual=1e-11)
    for k in range(2, 31):
        stepped = step(stepped, DEPTH * k / 30, residual=1e-11)
    assert at_once.plastic_volume > 0
    assert_allclose(stepped.pressure, at_once.pressure, atol=1e-6 * p_y)
    assert_allclose(stepped.plastic_displacement, at_once.plastic_displacement, atol=1e-8 * DEPTH)
    assert stepped.force == approx(at_once.force, rel=1e-8)
    assert stepped.loading_work == approx(at_once.loading_work, rel=1e-7)
    assert stepped.plastic_work == approx(p_y * stepped.plastic_volume, rel=1e-9)


def test_back_and_forth_is_elastic_then_continues_on_the_virgin_curve(rough_contact):
    contact = rough_contact(yield_pressure=P_Y)
    tight = {"residual": 1e-11}
    deepest = solve(contact, DEPTH, **tight)
    back = step(deepest, 0.85 * DEPTH, **tight)
    assert 0 < back.force < 0.9 * solve(contact, 0.85 * DEPTH).force  # a hysteresis
    assert_array_equal(back.plastic_displacement, deepest.plastic_displacement)
    assert back.plastic_work == deepest.plastic_work
    again = step(back, DEPTH, **tight)
    assert_allclose(again.pressure, deepest.pressure, atol=1e-6 * P_Y)
    assert again.plastic_work == approx(deepest.plastic_work, rel=1e-8)
    beyond, virgin = step(again, 1.15 * DEPTH, **tight), solve(contact, 1.15 * DEPTH, **tight)
    assert beyond.force == approx(virgin.force, rel=1e-8)
    assert beyond.plastic_work == approx(virgin.plastic_work, rel=1e-8)
    assert beyond.plastic_work > 1.2 * deepest.plastic_work


def test_a_step_leaves_the_state_it_came_from(rough_contact):
    state = solve(rough_contact(yield_pressure=P_Y), DEPTH)
    pressure, plastic = state.pressure.copy(), state.plastic_displacement.copy()
    for depth in (0.5 * DEPTH, 1.2 * DEPTH, -DEPTH):
        step(state, depth)
        assert_array_equal(state.pressure, pressure)
        assert_array_equal(state.plastic_displacement, plastic)


@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_the_unloaded_surface_obeys_the_conditions_of_contact(rough_contact, dense, plasticity):
    contact = rough_contact(
        (16, 13), (0.8 * UM, 0.9 * UM), yield_pressure=P_Y, plasticity=plasticity
    )
    deepest = solve(contact, DEPTH)
    state = step(deepest, 0.9 * DEPTH, residual=1e-10)
    u_p = state.plastic_displacement
    assert 0 < state.force < deepest.force
    assert dense.violation(contact, state.pressure, 0.9 * DEPTH, plastic=u_p) <= 1.1e-10
    p = dense.pressure(contact, 0.9 * DEPTH, plastic=u_p)
    assert_allclose(state.pressure, p, atol=1e-7 * p.max())


@pytest.mark.parametrize("plasticity", ["equilibrium", "truncated"])
def test_the_bodies_part_at_the_lowest_point_of_the_worn_gap(rough_contact, plasticity):
    contact = rough_contact(yield_pressure=P_Y, plasticity=plasticity)
    deepest = solve(contact, DEPTH)
    parting = (contact.gap + deepest.plastic_displacement).min()
    assert 0 < parting < DEPTH
    assert deepest.separation_indentation == approx(parting, rel=1e-14)
    assert step(deepest, parting + 1e-4 * DEPTH).force > 0
    for depth in (parting, 0.99 * parting, 0.0, -DEPTH):
        apart = step(deepest, float(depth))
        assert apart.force == apart.stored_energy == apart.contact_nodes == 0
        assert apart.plastic_work == deepest.plastic_work
        assert apart.separation_indentation == deepest.separation_indentation
    if plasticity == "equilibrium":  # nodes that separated touch again
        assert step(apart, parting + 0.1 * (DEPTH - parting)).force > 0


def test_unloading_of_a_soft_flat_is_resolved(pair):
    """A flat yields by nearly all of δ: the elastic recovery is below 1e-5 of it."""
    grid = Grid((36, 27), (1 * UM, 4 * UM))
    bare = Contact(pair, smooth(grid)).gap
    inside = np.hypot(grid.x[:, None], grid.y[None, :]) < 12 * UM
    contact = Contact(
        pair,
        Surface(np.where(inside, bare, bare - 9 * UM), grid),
        plasticity=ConstantBound(1e-7 * E_STAR),
    )
    deepest = solve(contact, 1 * UM)
    spring = 1 * UM - deepest.separation_indentation
    assert spring < 1e-5 * UM
    state = step(deepest, 1 * UM - 1e-3 * spring)
    assert state.force < deepest.force
