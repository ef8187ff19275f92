"""Waves below the grid: the law of periodic patches, and the contact under this law."""

import math
from dataclasses import replace

import numpy as np
import pytest

import restitution as rs
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.loading import step
from restitution.contact.patch import attraction, repulsion, stored
from restitution.contact.patch.attraction import AttractionTable
from restitution.contact.patch.blocks import (
    BlockLaw,
    BlockTables,
    block_means,
    displacement_of,
    levers,
)
from restitution.contact.patch.growth import PatchBounds
from restitution.contact.patch.law import PatchAttraction, PatchRepulsion, flat
from restitution.contact.patch.repulsion import PatchCurve, RepulsionTable
from restitution.errors import CaseError
from restitution.surfaces.refine import coarsen
from restitution.surfaces.split import split
from tolerance import approx

BODY = rs.Body(radius=250e-6, youngs_modulus=231e9, poissons_ratio=0.3, density=7800.0)
PAIR = rs.Pair(BODY, replace(BODY, radius=math.inf))
CELL = 0.1e-6
ROUGH = {"kind": "self-affine", "hurst": 0.8, "rolloff": 6e-6, "shortest": 0.6e-6}
HARD, GROWING = rs.ConstantBound(3e9), rs.ExpandingCavity(1e9)


@pytest.fixture(scope="module")
def surface():
    return rs.generate_surface(rs.Grid((256, 256), (CELL, CELL)), rms=30e-9, seed=3, **ROUGH)


@pytest.fixture(scope="module")
def two_scales(surface):
    """The contact on cells four times as large, with the waves below 1.6 um in patches."""
    long, patches = split(surface, 1.6e-6, 64, tiles=3)
    coarse = coarsen(long, 4)
    law = PatchRepulsion(patches, 1.6e-6)
    return rs.Contact(PAIR, rs.Surface(coarse.height, coarse.grid), HARD, law)


def work_of(path):
    """Work (J) of the force along a path, by the trapezium rule."""
    return np.trapezoid([s.force for s in path], [s.indentation for s in path])


@pytest.mark.parametrize("plasticity", [HARD, GROWING])
def test_the_work_of_a_patch_is_stored_or_dissipated(two_scales, plasticity):
    patch = two_scales.adhesion.patches[0]
    contact = rs.Contact(flat(PAIR), patch, periodic=True)
    table = RepulsionTable.of([PatchCurve.of(contact, plasticity)])
    gap = table.pressure.first + np.linspace(0, 0.9, 7) * (table.touch - table.pressure.first)
    work, pressure, slope = table.work(gap)
    assert (np.diff(work) < 0).all()
    assert (np.diff(pressure) < 0).all()
    assert (slope < 0).all()
    ahead = table.work(gap + 1e-13)[0]
    np.testing.assert_allclose((work - ahead) / 1e-13, pressure, rtol=1e-3)
    if plasticity is HARD:
        depth = float(contact.gap.mean()) - gap[2]
        direct = rs.solve(replace(contact, plasticity=HARD), float(depth))
        area = np.prod(patch.grid.size)
        lost = work[2] * table.of_gap(table.lost, gap[2])
        assert lost == approx(direct.plastic_work / area, rel=0.02)
        assert work[2] - lost == approx(direct.stored_energy / area, rel=0.02)


@pytest.fixture(scope="module")
def bounds(two_scales):
    contact = rs.Contact(flat(PAIR), two_scales.adhesion.patches[0], periodic=True)
    touch = float(contact.gap.mean())
    return PatchBounds.of(contact, GROWING, [share * touch for share in (0.2, 0.5, 0.8, 0.99)])


def test_valleys_have_the_bound_of_first_yield(bounds):
    first = GROWING.first_yield_pressure(PAIR)
    depth = 0.4 * float(bounds.contact.gap.mean())
    limit = bounds.at(depth, bounds.elastic(depth))
    touching = rs.solve(bounds.contact, depth).pressure > 0
    assert limit.min() == approx(first)
    assert limit[touching].mean() > 1.03 * first
    assert limit[~touching].mean() < limit[touching].mean()


def test_bounds_of_complete_contact_are_those_of_smooth_bodies_in_the_mean(bounds):
    nominal = 3 * float(bounds.nominal[-1])
    limit = bounds.at(2 * float(bounds.depth[-1]), nominal)
    smooth = float(GROWING.bound_at(PAIR, np.asarray(nominal)))
    assert limit.std() > 0
    assert limit.mean() == approx(smooth, rel=0.02)


def test_the_mean_bound_of_a_patch_is_below_that_of_smooth_bodies(bounds):
    smooth, ratio = bounds.of_mean()
    assert (np.diff(smooth) >= 0).all()
    assert 0.6 < ratio[-1] < 1
    assert ratio[0] >= 1  # asperities yield later than smooth bodies at first yield


def test_the_bulk_bears_more_than_a_patch_that_flows(two_scales):
    """Strain of the long waves is larger than in a patch; late asperities do not delay the bulk."""
    table = replace(two_scales, plasticity=GROWING).adhesion.table
    flowing = float(table.pressure.values[0])
    smooth = np.geomspace(0.5 * GROWING.first_yield_pressure(PAIR), 3.5e9, 30)
    bound = table.bulk_bound(smooth)
    assert np.all(bound <= smooth)
    assert flowing < 0.9 * smooth[-1]
    assert bound[-1] > 0.95 * smooth[-1]
    assert np.all(np.diff(bound) > 0)


def test_the_gap_is_the_inverse_of_the_pressure(two_scales):
    table = two_scales.adhesion.table
    for pressure in (1e6, 1e8, 2e9, 2.999e9):
        assert table.work(table.gap_at(pressure))[1] == approx(pressure, rel=1e-3)


def test_a_patch_that_flows_at_the_end_of_its_table_has_a_gap_at_larger_pressures(two_scales):
    table = two_scales.adhesion.table
    values = np.minimum(table.pressure.values, table.pressure.values[50])
    flows = replace(table, pressure=replace(table.pressure, values=values))
    with np.errstate(all="raise"):
        gap = flows.gap_at(np.array([0.5, 1.0, 1.1]) * values[0])
    assert np.isfinite(gap).all()
    assert gap[2] < flows.pressure.first - 1e3 * (flows.touch - flows.pressure.first)


def test_the_energy_account_of_an_impact_closes(two_scales):
    depths = 250e-9 * np.linspace(0, 1, 41)[1:] ** 1.5
    path = list(rs.loading_path(two_scales, depths))
    deepest = path[-1]
    assert deepest.loading_work == approx(work_of(path), rel=5e-3)
    assert 0 < deepest.patch_work <= deepest.plastic_work
    assert 0 < deepest.patch_energy < deepest.stored_energy
    back = list(rs.unloading_path(deepest, steps=40))
    assert -work_of(back) == approx(rs.collide(deepest).unloading_work, rel=5e-3)
    assert back[-1].force == approx(0, abs=1e-6 * deepest.force)
    assert back[-6].force > 0
    assert back[-1].contact_area < 1e-6 * deepest.contact_area
    assert back[-1].plastic_work == approx(deepest.plastic_work)


def test_a_second_loading_returns_to_the_deepest_state(two_scales):
    deepest = rs.solve(two_scales, 200e-9)
    back = step(deepest, 170e-9)
    assert back.force < deepest.force
    again = step(back, 200e-9)
    assert again.force == approx(deepest.force, rel=1e-4)
    assert again.plastic_work == approx(deepest.plastic_work, rel=1e-3)
    deeper = step(again, 230e-9)
    assert deeper.force == approx(rs.solve(two_scales, 230e-9).force, rel=2e-3)


@pytest.mark.parametrize("plasticity", [HARD, GROWING])
def test_restitution_is_that_of_cells_that_carry_all_waves(surface, two_scales, plasticity):
    fine = rs.Contact(PAIR, surface, plasticity)
    coarse = replace(two_scales, plasticity=plasticity)
    left_out = replace(coarse, adhesion=None)
    off = []
    for velocity in (0.1, 0.3):
        direct, law, omit = (
            rs.collide(rs.solve_at_velocity(contact, velocity)).restitution
            for contact in (fine, coarse, left_out)
        )
        assert law == approx(direct, abs=0.02)
        off.append((abs(law - direct), abs(omit - direct)))
    own, without = np.sum(off, axis=0)
    assert own < 0.6 * without


def test_elastic_bodies_return_all_energy(two_scales):
    state = rs.solve(replace(two_scales, plasticity=rs.Elastic()), 150e-9)
    assert rs.collide(state).restitution == approx(1.0)
    assert state.patch_work == 0
    assert not state.contact.adhesive


def test_the_law_follows_the_bodies(two_scales):
    softer = replace(two_scales, plasticity=rs.ConstantBound(1e9))
    assert softer.adhesion.plasticity == softer.plasticity
    assert softer.adhesion.table.pressure.values[0] == approx(1e9, rel=0.05)
    same = replace(two_scales, adhesion=replace(two_scales.adhesion, pair=None))
    assert same == two_scales


def test_solved_patches_are_kept(two_scales, monkeypatch, tmp_path):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    patch, model = two_scales.adhesion.patches[0], rs.ConstantBound(2.9e9)
    contact = rs.Contact(flat(PAIR), patch, periodic=True)
    monkeypatch.setattr(stored, "_known", {})
    first = PatchCurve.of(contact, model)
    assert len(list((tmp_path / "restitution" / "patches").iterdir())) == 1
    monkeypatch.setattr(repulsion, "_columns", lambda *_: pytest.fail("solved again"))
    for memory in (stored._known, {}):
        monkeypatch.setattr(stored, "_known", memory)
        np.testing.assert_array_equal(PatchCurve.of(contact, model).pressure, first.pressure)
    for other in (rs.ConstantBound(2.8e9), rs.Elastic()):
        with pytest.raises(pytest.fail.Exception, match="solved again"):
            PatchCurve.of(contact, other)


FINE = rs.Body(radius=5e-6, youngs_modulus=72e9, poissons_ratio=0.17, density=2200.0)
FINE_PAIR = rs.Pair(FINE, replace(FINE, radius=math.inf))
W, Z0 = 0.05, 0.3e-9


def asperities(rms, nodes=48):
    grid = rs.Grid((nodes, nodes), (0.6e-9, 0.6e-9))
    waves = {"hurst": 0.8, "rolloff": 14e-9, "shortest": 6e-9}
    return rs.generate_surface(grid, kind="self-affine", rms=rms, seed=4, **waves)


def adhesive(rms, nodes, cell):
    law = PatchAttraction((asperities(rms),), 14e-9, Cohesive(W, Z0))
    return rs.Contact(FINE_PAIR, rs.smooth(rs.Grid((nodes, nodes), (cell, cell))), adhesion=law)


def test_the_law_of_a_flat_patch_is_that_of_half_spaces():
    contact = rs.Contact(
        flat(FINE_PAIR), asperities(1e-14, 24), adhesion=Cohesive(W), periodic=True
    )
    law = PatchAttraction((contact.surface,), 14e-9, Cohesive(W))
    table = law.of_contact(rs.Contact(FINE_PAIR, rs.smooth(rs.Grid((8, 8), (1e-9, 1e-9))))).table
    gap = np.array([0.28e-9, Z0, 0.4e-9, 1e-9, 5e-9, 30e-9])
    energy, traction, _ = table.potential(gap)
    exact = Cohesive(W)
    np.testing.assert_allclose(energy, exact.energy(gap), rtol=0.02, atol=0.04 * W)
    np.testing.assert_allclose(traction, exact.traction(gap), rtol=0.03, atol=0.05 * W / Z0)
    assert table.equilibrium == approx(Z0, rel=5e-3)
    assert table.work == approx(W, rel=0.02)


def test_a_patch_is_solved_once_for_blocks_of_all_sizes(monkeypatch):
    monkeypatch.setattr(attraction, "kept", lambda *of: of[-1]())
    patch, coarse = asperities(0.15e-9, 24), []
    for cell in (3.6e-9, 7.2e-9):
        grid = rs.Grid((8, 8), (cell, cell))
        law = PatchAttraction((patch,), 14e-9, Cohesive(W))
        coarse.append(law.of_contact(rs.Contact(FINE_PAIR, rs.smooth(grid))).curve(patch))
        monkeypatch.setattr(attraction, "_loading", lambda _: pytest.fail("solved"))
    fine, wide = (curve.blocks for curve in coarse)
    assert fine.shape[1] == 2 * wide.shape[1]
    for curve in coarse:
        assert curve.blocks.mean(axis=(1, 2)) == approx(curve.pressure, rel=1e-6, abs=1.0)


def test_an_attraction_is_the_derivative_of_its_energy():
    law = adhesive(0.2e-9, 16, 4e-9).adhesion
    gap = np.linspace(0.2e-9, 20e-9, 200)
    energy, traction, stiffness = law.potential(gap)
    d = 1e-14
    ahead = law.potential(gap + d)
    np.testing.assert_allclose((ahead[0] - energy) / d, traction, rtol=0.02, atol=1e3)
    np.testing.assert_allclose((ahead[1] - traction) / d, stiffness, rtol=0.05, atol=1e13)
    g = np.geomspace(1e-9, 1e-6, 4000)
    integral = 2 * math.pi * 5e-6 * np.trapezoid(law.energy(g), g)
    assert law.rigid_sphere_energy(1e-9, 5e-6) == approx(integral, rel=5e-3)


def test_roughness_weakens_adhesion_and_the_pull_off_is_independent_of_the_cells():
    forces = []
    for nodes, cell in ((40, 8e-9), (80, 4e-9)):
        contact = adhesive(0.2e-9, nodes, cell)
        collision = rs.collide(rs.solve(contact, 1e-9))
        forces.append(collision.pull_off_force)
    smooth = rs.theory.JKR(5e-6, FINE_PAIR.contact_modulus, W).pull_off_force
    assert 0.2 * smooth < forces[1] < 0.8 * smooth
    assert forces[0] == approx(forces[1], rel=0.01)


def test_all_that_patches_lose_in_jumps_and_half_of_what_they_lose_in_yield_is_an_error():
    path = list(rs.unloading_path(rs.solve(adhesive(0.2e-9, 48, 4e-9), 0.2e-9)))
    law = path[0].contact.adhesion
    table, none = law.table, np.zeros_like(law.table.lost)
    nominal = 1e-4 * math.prod(path[0].contact.grid.size)  # J, of 1e-4 J/m²

    def separation(lost, jumped):
        law.__dict__["table"] = replace(table, lost=lost, jumped=jumped)
        return law.separation_of(path)

    ends = [
        separation(none, none),
        separation(none + 1e-4, none),
        separation(none + 1e-4, none + 1e-4),
    ]
    law.__dict__["table"] = table
    lost = [end.adhesive_loss - ends[0].adhesive_loss for end in ends]
    added = [math.sqrt(end.error**2 - ends[0].error ** 2) for end in ends]
    assert lost[1] == approx(lost[2], rel=1e-12)
    assert 0.3 * nominal < lost[1] <= nominal
    assert added[1:] == approx([0.5 * lost[1], lost[1]], rel=1e-6)


def test_patches_are_averaged_at_equal_gaps():
    contact = rs.Contact(flat(FINE_PAIR), asperities(0.2e-9), adhesion=Cohesive(W), periodic=True)
    curve = PatchAttraction((contact.surface,), 14e-9, Cohesive(W), flat(FINE_PAIR)).curve(
        contact.surface
    )
    one, two = AttractionTable.of([curve]), AttractionTable.of([curve, curve])
    np.testing.assert_allclose(one.pressure.values, two.pressure.values, rtol=1e-12)


def test_blocks_have_the_mean_and_the_places_of_their_nodes():
    values = np.random.default_rng(0).random((30, 20))
    means = block_means(values, (6, 5))
    assert means.mean() == approx(values.mean(), rel=1e-12)
    assert means[1, 2] == approx(values[3:8, 6:10].mean(), rel=1e-12)
    peak = np.zeros((30, 20))
    peak[7, 8] = 1.0
    patch = rs.Surface(peak, rs.Grid((30, 20), (1e-9, 1e-9)))
    x, y = levers(patch, (6, 5), peak)
    assert (x[1, 2], y[1, 2]) == approx((0.4, 0.0), abs=1e-12)


@pytest.fixture(scope="module")
def node_law():
    contact = adhesive(0.3e-9, 14, 4e-9)
    return contact, contact.adhesion.at_nodes(contact, (slice(2, 12), slice(3, 11)))


def test_the_attraction_of_a_block_is_the_derivative_of_its_energy(node_law):
    _, law = node_law
    d = 1e-14
    for g in np.linspace(-1e-9, 12e-9, 60):
        gap = np.full((10, 8), g)
        energy, traction, stiffness = law.potential(gap)
        ahead = law.potential(gap + d)
        np.testing.assert_allclose((ahead[0] - energy) / d, traction, rtol=0.02, atol=1e5)
        np.testing.assert_allclose((ahead[1] - traction) / d, stiffness, rtol=0.05, atol=1e15)
    pressure = np.full((10, 8), 1e9)
    np.testing.assert_allclose(-law.traction(law.gap_at(pressure)), pressure, rtol=1e-3)


def test_a_flat_contact_of_blocks_is_the_patch(node_law):
    """All blocks at the gaps that the grid of the contact gives them under their pressures."""
    contact, _ = node_law
    curve = contact.adhesion.curve(contact.adhesion.patches[0])
    tables = BlockTables.of([curve], contact.grid.spacing)
    k = int(curve.pressure.argmin())
    p = curve.blocks[k]
    gap = curve.gap[k] + displacement_of(p, contact.grid.spacing, FINE_PAIR.contact_modulus)
    law = BlockLaw.of_rows(tables, np.arange(p.size).reshape(p.shape))
    np.testing.assert_allclose(-law.traction(gap), p, atol=0.01 * np.abs(p).max())


def test_other_places_of_a_patch_have_other_pull_off_forces():
    contact = adhesive(0.5e-9, 56, 4e-9)
    other = replace(contact, adhesion=replace(contact.adhesion, place=1))
    assert other.adhesion.table is contact.adhesion.table
    forces = [rs.collide(rs.solve(c, 1e-9)).pull_off_force for c in (contact, other)]
    assert forces[1] != approx(forces[0], rel=1e-3)
    assert forces[1] == approx(forces[0], rel=0.5)


def test_cells_too_coarse_for_the_patches_name_the_spacing():
    contact = adhesive(0.1e-9, 24, 20e-9)
    with pytest.raises(CaseError, match=r"set grid\.spacing to [\d.]+ nm or less"):
        rs.solve(contact, 1e-9)
