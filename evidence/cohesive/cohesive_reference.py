"""Axisymmetric reference for `cohesive`: a smooth elastic sphere with a Lennard-Jones law.

Writes `cohesive_reference.csv`, with two meshes for each Tabor parameter. About ten minutes.

This code shares no code with `restitution`. It has rings of constant pressure instead of square
cells and dense matrices instead of FFTs. It follows the whole equilibrium curve, stable or not, by
arc length. The points of instability are turning points of this curve.

All quantities are normalised: E* = 1, w = 1, z0 = 1, and therefore R* = mu^3.
"""

from __future__ import annotations

import csv
import sys
from pathlib import Path

import numpy as np
from scipy.special import ellipe, ellipkm1

TABOR = (0.1, 0.5, 1.0, 2.0, 3.0, 5.0)
MESHES = (1, 2)  # factors on the number of rings
JKR_HYSTERESIS = 7.0922  # energy lost in a cycle, in units of (w^5 R^4/E*^2)^(1/3)


def traction(g):
    """Attraction per area at the gap g."""
    return 8 / 3 * (g**-3.0 - g**-9.0)


def stiffness(g):
    """Slope of the traction."""
    return 8 * (3 * g**-10.0 - g**-4.0)


def disc(r, a):
    """Displacement at r due to a unit pressure on a disc of radius a (Johnson 1985, eq. 3.24)."""
    inside = r < a
    s = np.where(inside, r, a) / np.where(inside, a, r)
    within = 4 * a / np.pi * ellipe(s * s)
    with np.errstate(divide="ignore", invalid="ignore"):
        beyond = ellipe(s * s) - np.where(s < 1, (1 - s * s) * ellipkm1(1 - s * s), 0.0)
    return np.where(inside, within, 4 * r / np.pi * beyond)


class Sphere:
    """Rings around the axis: fine in the contact and its cohesive zone, wider outside."""

    def __init__(self, mu, factor, depth):
        self.R = mu**3
        reach = np.sqrt(2 * self.R * max(depth, 0.0)) + 1.5 * self.R ** (2 / 3)
        fine = min(0.12, 0.02 * np.sqrt(self.R)) / factor
        inner = min(reach, 1.2 * np.sqrt(2 * self.R * (6 + depth)))
        edges = [*np.arange(0, inner, fine)]
        growth = 1 + 0.04 / factor
        while edges[-1] < np.sqrt(2 * self.R * 60):
            edges.append(edges[-1] + growth * (edges[-1] - edges[-2]))
        edges = np.array(edges)
        self.r = 0.5 * (edges[1:] + edges[:-1])
        self.area = np.pi * np.diff(edges**2)
        outer = disc(self.r[:, None], edges[None, 1:])
        within = np.zeros_like(outer)
        within[:, 1:] = disc(self.r[:, None], edges[None, 1:-1])
        self.A = outer - within
        self.h0 = self.r**2 / (2 * self.R)
        # The rigid rest of the paraboloid, beyond the last ring (Bradley's integral).
        self.last = edges[-1] ** 2 / (2 * self.R)

    def tail(self, delta):
        """Attraction outside the mesh."""
        g = 1 + self.last - delta
        return 2 * np.pi * self.R * 8 / 3 * (g**-2 / 2 - g**-8 / 8)

    def force(self, g, delta):
        """Normal force, positive in compression."""
        return -float(self.area @ traction(g)) - self.tail(delta)

    def curve(self, start, deepest, step):
        """Approach, force and smallest gap along the equilibrium curve, by arc length."""
        n = self.r.size
        g, delta = 1 + self.h0 - start, start
        direction = np.zeros(n + 1)
        direction[-1] = 1.0
        weight = self.area / self.area.max()
        found = []
        ds = step
        while delta < deepest:
            # Predict along the tangent, correct with Newton's method on the arc.
            J = np.eye(n) + self.A * stiffness(g)
            tangent = np.linalg.solve(J, -np.ones(n))
            full = np.append(tangent, 1.0)
            full /= np.sqrt((weight * full[:-1] ** 2).sum() / weight.sum() + full[-1] ** 2)
            product = (weight * full[:-1] * direction[:-1]).sum() / weight.sum()
            if product + full[-1] * direction[-1] < 0:
                full = -full
            while True:
                new, at, ok = g + ds * full[:-1], delta + ds * full[-1], False
                for _ in range(12):
                    if new.min() < 0.3:
                        break
                    res = new - 1 - self.h0 + at + self.A @ traction(new)
                    moved = (weight * full[:-1] * (new - g)).sum() / weight.sum()
                    arc = moved + full[-1] * (at - delta) - ds
                    J = np.eye(n) + self.A * stiffness(new)
                    both = np.linalg.solve(J, np.column_stack((-res, -np.ones(n))))
                    row = weight * full[:-1] / weight.sum()
                    change = (-arc - row @ both[:, 0]) / (row @ both[:, 1] + full[-1])
                    new, at = new + both[:, 0] + change * both[:, 1], at + change
                    if max(np.abs(both[:, 0] + change * both[:, 1]).max(), abs(change)) < 1e-9:
                        ok = True
                        break
                if ok and np.abs(new - g).max() < 0.35:
                    break
                ds *= 0.5
                if ds < 1e-7:
                    raise RuntimeError("the equilibrium curve could not be followed")
            g, delta, direction = new, at, full
            found.append((delta, self.force(g, delta), g.min()))
            ds = min(1.3 * ds, step)
        return np.array(found)


def energies(curve):
    """Turning points of the curve, and the energy lost in a cycle of approach and separation."""
    delta, force = curve[:, 0], curve[:, 1]
    turn = np.sign(np.diff(delta))
    folds = np.flatnonzero(turn[1:] != turn[:-1]) + 1
    if folds.size == 0:
        return float("nan"), float("nan"), 0.0
    first, last = int(folds[0]), int(folds[-1])
    # The area of the loop between the branches: along the curve from the lower end of the loading
    # branch through both folds, the integral of F dδ over the unstable part closes it.
    delta_in, delta_out = delta[first], delta[last]
    up = slice(0, first + 1)
    down = slice(last, None)
    grid = np.linspace(delta_out, delta_in, 4001)
    loading = np.interp(grid, delta[up], force[up])
    back = np.interp(grid, delta[down], force[down])
    return delta_in, delta_out, float(np.trapezoid(loading - back, grid))


def row(mu, factor):
    """The reference values for one Tabor parameter on one mesh."""
    depth = 3 + 3 * mu
    sphere = Sphere(mu, factor, depth)
    curve = sphere.curve(-12.0, depth, 0.1 / factor)
    delta_in, delta_out, lost = energies(curve)
    unit = (mu**12) ** (1 / 3)
    return {
        "tabor_parameter": mu,
        "rings": sphere.r.size,
        "pull_off_over_jkr": round(-curve[:, 1].min() / (1.5 * np.pi * sphere.R), 5),
        "jump_in_over_z0": round(delta_in, 4),
        "jump_out_over_z0": round(delta_out, 4),
        "hysteresis": round(lost / unit, 5),
        "hysteresis_over_jkr": round(lost / unit / JKR_HYSTERESIS, 5),
    }


def main():
    """Compute and store all rows."""
    rows = []
    for mu in TABOR if len(sys.argv) == 1 else [float(x) for x in sys.argv[1:]]:
        for factor in MESHES:
            rows.append(row(mu, factor))
            print(rows[-1], flush=True)
    if len(sys.argv) > 1:
        return
    with open(Path(__file__).with_suffix(".csv"), "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
