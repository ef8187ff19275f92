"""Periodic contacts that attract: the law itself, the wave of Johnson (1995), energies, limits."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from contact_keys import contact_of
from restitution import (
    Body,
    Contact,
    Grid,
    Pair,
    Surface,
    generate_surface,
    solve,
    solve_at_pressure,
    step,
)
from restitution.contact.cohesive.equilibrium import box_gap, is_unique, rigid_start
from restitution.contact.cohesive.law import Cohesive
from restitution.contact.cohesive.separation import separation_of
from restitution.contact.cohesive.steps import follow
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.path import unloading_path
from restitution.errors import CaseError, DomainError
from restitution.numerics.quadrature import integrate_curve
from restitution.theory import LennardJones
from tolerance import approx

W, Z0, E_STAR = 0.05, 0.3e-9, 1e11
LENGTH = E_STAR * Z0**2 / W  # of the cohesive zone
LAW = LennardJones(W, Z0)


def pair_of(contact_modulus):
    wall = Body(math.inf, 2 * contact_modulus * (1 - 0.3**2), 0.3)
    return Pair(wall, wall)


def rough(nodes, height, *, cells=0.3, seed=0, **model):
    """Random surface with three waves on a side and a peak-to-valley `height` (in z0)."""
    grid = Grid(nodes, cells * LENGTH)
    rng = np.random.default_rng(seed)
    spectrum = np.fft.fft2(rng.normal(size=grid.nodes))
    waves = [np.abs(np.fft.fftfreq(n, 1 / n)) for n in grid.nodes]
    spectrum[np.hypot(*np.meshgrid(*waves, indexing="ij")) > 3] = 0
    z = np.fft.ifft2(spectrum).real
    surface = Surface(height * Z0 * z / np.ptp(z), grid)
    model = {"work_of_adhesion": W, "adhesion": "cohesive", **model}
    model = {"equilibrium_separation": Z0, "pair": pair_of(E_STAR), **model}
    return contact_of(surface=surface, periodic=True, **model)


def per_area(contact):
    return math.prod(contact.grid.size)


def test_nearly_flat_surfaces_follow_the_law():
    contact = rough(8, 1e-5, cells=0.1)
    state = solve(contact, 0.02 * Z0)
    path = list(unloading_path(state))
    for each in path:
        assert -each.nominal_pressure == approx(float(LAW.traction(each.mean_gap)), rel=1e-6)
        assert each.interaction_energy == approx(
            float(LAW.energy(each.mean_gap)) * per_area(contact), rel=1e-6
        )
    found = separation_of(path)
    largest = 16 * W / (9 * math.sqrt(3) * Z0)
    assert found.pull_off_force == approx(largest * per_area(contact), rel=1e-3)
    at_rest = step(state, 0.0)
    assert at_rest.mean_gap == approx(Z0, rel=1e-5)
    assert at_rest.potential_energy == approx(-W * per_area(contact), rel=1e-6)
    assert (found.adhesive_loss, path[-1].jumps) == (0, 0)
    assert state.relative_area == 1
    assert path[-1].relative_area == 0
    # The work of separation is w, by energies and by the force.
    rest = path[-1].interaction_energy
    depth, force = [s.indentation for s in path], [s.force for s in path]
    work = -integrate_curve(depth, force) + rest
    assert found.unloading_work == approx(state.potential_energy)
    assert work == approx(state.potential_energy, rel=1e-3)


def test_long_flat_surfaces_become_unstable():
    # A wave of length λ grows where the softening of the law exceeds πE*/λ.
    x = (2 / 15) ** (1 / 6)
    softening = 8 * W / Z0**2 * x**4 * (1 - 3 * x**6)
    around = Z0 / x + 1e-3 * Z0 * np.arange(-1, 2)
    curvature = np.diff(LAW.energy(around), 2) / (1e-3 * Z0) ** 2
    assert softening == approx(-float(curvature[0]), rel=1e-3)
    critical = math.pi * E_STAR / softening
    for ratio, unstable in ((0.8, False), (1.6, True)):
        contact = rough((16, 1), 1e-4, cells=ratio * critical / (16 * LENGTH))
        path = list(unloading_path(solve(contact, 0.02 * Z0)))
        assert (path[-1].jumps > 0) == unstable
        assert (separation_of(path).adhesive_loss > 1e-3 * W * per_area(contact)) == unstable


@pytest.mark.parametrize("alpha", [0.3, 0.5])
def test_the_wave_of_johnson(alpha):
    # Johnson (1995), Int. J. Solids Struct. 32, 423: p/p* = sin²ψ − α √tan ψ with ψ = πa/λ and
    # α² = 2wλ/(π²E*Δ²). The compliance of the periodic cracks gives the mean gap.
    nodes, modulus, wavelength = 336, 1e9, 1e-6
    z0 = math.sqrt(3.34 * wavelength / nodes * W / modulus)
    amplitude = math.sqrt(2 * W * wavelength / (math.pi**2 * modulus)) / alpha
    grid = Grid((nodes, 1), wavelength / nodes)
    z = amplitude * np.cos(2 * np.pi * (np.arange(nodes) + 0.31) / nodes)[:, None]
    contact = Contact(pair_of(modulus), Surface(z, grid), adhesion=Cohesive(W, z0), periodic=True)
    full = math.pi * modulus * amplitude / wavelength
    psi = np.linspace(0.02, 1.2, 20000)
    log = np.log(np.sin(psi))
    pressure = np.sin(psi) ** 2 - alpha * np.sqrt(np.tan(psi))
    gap = np.cos(psi) ** 2 + 2 * (np.sin(psi) ** 2 - alpha * np.sqrt(np.tan(psi))) * log
    last = int(gap.argmax())  # below this width the equilibrium is unstable
    path = list(unloading_path(solve(contact, 0.4 * amplitude)))
    found = separation_of(path)
    assert found.pull_off_force == approx(-pressure.min() * full * per_area(contact), rel=0.01)
    assert found.separation_indentation == approx((1 - gap[last]) * amplitude, abs=2 * z0)
    assert found.adhesive_loss > 10 * found.error
    # The range lets the contact snap off earlier or later by about z0.
    held = [s for s in path if s.indentation > (1 - gap[last]) * amplitude + 2 * z0]
    depths = 1 - gap[last:]
    for state in held:
        at = state.indentation / amplitude
        exact = np.interp(at, depths, pressure[last:])
        assert state.nominal_pressure / full == approx(exact, abs=0.01)
        width = np.interp(at, depths, psi[last:]) / math.pi
        assert state.relative_area / 2 == approx(width, abs=0.0078)
    assert len(held) > 20


def test_equilibrium_at_every_node():
    contact = rough((24, 18), 4)
    state = solve(contact, 0.5 * float(contact.gap.mean()))
    gap = box_gap(state)
    assert state.pressure == approx(-LAW.traction(gap), abs=1e-4 * W / Z0)
    waves = [2 * np.pi * np.fft.fftfreq(n, 0.3 * LENGTH) for n in contact.grid.nodes]
    q = np.hypot(*np.meshgrid(*waves, indexing="ij"))
    q[0, 0] = math.inf
    u = np.fft.ifft2(2 / (E_STAR * q) * np.fft.fft2(state.pressure)).real
    base = contact.gap + Z0 - state.indentation
    assert gap == approx(base + u, abs=1e-8 * Z0)
    assert gap.mean() == approx(state.mean_gap)
    assert gap.min() == approx(state.smallest_gap)


def _finer(path):
    """The path with three further states in each step that loses no energy.

    Between two states of the program the force may have its largest tension. The count of jumps
    does not show where energy is lost, because it also counts steps whose solve only passed a
    negative curvature.
    """
    states = [path[0]]
    for a, b in pairwise(path):
        if a.adhesive_loss == b.adhesive_loss:
            for part in (0.25, 0.5, 0.75):
                place = a.indentation + part * (b.indentation - a.indentation)
                states.append(step(states[-1], place))
        states.append(b)
    return states


def _work_of_force(path):
    """Integral of the force, by the trapezium rule over each jump, and the error of this rule."""
    jumps = [k for k, (a, b) in enumerate(pairwise(path), 1) if b.adhesive_loss > a.adhesive_loss]
    work = error = 0.0
    for first, last in pairwise([0, *jumps, len(path)]):
        part = path[first:last]
        if len(part) > 1:
            work += integrate_curve([s.indentation for s in part], [s.force for s in part])
    for a, b in ((path[k - 1], path[k]) for k in jumps):
        step_length = b.indentation - a.indentation
        work += 0.5 * (a.force + b.force) * step_length
        error += 0.5 * abs((a.force - b.force) * step_length)  # wherever it jumps within the step
    return work, error


@settings(deadline=None, max_examples=8)
@given(
    st.sampled_from([(20, 20), (24, 12), (32, 1)]),
    st.floats(0.5, 8),
    st.floats(0.1, 0.9),
    st.integers(0, 1000),
    st.sampled_from([math.inf, 3e9]),
)
@example((32, 1), 3.0, 0.5, 205, math.inf)  # one step agreed with the energies by chance
@example((24, 12), 1.0, 0.734375, 0, math.inf)  # the first step was too long
def test_the_energies_of_a_closed_cycle_balance(nodes, height, share, seed, hard):
    contact = rough(nodes, height, seed=seed, yield_pressure=hard)
    start = rigid_start(contact, limit=hard, residual=1e-8)
    target = share * float(contact.gap.mean()) + 0.01 * Z0
    accuracy = contact.adhesion.loading_accuracy(contact)
    down = [start, *follow(start, target, residual=1e-8, accuracy=accuracy)]
    assert solve(contact, target).force == approx(down[-1].force)
    up = list(unloading_path(down[-1]))
    end = up[-1]
    works, errors = zip(*(_work_of_force(_finer(path)) for path in (down, up)), strict=True)
    spent = sum(works)
    scale = max(state.stored_energy - state.interaction_energy for state in down + up)
    lost = spent + start.potential_energy - end.potential_energy
    expected = end.adhesive_loss + end.plastic_work
    # The integral between the states has an error of its own.
    assert lost == approx(expected, abs=end.work_error + sum(errors) + 2e-3 * scale)
    assert abs(end.unaccounted) < 2e-3 * scale
    assert end.adhesive_loss >= down[-1].adhesive_loss >= 0
    found = separation_of(up)
    assert found.unloading_work == approx(
        down[-1].potential_energy - found.adhesive_loss - end.plastic_work + down[-1].plastic_work
    )
    assert max(state.pressure.max() for state in down) <= hard * (1 + 1e-9)
    assert (end.plastic_work > 0) == bool(end.plastic_displacement.any())


def test_a_surface_moved_across_the_boundary_has_the_same_contact():
    contact = rough((20, 16), 3)
    moved = Surface(np.roll(contact.surface.height, (11, 5), axis=(0, 1)), contact.grid)
    depth = 0.5 * float(contact.gap.mean())
    ends = []
    for each in (contact, replace(contact, surface=moved)):
        state = solve(each, depth)
        found = separation_of(list(unloading_path(state)))
        ends.append((state, found))
    (first, one), (second, other) = ends
    assert second.force == approx(first.force, rel=1e-5)
    back = np.roll(second.pressure, (-11, -5), axis=(0, 1))
    assert back == approx(first.pressure, abs=1e-4 * W / Z0)
    assert other.pull_off_force == approx(one.pull_off_force, rel=1e-3)
    assert other.adhesive_loss == approx(one.adhesive_loss, abs=one.error + other.error)


def test_without_attraction_it_is_the_contact_without_adhesion():
    contact = rough((32, 32), 100, work_of_adhesion=1e-5)
    without = replace(contact, adhesion=None)
    depth = 0.5 * float(contact.gap.mean())
    state, hard = solve(contact, depth), solve(without, depth)
    # The repulsion gives way by a part of the range.
    softer = solve(without, depth - 0.8 * Z0)
    assert softer.force < state.force < hard.force
    assert state.mean_gap == approx(hard.mean_gap + Z0)


def test_what_is_refused():
    contact = rough(16, 3)
    with pytest.raises(CaseError, match="adhesion: the JKR limit is not defined"):
        replace(contact, adhesion=JKRLimit(W))
    with pytest.raises(CaseError, match="contact: the bodies attract each other"):
        solve_at_pressure(contact, 1e8)
    coarse = rough(16, 3, cells=0.31)
    assert coarse.adhesion.coarsest_spacing(coarse.pair) == approx(0.3 * LENGTH)
    with pytest.raises(CaseError, match=r"grid.spacing: .* is too coarse for the range"):
        solve(coarse, Z0)
    with pytest.raises(DomainError, match=r"indentation: .* the pressure exceeds E\*"):
        solve(rough(8, 1e-3), 0.6 * Z0)


def test_soft_bodies_start_where_they_cannot_jump():
    """At a gap of 2 z₀ these would jump together, in hundreds of steps."""
    grid = Grid((64, 64), 6e-9)
    shape = {"kind": "self-affine", "rms": 0.15e-9, "hurst": 0.8, "seed": 1}
    surface = generate_surface(grid, shortest=18e-9, rolloff=40e-9, **shape)
    contact = Contact(pair_of(4.4e9), surface, adhesion=Cohesive(0.08), periodic=True)
    state = rigid_start(contact, limit=math.inf, residual=1e-8)
    assert is_unique(state)
    assert 2 * 0.3e-9 < 0.3e-9 - state.indentation < 6 * 0.3e-9
    assert state.convolutions < 30


def test_the_loss_by_many_small_jumps_is_within_its_error():
    """Five times longer steps passed a third of the jumps, and stated a third of the error."""
    body = Body(math.inf, 210e9, 0.25)
    waves = {"kind": "self-affine", "hurst": 0.8, "shortest": 0.6e-6, "seed": 1}
    contact = Contact(
        Pair(body, body),
        generate_surface(Grid(80, 60e-9), rms=1e-9, **waves),
        adhesion=Cohesive(0.05),
        periodic=True,
    )
    end = list(unloading_path(solve(contact, 2e-9)))[-1]
    whole = 0.05 * math.prod(contact.grid.size)
    # With steps 10 times finer: 0.02334 wA, in 32 jumps.
    assert end.adhesive_loss == approx(0.02334 * whole, abs=end.work_error)
    assert end.work_error < 0.03 * end.adhesive_loss
