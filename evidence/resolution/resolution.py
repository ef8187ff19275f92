"""How many nodes a contact needs: restitution on one surface, refined, against its finest grid.

Writes evidence/resolution/resolution.csv and docs/images/resolution.png. Half a minute:
`python -m evidence.resolution.resolution`.

Every grid is pressed to the same depth below the highest point of the finest grid, so that the
position of first touch between the nodes does not affect the comparison.
"""

from __future__ import annotations

import numpy as np

from evidence.shared import PAIR, write_image, write_table
from restitution import Contact, Grid, collide, generate_surface, refine, solve
from restitution.contact.checks.resolution import NODES_PER_PATCH, median_patch
from restitution.contact.plasticity.bound import ConstantBound
from restitution.plots.figure import GREY, Axis, Band, Chart, Figure, Mark, Points
from restitution.runs.convergence import discretisation

GRID = Grid((256, 256), (0.25e-6, 0.25e-6))
FACTORS = (1, 2, 4, 8)
DEPTHS = np.array([5, 8, 20, 50, 100, 200, 400]) * 1e-9
SURFACES = (
    {"kind": "gaussian", "rms": 0.5e-6, "correlation_length": 5e-6},
    {"kind": "gaussian", "rms": 0.1e-6, "correlation_length": 2e-6},
    {"kind": "self-affine", "rms": 0.2e-6, "hurst": 0.8, "rolloff": 20e-6, "shortest": 2e-6},
)
SEEDS = (1, 2, 3, 4)


def rows():
    """Restitution and patches on every grid of every surface."""
    for number, kind in enumerate(SURFACES):
        for seed in SEEDS:
            coarse = generate_surface(GRID, seed=seed, **kind)
            contacts = {
                k: Contact(PAIR, refine(coarse, k), plasticity=ConstantBound(750e6))
                for k in FACTORS
            }
            # All grids contain the coarse nodes, where the gaps differ only by the shift of first
            # touch.
            finest = contacts[FACTORS[-1]].gap[:: FACTORS[-1], :: FACTORS[-1]]
            for k, contact in contacts.items():
                later = float((finest - contact.gap[::k, ::k]).mean())
                for depth in DEPTHS:
                    if depth <= later:
                        continue
                    state = solve(contact, depth - later)
                    patches = state.patch_sizes()
                    yield {
                        "surface": number,
                        "seed": seed,
                        "refine": k,
                        "depth_m": depth,
                        "restitution": collide(state).restitution,
                        "contact_nodes": state.contact_nodes,
                        "patches": patches.size,
                        "largest_patch_nodes": int(patches[0]),
                        "median_patch_nodes": median_patch(patches),
                    }


def errors(table):
    """Relative error against the finest grid, beside the nodes of the patches."""
    finest = {
        (row["surface"], row["seed"], row["depth_m"]): row["restitution"]
        for row in table
        if row["refine"] == FACTORS[-1]
    }
    for row in table:
        if row["refine"] != FACTORS[-1]:
            exact = finest[row["surface"], row["seed"], row["depth_m"]]
            yield (
                row["largest_patch_nodes"],
                row["median_patch_nodes"],
                row["restitution"] / exact - 1,
            )


def estimates(table):
    """Errors of the last grid but one: as `converge` states it, by Richardson, and the true one."""
    cor = {}
    for row in table:
        case = row["surface"], row["seed"], row["depth_m"]
        cor.setdefault(case, {})[row["refine"]] = row["restitution"]
    for values in cor.values():
        if len(values) == len(FACTORS):
            *stated, exact = (values[k] for k in FACTORS)
            yield discretisation(stated)[0], richardson(stated), abs(stated[-1] - exact)


def richardson(values):
    """The grid convergence index (Roache 1994), order within 0.5 to 2; NaN if not monotone."""
    before, last = np.diff(values)
    if before * last <= 0 or abs(last) >= abs(before):
        return np.nan
    order = np.clip(np.log2(before / last), 0.5, 2)
    return 1.25 * abs(last) / (2**order - 1)


def main():
    """Compute, print and draw."""
    table = list(rows())
    write_table("resolution/resolution.csv", table)
    largest, median, off = np.array(list(errors(table))).T
    print("| nodes | cases | rms | 90 % within | worst |\n|---|---|---|---|---|")
    for name, nodes in (("largest patch", largest), ("median patch", median)):
        for low, high in ((1, 2), (2, 5), (5, 10), (10, 20), (20, 50), (50, 200), (200, np.inf)):
            those = np.abs(off[(low <= nodes) & (nodes < high)])
            if those.size:
                rms, most = np.sqrt(np.mean(those**2)), np.quantile(those, 0.9)
                print(
                    f"| {name}, {low} to {high} | {those.size} | {rms:.1%} | {most:.1%} "
                    f"| {those.max():.1%} |"
                )
    stated, usual, true = np.array(list(estimates(table))).T
    print(f"discretisation error held in {np.mean(true <= stated):.1%} of {true.size}")
    monotone = np.isfinite(usual)
    held = np.mean((true <= usual)[monotone])
    print(f"Richardson's in {held:.1%} of the {np.count_nonzero(monotone)} that are monotone")
    draw(median, off)


def draw(median, off):
    """The error of COR against the nodes in the median patch."""
    ends = np.array([median.min(), median.max()])
    series = [
        Band(ends, np.full(2, -2.0), np.full(2, 2.0), "± 2 %", color=GREY),
        Points(median, 100 * off, "one contact on one grid"),
        Mark("x", NODES_PER_PATCH, f"{NODES_PER_PATCH} nodes: resolved from here on"),
    ]
    x = Axis("nodes in the patch of the median node", "", "log")
    y = Axis("COR over that of the finest grid − 1", "%")
    write_image("resolution", Figure("One surface on four grids", [Chart(x, y, series)]))


if __name__ == "__main__":
    main()
