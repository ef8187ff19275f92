"""The detachment criteria: tension limit, energy release rate, and the nodes released."""

import math

import numpy as np
import pytest
from scipy.integrate import dblquad
from scipy.ndimage import label

from restitution import Body, Contact, Grid, Pair, Surface, solve
from restitution.case.models import adhesion_of
from restitution.contact.influence import half_space
from restitution.contact.jkr import detachment
from restitution.contact.jkr.area import release_nodes
from restitution.contact.jkr.detachment import (
    Edge,
    released_beyond,
    released_by_closure,
    tension_limit,
)
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.jkr.separation import separate, separation_of
from restitution.numerics.expressions import diffuse
from restitution.theory import Kendall
from tolerance import approx

E_STAR, W = 112e9, 0.09
WALL = Body(radius=2e3, youngs_modulus=1e9, poissons_ratio=0.25)
FLAT = Pair(WALL, WALL)


@pytest.mark.parametrize("h", [1e-9, 0.25e-6, 1.0])
def test_the_tension_limit_of_square_cells(h):
    kappa = 0.4732010044
    assert kappa == approx(
        2 / (3 * math.pi) * (1 - math.sqrt(2) + 3 * math.log(1 + math.sqrt(2))), rel=1e-9
    )
    limit = tension_limit(E_STAR, W, (h, h))
    assert limit**2 == approx(E_STAR * W / (kappa * h), rel=1e-9)


@pytest.mark.parametrize(("hx", "hy"), [(1, 1), (1, 2), (3, 0.7)])
def test_the_tension_limit_of_rectangular_cells(hx, hy):
    """σ_c² = 2πE*w hx hy/I; I, the integral of 1/r over the cell twice, by quadrature.

    The lags x = x₁ − x₂ have the density hx − |x|: I = 4 ∬ (hx − x)(hy − y)/r over the cell.
    """

    def over_r(angle_fraction, r_fraction):  # polar coordinates remove the singularity
        angle = angle_fraction * math.pi / 2
        reach = min(hx / max(math.cos(angle), 1e-300), hy / max(math.sin(angle), 1e-300))
        r = r_fraction * reach
        return reach * (hx - r * math.cos(angle)) * (hy - r * math.sin(angle)) * math.pi / 2

    integral = 4 * dblquad(over_r, 0, 1, 0, 1, epsabs=1e-10, epsrel=1e-8)[0]
    expected = 2 * math.pi * E_STAR * W * hx * hy / integral
    assert tension_limit(E_STAR, W, (hx, hy)) ** 2 == approx(expected, rel=1e-5)
    assert tension_limit(E_STAR, W, (hx, hy)) == tension_limit(E_STAR, W, (hy, hx))


def punch(nodes, depth=1e-3, w=0.1, detachment="crack-closure"):
    """A punch of radius 10 um that protrudes from a wall by `depth`, and its radius."""
    h = 10e-6 / nodes
    n = 2 * int(nodes + 4) + 1
    grid = Grid((n, n), (h, h))
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    disc = r < 10e-6
    surface = Surface(np.where(disc, 0.0, -depth), grid, {"source": "punch"})
    contact = Contact(
        FLAT,
        surface,
        adhesion=adhesion_of(work_of_adhesion=w, approach="hertzian", detachment=detachment),
    )
    return contact, disc, math.sqrt(disc.sum() * grid.cell_area / math.pi)


def drawn(contact, disc, distance):
    """Pressure, displacement and gap of the punch retracted by `distance` with all nodes held."""
    patient = Contact(contact.pair, contact.surface, adhesion=JKRLimit(1e6))  # no node is released
    n, m = contact.grid.nodes
    whole = slice(0, n), slice(0, m)
    state, _ = release_nodes(patient, -distance, whole, disc, limit=math.inf, residual=1e-9)
    box = state.box
    return state, (state.box_pressure, state.box_displacement, contact.gap[box], disc[box])


@pytest.mark.parametrize("nodes", [20.4, 30.3])
def test_the_edge_of_a_punch_is_a_crack(nodes):
    """G = K²/2E* = F²/(8πE*a³), which equals w at Kendall's force."""
    contact, disc, radius = punch(nodes)
    E, w = contact.pair.contact_modulus, 0.1
    state, fields = drawn(contact, disc, float(Kendall(E, w).pull_off_displacement(radius)))
    G = Edge.of(*fields).G
    expected = state.force**2 / (8 * math.pi * E * radius**3)
    assert expected == approx(w, rel=0.02)
    assert G.mean() == approx(expected, rel=0.03)
    assert G.std() < 0.1 * G.mean()


def test_a_straight_edge_releases_k_squared_over_two_e():
    """A flat strip of half width c under tension has p = −P/(π sqrt(c² − x²)) across its width.

    In the middle of a long strip K = P/sqrt(πc), where P is the tensile force per length there.
    """
    half, long, h = 24, 400, 1e-7
    n = (2 * half + 9, long)
    touching = np.zeros(n, dtype=bool)
    touching[4:-4, :] = True
    K = half_space(n, (h, h), E_STAR)
    from scipy.sparse.linalg import LinearOperator, cg

    inside = np.flatnonzero(touching)

    def apply(x):
        p = np.zeros(n)
        p.flat[inside] = x
        return K(p).flat[inside]

    A = LinearOperator((inside.size, inside.size), matvec=apply)
    x, status = cg(A, np.full(inside.size, -1e-9), rtol=1e-10)
    assert status == 0
    p = np.zeros(n)
    p.flat[inside] = x
    u = K(p)
    edge = Edge.of(p, u, np.zeros(n), touching)
    G, (_, j) = edge.G, edge.nodes
    middle = abs(j - (long - 1) / 2) < 20
    P = p[:, long // 2 - 20 : long // 2 + 20].sum(axis=0).mean() * h
    c = (half + 0.5) * h
    assert G[middle].mean() == approx(P**2 / (2 * math.pi * c * E_STAR), rel=0.01)


def test_geometry_outside_the_contact_is_no_opening():
    rates = []
    for depth in (1e-9, 1e-6, 1e-3):
        contact, disc, _ = punch(12.2, depth)
        rates.append(Edge.of(*drawn(contact, disc, 2e-8)[1]).G)
    assert rates[0] == approx(rates[1], rel=1e-6)
    assert rates[1] == approx(rates[2], rel=1e-6)


def test_a_punch_parts_at_the_same_force_whatever_is_beside_it():
    forces = [
        separation_of(
            list(separate(solve(punch(12.2, depth)[0], 1e-10), tolerance=0.02))
        ).pull_off_force
        for depth in (1e-6, 1e-3)
    ]
    assert forces[0] == approx(forces[1], rel=1e-6)


def patches():
    """Two patches one cell apart, and a single node."""
    touching = np.zeros((20, 24), dtype=bool)
    touching[3:12, 2:9] = True
    touching[3:14, 10:20] = True
    touching[17, 4] = True
    return touching


def test_smoothing_conserves_the_sum_and_stays_on_its_patch():
    touching = patches()
    joined = label(touching, structure=np.ones((3, 3)))[0]
    surrounded = touching[:-2, 1:-1] & touching[2:, 1:-1] & touching[1:-1, :-2] & touching[1:-1, 2:]
    edge = touching.copy()
    edge[1:-1, 1:-1] &= ~surrounded
    i, j = np.nonzero(edge)
    neighbours, weights = detachment._diffusion(i, j, touching.shape)
    for start in (0, i.size // 2, i.size - 1):
        both = np.zeros((i.size, 2))
        both[start] = 1.0
        diffuse(neighbours, weights, detachment._SMOOTHING_STEPS, both)
        amount = both[:, 0]
        assert amount.sum() == approx(1.0, rel=1e-12)
        assert amount.min() >= 0
        home = joined[i[start], j[start]]
        assert not amount[joined[i, j] != home].any()


def test_a_patch_without_tension_has_no_rate_beside_one_with():
    touching = patches()
    p, u = np.zeros(touching.shape), np.zeros(touching.shape)
    left = touching & (np.arange(24) < 9)[None, :] & (np.arange(20) < 12)[:, None]
    p[left] = -1e8
    u[~touching] = 1e-9
    edge = Edge.of(p, u, np.zeros(touching.shape), touching)
    G, (i, j) = edge.G, edge.nodes
    assert (G[left[i, j]] > 0).all()
    assert not G[~left[i, j]].any()


def test_the_tension_limit_releases_exactly_what_is_beyond_it():
    random = np.random.default_rng(5)
    touching = random.random((30, 31)) < 0.6
    p = np.where(touching, random.normal(0, 2.0, touching.shape), 0.0)
    p[0, 0], touching[0, 0] = -1.5, True  # exactly at the limit: not released
    released = released_beyond(1.5, p, touching)
    assert np.array_equal(released, touching & (p < -1.5))
    assert released.any()


@pytest.mark.parametrize(
    ("name", "rule"), [("crack-closure", "released_by_closure"), ("pohrt-popov", "released_beyond")]
)
def test_criteria_by_name(name, rule, monkeypatch):
    """Each criterion calls its own function, with the tension limit of the grid."""
    contact, disc, _ = punch(6.2, detachment=name)
    calls = []
    for function in (released_by_closure, released_beyond):

        def recorded(*given, function=function):
            calls.append((function.__name__, given))
            return function(*given)

        monkeypatch.setattr(detachment, function.__name__, recorded)
    whole = slice(0, disc.shape[0]), slice(0, disc.shape[1])
    release_nodes(contact, -1e-9, whole, disc, limit=math.inf, residual=1e-9)
    assert {called for called, _ in calls} == {rule}
    limit = tension_limit(contact.pair.contact_modulus, 0.1, contact.grid.spacing)
    assert all(limit in [each for each in given if np.ndim(each) == 0] for _, given in calls)


def test_crack_closure_releases_nodes_apart_from_each_other():
    """If G is hardly above w along the whole edge, few nodes of largest tension are released."""
    contact, disc, radius = punch(20.4)
    E, w = contact.pair.contact_modulus, 0.1
    limit = float(Kendall(E, w).pull_off_displacement(radius))
    _, (p, u, h, touching) = drawn(contact, disc, 1.025 * limit)
    released = released_by_closure(Edge.of(p, u, h, touching), p, w, math.inf)
    assert 1 <= released.sum() < 40
    assert not (released & ~touching).any()
    i, j = np.nonzero(released)
    apart = np.maximum(abs(i[:, None] - i), abs(j[:, None] - j))
    assert apart[~np.eye(i.size, dtype=bool)].min(initial=9) > 3
    assert p[released].max() < 0
    _, (p, u, h, touching) = drawn(contact, disc, 0.8 * limit)
    assert not released_by_closure(Edge.of(p, u, h, touching), p, w, math.inf).any()


def test_an_edge_far_from_balance_recedes_by_a_strip():
    """The strip holds all nodes near the edge, and is wider where G is larger."""
    contact, disc, radius = punch(20.4)
    E, w = contact.pair.contact_modulus, 0.1
    limit = float(Kendall(E, w).pull_off_displacement(radius))
    widths = []
    for factor in (1.15, 1.4):
        _, (p, u, h, touching) = drawn(contact, disc, factor * limit)
        released = released_by_closure(Edge.of(p, u, h, touching), p, w, math.inf)
        widths.append(released.sum() / (2 * math.pi * 20.4))
        assert released[touching & (p == p[touching].min())].all()
    assert 1 < widths[0] < widths[1]


def test_the_rim_under_tension_is_measured():
    """An annulus of tension of 5 cells in a disc of radius 20."""
    x = np.arange(51.0) - 25
    r = np.hypot(x[:, None], x)
    touching = r < 20
    p = np.where(touching & (r > 15), -1.0, np.where(touching, 1.0, 0.0))
    edge = Edge.of(p, p, p, touching)
    width = edge.tensile_width(p < 0)
    assert width.sum() == approx((p < 0).sum(), rel=1e-9)
    strip = edge.strip(np.full(edge.G.size, 2.0))
    assert strip.sum() == approx(2 * 2 * math.pi * 19, rel=0.15)
    assert r[strip].min() > 16.5


def test_the_curvature_of_an_edge():
    """1/radius for a disc, twice 2π over the perimeter for each of two patches, and limited."""
    x = np.arange(101.0) - 50
    touching = np.hypot(x[:, None] - 20, x - 20) < 25
    touching |= np.hypot(x[:, None] + 35, x + 35) < 8
    edge = Edge.of(*(np.zeros(touching.shape) for _ in range(3)), touching)
    i, j = edge.nodes
    faces = sum(
        (~np.roll(touching, step, axis)[i, j]).astype(int) for step in (-1, 1) for axis in (0, 1)
    )
    curvature = detachment._curvature(touching, edge.nodes, faces)
    large = i > 45
    assert curvature[large] == approx(np.full(large.sum(), 1 / 25), rel=0.05)
    assert curvature[~large] == approx(np.full((~large).sum(), 1 / 8), rel=0.08)
    single = np.zeros((5, 5), dtype=bool)
    single[2, 2] = True
    nodes = np.array([2]), np.array([2])
    assert detachment._curvature(single, nodes, np.array([4])) == approx([0.35])


def test_rounding_does_not_choose_between_nodes():
    """Among nodes that are equal by symmetry, the same one is released whatever the rounding."""
    contact, disc, radius = punch(20.4)
    E, w = contact.pair.contact_modulus, 0.1
    far = 1.3 * float(Kendall(E, w).pull_off_displacement(radius))
    _, (p, u, h, touching) = drawn(contact, disc, far)
    released = [
        released_by_closure(Edge.of(noisy, u, h, touching), noisy, w, math.inf)
        for noisy in (p, p * (1 + 1e-9 * np.random.default_rng(0).normal(size=p.shape)))
    ]
    assert released[0].any()
    assert np.array_equal(*released)
