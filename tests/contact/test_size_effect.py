"""Small contacts are harder: cones, spheres, flat punches, patches that merge, rough contacts."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from restitution import (
    Body,
    ConstantBound,
    Contact,
    ExpandingCavity,
    Grid,
    Pair,
    SizedBound,
    Surface,
    collide,
    generate_surface,
    loading_path,
    smooth,
    solve,
    step,
    unloading_path,
)
from restitution.contact.checks.model_error import model_error
from restitution.contact.checks.resolution import resolves_contact
from restitution.contact.plasticity import size_effect
from restitution.contact.plasticity.size_effect import (
    BERKOVICH,
    dislocation_density,
    error_of_law,
    spread,
)
from restitution.contact.prescribed.force import solve_at_force
from restitution.errors import CaseError
from tolerance import approx

H0, STIFF = 1e9, 1e12
RATIOS = (0.1, 1.0, 10.0)


def indenter(depth_of, half_width, nodes, model, radius=math.inf):
    """A contact whose gap is `depth_of` the distance from the middle of the grid."""
    spacing = 2 * half_width / nodes
    grid = Grid((nodes, nodes), (spacing, spacing))
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    R = min(radius, 1e3 * half_width)
    surface = Surface(r**2 / (2 * R) - depth_of(r), grid)
    return Contact(Pair(Body(R, 1e6 * STIFF, 0.0), Body(math.inf, STIFF, 0.0)), surface, model)


def cone(tangent, depth, model, nodes=64):
    return indenter(lambda r: tangent * r, 1.3 * depth / tangent, nodes, model)


@pytest.mark.parametrize("tangent", [BERKOVICH, 0.15])
@pytest.mark.parametrize("ratio", RATIOS)
def test_a_cone_follows_nix_and_gao(tangent, ratio):
    """The density of dislocations, and so h*, is proportional to tan²θ."""
    depth = 0.2e-6
    length = depth / ratio
    contact = cone(tangent, depth, SizedBound(H0, length * (BERKOVICH / tangent) ** 2))
    state = solve(contact, depth)
    sunk = tangent * math.sqrt(state.contact_area / math.pi)
    law = H0 * math.sqrt(1 + length / sunk)
    assert state.force / state.contact_area == approx(law, rel=0.03)


@pytest.mark.parametrize("ratio", RATIOS)
def test_the_work_on_a_cone_is_the_integral_of_the_law(ratio):
    depth = 0.2e-6
    length = depth / ratio

    def force(h):
        return H0 * math.sqrt(1 + length / h) * math.pi * (h / BERKOVICH) ** 2

    state = solve(cone(BERKOVICH, depth, SizedBound(H0, length)), depth)
    assert state.loading_work == approx(quad(force, 0, depth)[0], rel=0.025)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("depth", [5e-9, 20e-9])
def test_a_sphere_is_as_hard_at_every_depth(ratio, depth):
    """H = H₀ √(1 + R*/R) with R* = 2 h*/(3 tan²θ) (Swadener, George and Pharr 2002)."""
    R = 1e-6
    length = 1.5 * BERKOVICH**2 * R / ratio
    half = 1.3 * math.sqrt(2 * R * depth)
    contact = indenter(lambda r: r**2 / (2 * R), half, 64, SizedBound(H0, length), R)
    state = solve(contact, depth)
    law = H0 * math.sqrt(1 + 1 / ratio)
    assert state.force / state.contact_area == approx(law, rel=0.05)


def test_a_flat_punch_hardens_with_its_depth():
    """The density is 3h/(ba²)."""
    a, densities = 1e-6, []
    for depth in (0.05e-6, 0.2e-6):
        contact = indenter(lambda r: np.where(r <= a, 0, 10 * a), 1.5 * a, 96, SizedBound(H0, a))
        hardness = solve(contact, depth).force / (math.pi * a**2)
        densities.append(((hardness / H0) ** 2 - 1) * 1.5 * BERKOVICH**2 / a)
        law = H0 * math.sqrt(1 + 3 * depth / a / (1.5 * BERKOVICH**2))
        assert hardness == approx(law, rel=0.05)
    assert densities[1] / densities[0] == approx(4, rel=0.1)


def bumps(distance, model, nodes=80):
    """Two spherical bumps whose middles are `distance` (m) apart."""
    grid = Grid((nodes, nodes), (10e-9, 10e-9))
    x, y = grid.x[:, None], grid.y[None, :]
    height = np.maximum.reduce(
        [-((x - sign * distance / 2) ** 2 + y**2) / 2e-6 for sign in (-1, 1)]
    )
    body = Body(1e-3, STIFF, 0.0)
    return Contact(Pair(body, body), Surface(height, grid), model)


def test_patches_that_merge_soften_without_a_jump():
    """Their own density at first touch; that of one patch when the dip between them is gone."""
    bound = []
    for distance in np.linspace(0, 0.3e-6, 61):
        contact = bumps(float(distance), SizedBound(H0, 0.4e-6))
        limit, _ = contact.plasticity.bound(contact, 5e-9, 1e-8)
        bound.append(float(limit[contact.gap < 5e-9].mean()))
    single = H0 * math.sqrt(1 + 0.4e-6 / (1.5 * BERKOVICH**2 * 1e-6))
    assert bound[0] == approx(single, rel=0.02)
    assert bound[-1] == approx(single, rel=0.02)
    assert min(bound) < 0.97 * single
    assert np.abs(np.diff(bound)).max() < 0.03 * single


def rough(model, seed=3, scale=1.0, nodes=48, rms=10e-9):
    h = 0.2e-6 * scale
    grid = Grid((nodes, nodes), (h, h))
    surface = generate_surface(
        grid, kind="gaussian", rms=rms * scale, correlation_length=8 * h, seed=seed
    )
    body = Body(500e-6 * scale, 210e9, 0.3, 7850.0)
    return Contact(Pair(body, body), surface, model)


def models(length):
    constant = SizedBound(0.8e9, length) if length else ConstantBound(0.8e9)
    return constant, ExpandingCavity(0.3e9, size_effect=length)


DEEP = 30e-9


def test_without_length_the_models_are_those_without_size_effect():
    tiny = [solve(rough(model), DEEP) for model in models(1e-30)]
    none = [solve(rough(model), DEEP) for model in models(0.0)]
    for one, other in zip(tiny, none, strict=True):
        assert np.array_equal(one.box_pressure, other.box_pressure)
        assert np.array_equal(one.plastic_displacement, other.plastic_displacement)
        assert one.stored_energy == other.stored_energy
    assert tiny[1].plastic_work == none[1].plastic_work
    assert tiny[0].plastic_work == approx(none[0].plastic_work, rel=1e-9)
    assert tiny[0].work_error == approx(0, abs=1e-9 * tiny[0].plastic_work)


@pytest.mark.parametrize("kind", [0, 1])
def test_restitution_rises_with_the_length(kind):
    e = [
        collide(solve(rough(models(length)[kind]), DEEP)).restitution
        for length in (0.0, 0.05e-6, 0.4e-6, 3e-6)
    ]
    assert np.all(np.diff(e) > 1e-4)


@pytest.mark.parametrize("kind", [0, 1])
@pytest.mark.parametrize("scale", [1e-3, 7.0])
def test_lengths_scale_out(kind, scale):
    e = [
        collide(solve(rough(models(0.4e-6 * s)[kind], scale=s), DEEP * s)).restitution
        for s in (1.0, scale)
    ]
    assert e[1] == approx(e[0], rel=1e-6)


@pytest.mark.parametrize("seed", range(1, 4))
@pytest.mark.parametrize("kind", [0, 1])
def test_the_energies_add_up(kind, seed):
    """The force over the depth gives the loading work, and unloading the stored energy."""
    contact = rough(models(0.4e-6)[kind], seed=seed)
    depths = DEEP * np.geomspace(0.05, 1, 40)
    states = list(loading_path(contact, depths))
    force = np.array([state.force for state in states])
    power = np.diff(np.log(force)) / np.diff(np.log(depths))
    outside = states[0].loading_work + float(np.sum(np.diff(force * depths) / (power + 1)))
    deepest = solve(contact, DEEP)
    assert deepest.loading_work == approx(outside, rel=0.004)
    assert deepest.work_error < 0.02 * outside
    assert np.all(np.diff(force) > 0)
    assert np.all(np.diff([state.plastic_work for state in states]) >= 0)
    assert np.all(np.diff([state.plastic_displacement for state in states], axis=0) >= 0)
    path = list(unloading_path(deepest))
    at, F = (np.array([getattr(s, name) for s in path]) for name in ("indentation", "force"))
    returned = -float(np.sum(0.5 * (F[1:] + F[:-1]) * np.diff(at)))
    assert returned == approx(deepest.stored_energy, rel=0.005)


@pytest.mark.parametrize("kind", [0, 1])
def test_deformed_bodies_load_as_undeformed_ones(kind):
    contact = rough(models(0.4e-6)[kind])
    once = solve(contact, DEEP)
    state = solve(contact, 0.3 * DEEP)
    for depth in DEEP * np.linspace(0.4, 1, 5):
        state = step(state, float(depth))
    assert state.force == approx(once.force, rel=1e-6)
    assert state.stored_energy == approx(once.stored_energy, rel=1e-6)
    assert state.loading_work == approx(once.loading_work, rel=0.02)


def test_nodes_without_patch_take_the_bound_of_the_nearest():
    contact = rough(SizedBound(0.8e9, 0.4e-6))
    limit, _ = contact.plasticity.bound(contact, DEEP, 1e-8)
    assert limit.shape == contact.grid.nodes
    assert limit.min() > 0.8e9
    none, _ = contact.plasticity.bound(contact, 0.0, 1e-8)
    assert np.all(none == 0.8e9)


def test_density_of_hertz_is_its_curvature():
    contact = replace(rough(SizedBound(0.8e9, 1e-6)), surface=smooth(Grid((80, 80), (2e-7, 2e-7))))
    R, E, depth = contact.pair.radius, contact.pair.contact_modulus, 0.1e-6
    x, y = contact.grid.x[:, None], contact.grid.y[None, :]
    pressure = 2 * E / (math.pi * R) * np.sqrt(np.maximum(2 * depth * R - x**2 - y**2, 0))
    density = dislocation_density(contact, pressure)
    assert density.max() == approx(1 / R, rel=0.01)
    assert density[pressure > 0].min() == approx(density.max(), rel=1e-9)


@pytest.mark.parametrize("length", [-1e-6, math.nan, math.inf, 0.0])
def test_impossible_lengths_are_refused(length):
    with pytest.raises(CaseError, match=r"size_effect: .* is not positive and finite"):
        SizedBound(1e9, length)


@pytest.mark.parametrize("radius", [2e-6, 1e-3])
@pytest.mark.parametrize("model", [SizedBound(1e9, 1e-6), ExpandingCavity(0.4e9, 1e9, 1e-6)])
def test_smooth_spheres_yield_as_those_without_size_effect_that_are_harder(model, radius):
    half, depth = 0.3 * radius, 0.02 * radius
    contact = indenter(lambda r: r**2 / (2 * radius), half, 80, model, radius)
    assert contact.pair.radius == approx(radius, rel=1e-12)
    harder = replace(contact, plasticity=model.of_smooth(contact.pair))
    assert harder.plasticity.hardness == approx(
        model.hardness * math.sqrt(1 + 1e-6 / (1.5 * BERKOVICH**2 * radius)), rel=1e-12
    )
    one, other = (collide(solve(each, depth)) for each in (contact, harder))
    assert one.restitution == approx(other.restitution, rel=0.01)
    assert one.loading_work == approx(other.loading_work, rel=0.01)


def test_a_surface_harder_than_its_bulk_carries_more_than_the_bulk_would():
    """The whole grid yields; the bound of large contacts is no limit of the force."""
    contact = indenter(lambda r: np.where(r <= 1e-7, 0, 1e-6), 0.12e-6, 32, SizedBound(H0, 1e-6))
    capacity = H0 * contact.grid.cell_area * 32**2
    state = solve_at_force(contact, 1.2 * capacity)
    assert state.force == approx(1.2 * capacity, rel=1e-4)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", [0, 1])
def test_any_force_is_met(kind, seed):
    contact = rough(models(0.4e-6)[kind], seed=seed)
    force = 0.77 * solve(contact, DEEP).force
    assert solve_at_force(contact, force).force == approx(force, rel=1e-4)


LENGTHS = (0.02e-6, 0.1e-6, 0.5e-6, 3e-6)


def test_the_error_of_the_law_grows_with_h_star_over_the_depth():
    depth = np.geomspace(5e-9, 50e-6, 60)
    error = np.array([error_of_law(length, 1 / depth) for length in (0.0, *LENGTHS)])
    assert np.all(error[0] == 0)
    assert np.all(np.diff(error, axis=0) > 0)
    assert np.all(np.diff(error[1:], axis=1) < 0)
    assert np.all(error[:, -1] < 0.13 * np.array([0.0, *LENGTHS]) / 50e-6 + 1e-5)
    assert error.max() < 1


def test_the_largest_density_bounds_the_hardness():
    """The mean of the density of a cone, tan θ/(br) but at most ρ, over a hemisphere."""
    for depth in (30e-9, 100e-9, 250e-9):
        r = np.linspace(0, depth, 20001)[1:]
        local = np.minimum(1 / r, 1 / 100e-9)
        kept = np.average(local, weights=r**2) / np.average(1 / r, weights=r**2)
        x = 1e6  # far above the scatter of h*
        softer = 1 - math.sqrt((1 + x * kept) / (1 + x))
        known = float(error_of_law(x * depth, np.array(1 / depth)))
        assert known == approx(math.hypot(softer, 0.13), rel=1e-3)


@pytest.mark.parametrize("kind", [0, 1])
def test_the_model_error_includes_that_of_the_law(kind):
    def error(length):
        state = solve(rough(models(length)[kind]), DEEP)
        off = state.contact.plasticity.hardness_error(state)
        return off, model_error(state, collide(state).restitution)

    assert error(0.0)[0] == 0.0
    assert error(1e-30)[1] == approx(error(0.0)[1], rel=1e-9)
    by_law, whole = np.transpose([error(length) for length in (0.0, *LENGTHS)])
    assert np.all(np.diff(by_law) > 0)
    assert np.all(whole[1:] > whole[0])


@pytest.mark.parametrize("kind", [0, 1])
@pytest.mark.parametrize("length", [0.0, 0.4e-6])
def test_the_error_of_the_law_takes_no_solve(kind, length, monkeypatch):
    """The bound has found the density; without a size effect, none is needed."""
    *_, state = loading_path(rough(models(length)[kind]), [0.75 * DEEP, DEEP])
    monkeypatch.setattr(size_effect, "elastic_pressure", None)
    assert (state.contact.plasticity.hardness_error(state) > 0) == (length > 0)


@pytest.mark.parametrize("depth", [1.0, 0.1])
def test_the_error_of_the_law_grows_on_sharper_asperities(depth):
    """The same contact at another scale, with the same h*, has other h*/depth."""
    shares = []
    for scale in (10.0, 1.0):
        state = solve(rough(models(0.4e-6)[0], scale=scale), depth * DEEP * scale)
        shares.append(state.contact.plasticity.hardness_error(state))
    assert 0 < shares[0] < shares[1]


@pytest.mark.parametrize("periodic", [False, True])
def test_a_patch_that_begins_to_touch_moves_no_density_by_a_jump(periodic):
    """Its own density begins at zero, that of the other patch is 1."""
    pressure, density = np.zeros((2, 20, 24))
    pressure[8:12, 4:9], density[8:12, 4:9] = 1.0, 1.0
    before = spread(density, pressure, periodic=periodic)
    assert before == approx(np.ones_like(before), rel=1e-6)
    for small in (1e-4, 1e-7, 1e-10):
        pressure[10, 14] = density[10, 14] = small
        change = np.abs(spread(density, pressure, periodic=periodic) - before)
        near = change[7:13, 2:13]
        assert near.max() < 300 * small
    assert change.max() < 1e-3


@pytest.mark.parametrize(
    ("nodes", "waves", "seed", "length", "depths"),
    [
        (80, (0.2e-6, 4.8e-6), 368, 0.4e-6, (38e-9, 50e-9)),
        (78, (0.1e-6, 1.2e-6), 366, 0.05e-6, (18e-9, 26e-9)),
    ],
)
def test_the_force_rises_with_the_depth_where_patches_merge(nodes, waves, seed, length, depths):
    """Of 200 random contacts those with the largest falls (evidence/size_effect/monotone.csv)."""
    grid = Grid((nodes, nodes), (waves[0], waves[0]))
    surface = generate_surface(
        grid, kind="exponential", rms=30e-9, correlation_length=waves[1], seed=seed
    )
    body = Body(50e-6, 210e9, 0.3, 7850.0)
    contact = Contact(Pair(body, body), surface, SizedBound(0.3e9, length))
    states = [solve(contact, float(depth)) for depth in np.geomspace(*depths, 10)]
    change = np.diff(np.log([state.force for state in states]))
    resolved = [resolves_contact(state) for state in states[1:]]
    assert np.all(change[resolved] > 0)
    assert np.all(change > -0.005)
