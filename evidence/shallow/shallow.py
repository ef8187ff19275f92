"""The paper's claims about 8 and 50 nm, checked on its grid and on a grid eight times finer.

Writes evidence/shallow/shallow.csv and docs/images/shallow.png. Half a minute:
`python -m evidence.shallow.shallow`.
"""

from __future__ import annotations

import numpy as np

from evidence.shared import PAIR, write_image, write_table
from restitution import Contact, Grid, collide, generate_surface, refine, solve
from restitution.contact.checks.resolution import median_patch, resolves
from restitution.contact.plasticity.bound import ConstantBound
from restitution.plots.cor import cor_axis
from restitution.plots.figure import PALETTE, SYMBOLS, Axis, Chart, Figure, Mark, Points

GRID = Grid((256, 256), (0.25e-6, 0.25e-6))
ROUGHNESS = (0.1e-6, 0.2e-6, 0.5e-6, 1e-6)
SEEDS = (1, 2, 3)
FACTORS = (1, 8)
DEPTHS = np.geomspace(0.5e-9, 100e-9, 16)


def rows():
    """Restitution at every depth of every surface on both grids."""
    for rms in ROUGHNESS:
        for seed in SEEDS:
            coarse = generate_surface(
                GRID, kind="gaussian", rms=rms, correlation_length=2e-6, seed=seed
            )
            for k in FACTORS:
                contact = Contact(PAIR, refine(coarse, k), plasticity=ConstantBound(750e6))
                for depth in DEPTHS:
                    state = solve(contact, depth)
                    patches = state.patch_sizes()
                    yield {
                        "rms_m": rms,
                        "seed": seed,
                        "refine": k,
                        "depth_m": depth,
                        "restitution": collide(state).restitution,
                        "contact_nodes": state.contact_nodes,
                        "patches": patches.size,
                        "resolved": resolves(median_patch(patches)),
                    }


def draw(table):
    """COR against depth, a panel for each grid."""
    panels = {}
    for k in FACTORS:
        panels[k] = series = [Mark("x", depth, f"{depth} nm") for depth in (8, 50)]
        for number, rms in enumerate(ROUGHNESS):
            for seed in SEEDS:
                these = [r for r in table if (r["rms_m"], r["seed"], r["refine"]) == (rms, seed, k)]
                x, y = (np.array([r[key] for r in these]) for key in ("depth_m", "restitution"))
                series.append(
                    Points(
                        1e9 * x,
                        y,
                        f"Rq = {1e6 * rms:g} µm",
                        color=PALETTE[number],
                        symbol=SYMBOLS[number],
                        joined=True,
                        open=np.array([not r["resolved"] for r in these]),
                    )
                )
    x, y = Axis("maximum indentation", "nm", "log"), cor_axis([*panels[1], *panels[8]])
    charts = [
        Chart(x, y, series, f"spacing {250 / k:g} nm (open: not resolved)")
        for k, series in panels.items()
    ]
    write_image("shallow", Figure("", charts))


def main():
    """Compute, print and draw."""
    table = list(rows())
    write_table("shallow/shallow.csv", table)
    draw(table)
    print("| depth, nm | grid | one node | COR at Rq = 0.1, 0.2, 0.5, 1 µm (means of 3) |")
    print("|---|---|---|---|")
    for depth in DEPTHS[::3]:
        for k in FACTORS:
            these = [r for r in table if r["depth_m"] == depth and r["refine"] == k]
            single = sum(r["contact_nodes"] == 1 for r in these)
            means = [
                np.mean([r["restitution"] for r in these if r["rms_m"] == rms]) for rms in ROUGHNESS
            ]
            print(
                f"| {1e9 * depth:.3g} | {250 / k:g} nm | {single} of {len(these)} | "
                + ", ".join(f"{m:.2f}" for m in means)
                + " |"
            )


if __name__ == "__main__":
    main()
