"""Pull-off of a JKR sphere on coarse grids by both criteria of detachment, for docs/adhesion.md.

About three minutes. `pull_off.csv` has the pull-off force from 40 depths and places of the apex,
each reached directly and by two random sequences of steps.
"""

from __future__ import annotations

import math

import numpy as np

from evidence.shared import write_table
from restitution import Body, Contact, Grid, Pair, Surface, solve
from restitution.case.models import adhesion_of
from restitution.contact.jkr.separation import separate, separation_of
from restitution.contact.loading import step
from restitution.theory import JKR

OFFSETS = ((0, 0), (0.5, 0.5), (0.5, 0), (0.23, 0.41), (0.37, 0.12), (0.08, 0.29))
W = 0.09
DEPTHS = 1e-9 * np.array([2, 3, 5, 8, 12, 20, 30, 50])
CASES = 40


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
    contact = Contact(
        pair,
        surface,
        adhesion=adhesion_of(work_of_adhesion=W, approach=approach, detachment=detachment),
    )
    return contact, deep


def pull_off(nodes, offset, detachment, depth=None):
    """Pull-off force over its exact value, from `depth` (m) or from three break indentations."""
    contact, deep = sphere(nodes, offset, detachment, depth)
    path = list(separate(solve(contact, deep)))
    exact = JKR(250e-6, contact.pair.contact_modulus, W).pull_off_force
    return separation_of(path).pull_off_force / float(exact)


def by_steps(state, end, rng):
    """Unload from `state` to the indentation `end` (m) in a random number of random steps."""
    depths = np.sort(rng.uniform(end, state.indentation, rng.integers(0, 6)))[::-1]
    for depth in (*depths, end):
        state = step(state, float(depth), residual=1e-4)
    return state


def random_case(number, nodes=8):
    """Pull-off force over its exact value from a random depth, directly and after random steps.

    Depths are 0.01 to 12 break indentations. One apex in four lies on a node, and one in eight in
    the middle of four nodes.
    """
    rng = np.random.default_rng(number)
    deep, offset = math.exp(rng.uniform(math.log(0.01), math.log(12))), rng.uniform(0, 0.5, 2)
    if number % 4 == 0 or number % 8 == 1:
        offset[:] = 0.5 * (number % 4)
    body = sphere(nodes, offset, "crack-closure", None)[0].pair
    smooth = JKR(body.radius, body.contact_modulus, W)
    scale, h = -float(smooth.break_indentation), float(smooth.pull_off_radius) / nodes
    contact, _ = sphere(nodes, offset, "crack-closure", max(deep, 3) * scale, "equilibrium")
    later = float(h * h * np.sum(np.minimum(offset, 1 - offset) ** 2) / (2 * body.radius))
    state = solve(contact, max(deep * scale - later, 1e-13))
    found = [state]
    for _ in range(2):
        end = rng.uniform(-0.25, min(0.9 * deep, 0.5)) * scale - later
        found.append(by_steps(state, min(end, 0.9 * state.indentation), rng))
    forces = [separation_of(list(separate(each))).pull_off_force for each in found]
    direct, *others = np.array(forces) / float(smooth.pull_off_force)
    return {
        "case": number,
        "depth_over_break_indentation": round(deep, 4),
        "offset_x": round(float(offset[0]), 3),
        "offset_y": round(float(offset[1]), 3),
        "direct": round(float(direct), 4),
        "steps_1": round(float(others[0]), 4),
        "steps_2": round(float(others[1]), 4),
    }


def row(what, found):
    """Print one row of the table."""
    print(
        f"| {what} | {np.mean(found):.3f} | {np.min(found):.3f} | {np.max(found):.3f} |", flush=True
    )


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
    rows = [random_case(number) for number in range(CASES)]
    write_table("pull_off/pull_off.csv", rows)
    found = np.array([[each[name] for name in ("direct", "steps_1", "steps_2")] for each in rows])
    row(f"crack-closure, {CASES} random depths and apexes, random steps | 8", found.ravel())
    off = np.abs(found[:, 1:] - found[:, :1])
    print(f"by other steps: {np.sqrt(np.mean(off**2)):.4f} rms, {off.max():.4f} at worst")


if __name__ == "__main__":
    main()
