"""Pull-off of a JKR sphere on coarse grids, both criteria: the table in docs/adhesion.md.

`python docs/studies/pull_off.py`; about a minute.
"""

from __future__ import annotations

import numpy as np

from restitution import Body, Contact, Grid, Pair, Surface, solve
from restitution.contact.separation import separate, separation_of
from restitution.theory import jkr

OFFSETS = ((0, 0), (0.5, 0.5), (0.5, 0), (0.23, 0.41), (0.37, 0.12), (0.08, 0.29))
W = 0.09


def sphere(nodes_over_pull_off_radius, offset, detachment, approach="hertzian"):
    """A contact whose apex lies `offset` cells beside a node, and its break indentation."""
    body = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850)
    pair = Pair(body, body)
    material = pair.radius, pair.contact_modulus, W
    h = float(jkr.pull_off_radius(*material)) / nodes_over_pull_off_radius
    deep = -3 * float(jkr.break_indentation(*material))
    n = 2 * int(1.5 * np.sqrt(2.8 * pair.radius * deep) / h + 6) + 1
    grid = Grid((n, n), (h, h))
    x, y = grid.x[:, None], grid.y[None, :]
    shifted = (x - offset[0] * h) ** 2 + (y - offset[1] * h) ** 2
    height = (x * x + y * y - shifted) / (2 * pair.radius)
    surface = Surface(height, grid, {"source": "shifted apex"})
    contact = Contact(pair, surface, work_of_adhesion=W, approach=approach, detachment=detachment)
    return contact, deep


def main():
    """Print the table."""
    F_c = float(jkr.pull_off_force(250e-6, W))
    print("| criterion | a_c/h | pull-off / exact: mean | least | most |")
    print("|---|---|---|---|---|")
    for detachment in ("pohrt-popov", "crack-closure"):
        for nodes in (2, 4, 8, 16):
            found = []
            for offset in OFFSETS if nodes < 16 else OFFSETS[::3]:
                contact, deep = sphere(nodes, offset, detachment)
                path = list(separate(solve(contact, deep)))
                found.append(separation_of(path).pull_off_force / F_c)
            print(
                f"| {detachment} | {nodes} | {np.mean(found):.3f} | {min(found):.3f} | "
                f"{max(found):.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
