"""Error bars of adhesive COR in blind cases: random smooth elastic spheres against exact JKR.

Radius, Young's modulus, work of adhesion, indentation and spacing are random; no constant was
chosen on these cases. Writes `jkr_blind.csv` and prints how many errors of COR are within
`restitution_error`. Takes half a minute.
"""

from __future__ import annotations

import math

import numpy as np

from evidence.shared import write_table
from restitution import Body, Contact, Grid, Pair, collide, smooth, solve
from restitution.contact.jkr.limit import JKRLimit
from restitution.theory import JKR

SEED, CASES, LARGEST_GRID = 20261125, 40, 300


def cases() -> list[tuple[Contact, JKR, float, float]]:
    """Contact, closed form, indentation (m) and a_c/h of each case."""
    rng, found = np.random.default_rng(SEED), []
    while len(found) < CASES:
        radius, modulus = 10 ** rng.uniform(-5, -3), 10 ** rng.uniform(9, 11.3)
        w, cells = 10 ** rng.uniform(-2.5, -0.7), rng.uniform(3, 20)
        body = Body(radius, modulus, 0.3, 3000.0)
        pair = Pair(body, body)
        jkr = JKR(pair.radius, pair.contact_modulus, w)
        a_c = (9 * math.pi * w * pair.radius**2 / (8 * pair.contact_modulus)) ** (1 / 3)
        depth, h = float(jkr.adhesive_length) * 10 ** rng.uniform(0.2, 1.1), a_c / cells
        nodes = int(3.2 * math.sqrt(pair.radius * depth + 4 * a_c**2) / h) + 8
        if nodes <= LARGEST_GRID:
            surface = smooth(Grid((nodes, nodes), (h, h)))
            found.append((Contact(pair, surface, adhesion=JKRLimit(w)), jkr, depth, cells))
    return found


def main() -> None:
    """Compute all cases, write the table and print a summary."""
    rows = []
    for contact, jkr, depth, cells in cases():
        collision = collide(solve(contact, depth))
        exact = float(jkr.restitution_at_indentation(depth))
        rows.append(
            {
                "a_c_over_h": f"{cells:.2f}",
                "nodes": contact.grid.nodes[0],
                "restitution": f"{collision.restitution:.5f}",
                "restitution_error": f"{collision.restitution_error:.5f}",
                "restitution_jkr": f"{exact:.5f}",
                "pull_off_over_jkr": f"{collision.pull_off_force / jkr.pull_off_force:.4f}",
            }
        )
    write_table("jkr_blind/jkr_blind.csv", rows)
    off = [abs(float(row["restitution"]) - float(row["restitution_jkr"])) for row in rows]
    errors = [float(row["restitution_error"]) for row in rows]
    held = [one <= error for one, error in zip(off, errors, strict=True)]
    moving = [one / error for one, error in zip(off, errors, strict=True) if error > 0]
    pull_off = [float(row["pull_off_over_jkr"]) for row in rows]
    print(f"{sum(held)} of {len(rows)} within the error; {len(rows) - len(moving)} stick")
    print(f"largest part of the error that is needed: {max(moving):.2f}")
    print(f"pull-off force over JKR: {min(pull_off):.3f} to {max(pull_off):.3f}")


if __name__ == "__main__":
    main()
