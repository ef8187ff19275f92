"""A flat punch against Kendall, and rectangular cells: criteria that know the shape of a cell."""

import math

import numpy as np
import pytest

from restitution import Body, Contact, Grid, Pair, Surface, smooth, solve
from restitution.case.models import adhesion_of
from restitution.contact.jkr.approach import HertzianApproach
from restitution.contact.jkr.limit import JKRLimit
from restitution.contact.jkr.separation import separate, separation_of
from restitution.theory import JKR, Kendall
from tolerance import approx

A, W = 10e-6, 0.1


def punch(nodes, offset=(0, 0), ratio=1, depth=1e-3):
    """A disc of radius A standing out by `depth` from a wall, a/h = `nodes`; and its radius."""
    h = A / nodes
    hx, hy = h * math.sqrt(ratio), h / math.sqrt(ratio)
    grid = Grid((2 * int(A / hx + 4) + 1, 2 * int(A / hy + 4) + 1), (hx, hy))
    x, y = grid.x[:, None] - offset[0] * hx, grid.y[None, :] - offset[1] * hy
    disc = x * x + y * y < A * A
    surface = Surface(np.where(disc, 0.0, -depth), grid, {"source": "punch"})
    wall = Body(radius=2e3, youngs_modulus=1e9, poissons_ratio=0.25)
    return Pair(wall, wall), surface, math.sqrt(disc.sum() * grid.cell_area / math.pi)


@pytest.mark.parametrize("detachment", ["crack-closure", "pohrt-popov"])
@pytest.mark.parametrize(
    ("nodes", "offset", "ratio"),
    [
        (15.1, (0, 0), 1),
        (20.4, (0, 0), 1),
        (15.1, (0.3, 0.4), 1),
        (20.4, (0.3, 0.4), 1),
        (15.1, (0, 0), 2),
        (20.4, (0.3, 0.4), 2),
    ],
)
def test_kendall(detachment, nodes, offset, ratio):
    pair, surface, radius = punch(nodes, offset, ratio)
    contact = Contact(
        pair,
        surface,
        adhesion=adhesion_of(work_of_adhesion=W, approach="hertzian", detachment=detachment),
    )
    path = list(separate(solve(contact, 1e-10), tolerance=0.01))
    expected = float(Kendall(pair.contact_modulus, W).pull_off_force(radius))
    assert separation_of(path).pull_off_force == approx(expected, rel=0.02)


@pytest.mark.parametrize("ratio", [2, 0.5])
def test_jkr_on_rectangular_cells(ratio):
    """Cells of the same area: the same sphere, the same numbers."""
    steel = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
    pair, w = Pair(steel, steel), 0.09
    jkr = JKR(pair.radius, pair.contact_modulus, w)
    depth = -2.5 * float(jkr.break_indentation)
    reach = 1.4 * math.sqrt(pair.radius * depth)
    F_c = float(jkr.pull_off_force)
    found = []
    for r in (1, ratio):
        h = float(jkr.pull_off_radius) / 8
        hx, hy = h * math.sqrt(r), h / math.sqrt(r)
        grid = Grid((2 * int(reach / hx) + 1, 2 * int(reach / hy) + 1), (hx, hy))
        contact = Contact(pair, smooth(grid), adhesion=JKRLimit(w, approach=HertzianApproach()))
        state = solve(contact, depth)
        separation = separation_of(list(separate(state, tolerance=0.005)))
        found.append((separation.pull_off_force / F_c, separation.unloading_work / (F_c * depth)))
    square, rectangle = np.array(found)
    assert rectangle[0] == approx(square[0], rel=0.04)
    assert rectangle[1] == approx(square[1], abs=0.03)
