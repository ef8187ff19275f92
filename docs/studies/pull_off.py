"""Pull-off of a JKR sphere on coarse grids, both criteria: the table in docs/adhesion.md.

`python docs/studies/pull_off.py`; about two minutes.
"""

from __future__ import annotations

import numpy as np

from restitution import Body, Contact, Grid, Pair, Surface, solve
from restitution.contact.separation import separate, separation_of
from restitution.theory import JKR

OFFSETS = ((0, 0), (0.5, 0.5), (0.5, 0), (0.23, 0.41), (0.37, 0.12), (0.08, 0.29))
W = 0.09
DEPTHS = 1e-9 * np.array([2, 3, 5, 8, 12, 20, 30, 50])


def sphere(nodes_over_pull_off_radius, offset, detachment, depth, approach="hertzian"):
    """Return a contact whose apex lies `offset` cells beside a node, and its indentation: `depth`
    (m), or three times its break indentation.
    """
    body = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850)
    pair = Pair(body, body)
    smooth = JKR(pair.radius, pair.contact_modulus, W)
    h = float(smooth.pull_off_radius) / nodes_over_pull_off_radius
    deep = -3 * float(smooth.break_indentation) if depth is None else depth
    n = 2 * int(1.5 * np.sqrt(2.8 * pair.radius * deep) / h + 6) + 1
    grid = Grid((n, n), (h, h))
    x, y = grid.x[:, None], grid.y[None, :]
    shifted = (x - offset[0] * h) ** 2 + (y - offset[1] * h) ** 2
    height = (x * x + y * y - shifted) / (2 * pair.radius)
    surface = Surface(height, grid, {"source": "shifted apex"})
    contact = Contact(pair, surface, work_of_adhesion=W, approach=approach, detachment=detachment)
    return contact, deep


def pull_off(nodes, offset, detachment, depth=None):
    """Pull-off force over its exact value, from `depth` (m) or from three break indentations."""
    contact, deep = sphere(nodes, offset, detachment, depth)
    path = list(separate(solve(contact, deep)))
    exact = JKR(250e-6, contact.pair.contact_modulus, W).pull_off_force
    return separation_of(path).pull_off_force / float(exact)


def row(what, found):
    """Print one row of the table."""
    print(f"| {what} | {np.mean(found):.3f} | {min(found):.3f} | {max(found):.3f} |", flush=True)


def main():
    """Print the tables."""
    print("| criterion | a_c/h | pull-off / exact: mean | least | most |")
    print("|---|---|---|---|---|")
    for detachment in ("pohrt-popov", "crack-closure"):
        for nodes in (2, 4, 8, 16):
            offsets = OFFSETS if nodes < 16 else OFFSETS[::3]
            row(f"{detachment} | {nodes}", [pull_off(nodes, at, detachment) for at in offsets])
    more = (*OFFSETS, *np.random.default_rng(0).uniform(0, 0.5, (18, 2)))
    for nodes in (4, 8):
        found = [pull_off(nodes, at, "crack-closure") for at in more]
        row(f"crack-closure, 24 offsets | {nodes}", found)
    found = [pull_off(8, (0, 0), "crack-closure", depth) for depth in DEPTHS]
    row(f"crack-closure, {len(DEPTHS)} depths | 8", found)


if __name__ == "__main__":
    main()
