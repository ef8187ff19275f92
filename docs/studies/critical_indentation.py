"""From which depth on a rough sphere bounces as a smooth one: i_cr,max against roughness.

Writes docs/studies/critical_indentation.csv and docs/images/critical-indentation.png. Some minutes:
`python docs/studies/critical_indentation.py`.
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from scipy.stats import linregress, t

from restitution import Body, Contact, Grid, Pair, collide, generate_surface, smooth, solve

HERE = Path(__file__).parent
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25)
PAIR = Pair(STEEL, STEEL)
GRID = Grid((960, 960), (0.25e-6, 0.25e-6))
ROUGHNESS = (0.1e-6, 0.2e-6, 0.5e-6, 1e-6)
SEEDS = (1, 2, 3, 4, 5)
DEPTHS = np.geomspace(0.1e-6, 20e-6, 28)
WITHIN = 0.05


def restitutions(contact):
    """COR at every depth."""
    return np.array([collide(solve(contact, depth)).restitution for depth in DEPTHS])


def critical(off):
    """Depth from which on |off| stays within 5 %, interpolated in log δ; NaN if it never does."""
    outside = np.flatnonzero(np.abs(off) > WITHIN)
    if outside.size == 0 or outside[-1] == DEPTHS.size - 1:
        return np.nan
    k = outside[-1]
    share = (abs(off[k]) - WITHIN) / (abs(off[k]) - abs(off[k + 1]))
    return float(np.exp(np.log(DEPTHS[k]) + share * np.log(DEPTHS[k + 1] / DEPTHS[k])))


def main():
    """Compute, print and draw."""
    reference = restitutions(Contact(PAIR, smooth(GRID), 750e6))
    table = []
    for rms in ROUGHNESS:
        for seed in SEEDS:
            surface = generate_surface(
                GRID, kind="gaussian", rms=rms, correlation_length=2e-6, seed=seed
            )
            off = restitutions(Contact(PAIR, surface, 750e6)) / reference - 1
            table.append({"rms_m": rms, "seed": seed, "critical_m": critical(off)})
            print(table[-1], flush=True)
    with open(HERE / "critical_indentation.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, list(table[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)
    x = np.array([row["rms_m"] for row in table]) / STEEL.radius
    y = np.array([row["critical_m"] for row in table])
    known = ~np.isnan(y)
    line = linregress(x[known], y[known])
    student = t.ppf(0.975, known.sum() - 2)
    print(f"{known.sum()} of {known.size} reached; i_cr,max = a + b Rq/R with "
          f"b = {1e6 * line.slope:.0f} ± {1e6 * student * line.stderr:.0f} um, "
          f"a = {1e6 * line.intercept:.2f} ± {1e6 * student * line.intercept_stderr:.2f} um "
          f"(95 %), r² = {line.rvalue**2:.3f}")  # fmt: skip
    power = linregress(np.log(x[known]), np.log(y[known]))
    print(f"power law: exponent {power.slope:.2f} ± {student * power.stderr:.2f}, "
          f"r² = {power.rvalue**2:.3f}")  # fmt: skip
    for rms in ROUGHNESS:
        found = y[known & (x == rms / STEEL.radius)]
        print(f"| {1e6 * rms:g} | {1e6 * found.mean():.2f} ± {1e6 * found.std(ddof=1):.2f} |")
    figure = Figure(figsize=(6.4, 4.4), layout="constrained")
    FigureCanvasAgg(figure)
    axes = figure.add_subplot(
        xlabel="Rq/R (10⁻³)", ylabel="i_cr,max (µm)",
        title="Depth from which on a rough sphere bounces as a smooth one",
    )  # fmt: skip
    axes.plot(1e3 * x, 1e6 * y, "o", ms=4, alpha=0.7, label="five surfaces each")
    fine = np.array([0, x.max()])
    axes.plot(1e3 * fine, 1e6 * (line.intercept + line.slope * fine), "-", color="0.4",
              label="straight line")  # fmt: skip
    axes.grid(alpha=0.3)
    axes.legend()
    figure.savefig(HERE.parent / "images" / "critical-indentation.png", dpi=150)


if __name__ == "__main__":
    main()
