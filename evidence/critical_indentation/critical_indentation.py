"""Depth from which a rough sphere rebounds like a smooth one: i_cr,max against roughness.

Writes the table beside it and docs/images/critical-indentation.png. Some minutes.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import linregress, t

from evidence.shared import PAIR, STEEL, write_image, write_table
from restitution import Contact, Grid, collide, generate_surface, smooth, solve
from restitution.contact.plasticity.bound import ConstantBound
from restitution.plots.figure import (
    DASHED,
    PALETTE,
    SOLID,
    SYMBOLS,
    Axis,
    Chart,
    Figure,
    Line,
    Points,
)

GRID = Grid((960, 960), (0.25e-6, 0.25e-6))
ROUGHNESS = (0.1e-6, 0.2e-6, 0.5e-6, 1e-6)
LENGTHS = (2e-6, 5e-6)  # correlation lengths (m)
SEEDS = (1, 2, 3, 4, 5)
DEPTHS = np.geomspace(0.1e-6, 20e-6, 28)
WITHIN = 0.05


def restitutions(contact):
    """COR at every depth."""
    return np.array([collide(solve(contact, depth)).restitution for depth in DEPTHS])


def critical(off):
    """Depth beyond which |`off`| stays below 5 %, interpolated in the logarithm of depth, or NaN.

    `off` is the relative difference of COR from that of the smooth sphere.
    """
    outside = np.flatnonzero(np.abs(off) > WITHIN)
    if outside.size == 0 or outside[-1] == DEPTHS.size - 1:
        return np.nan
    k = outside[-1]
    share = (abs(off[k]) - WITHIN) / (abs(off[k]) - abs(off[k + 1]))
    return float(np.exp(np.log(DEPTHS[k]) + share * np.log(DEPTHS[k + 1] / DEPTHS[k])))


def fit(length, x, y):
    """Fit a straight line and a power law to the known depths; print both, return the line."""
    known = ~np.isnan(y)
    line, power = linregress(x[known], y[known]), linregress(np.log(x[known]), np.log(y[known]))
    student = t.ppf(0.975, known.sum() - 2)
    print(
        f"correlation length {1e6 * length:g} um: {known.sum()} of {known.size} reached; "
        f"i_cr,max = a + b Rq/R with b = {1e6 * line.slope:.0f} ± "
        f"{1e6 * student * line.stderr:.0f} um, a = {1e6 * line.intercept:.2f} ± "
        f"{1e6 * student * line.intercept_stderr:.2f} um (95 %), r² = {line.rvalue**2:.3f}; "
        f"power law {power.slope:.2f} ± {student * power.stderr:.2f}"
    )
    for ratio in np.unique(x):
        found = 1e6 * y[known & (x == ratio)]
        print(
            f"| {1e6 * length:g} | {1e6 * STEEL.radius * ratio:g} | {found.size} of 5 | "
            f"{found.mean():.2f} ± {found.std(ddof=1):.2f} |"
        )
    return line


def main():
    """Compute, print and draw."""
    reference = restitutions(Contact(PAIR, smooth(GRID), plasticity=ConstantBound(750e6)))
    table = []
    for length in LENGTHS:
        for rms in ROUGHNESS:
            for seed in SEEDS:
                surface = generate_surface(
                    GRID, kind="gaussian", rms=rms, correlation_length=length, seed=seed
                )
                off = (
                    restitutions(Contact(PAIR, surface, plasticity=ConstantBound(750e6)))
                    / reference
                    - 1
                )
                table.append(
                    {
                        "correlation_length_m": length,
                        "rms_m": rms,
                        "seed": seed,
                        "critical_m": critical(off),
                    }
                )
    write_table("critical_indentation/critical_indentation.csv", table)
    draw(table)


def draw(table):
    """i_cr,max against Rq/R, with a straight line for each correlation length."""
    series = []
    for number, length in enumerate(LENGTHS):
        these = [row for row in table if row["correlation_length_m"] == length]
        x = np.array([row["rms_m"] for row in these]) / STEEL.radius
        y = np.array([row["critical_m"] for row in these])
        line = fit(length, x, y)
        ends = np.array([0, x.max()])
        style = {"label": f"β = {1e6 * length:g} µm", "color": PALETTE[number]}
        series += [
            Points(
                1e3 * x, 1e6 * y, symbol=SYMBOLS[number], open=np.full(x.size, number > 0), **style
            ),
            Line(
                1e3 * ends,
                1e6 * (line.intercept + line.slope * ends),
                dash=(SOLID, DASHED)[number],
                **style,
            ),
        ]
    chart = Chart(Axis("Rq/R", "10⁻³"), Axis("i_cr,max", "µm"), series)
    title = "Depth beyond which roughness no longer changes COR"
    write_image("critical-indentation", Figure(title, [chart]))


if __name__ == "__main__":
    main()
