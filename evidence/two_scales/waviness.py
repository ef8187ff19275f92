r"""Pull-off forces of wavy spheres in the JKR limit, beside the exact ones of axisymmetric waves.

    python -m evidence.two_scales.waviness

writes waviness.csv. The height of the waves is A cos(2πr/λ). Its exact solution for a contact
without holes is that of Guduru (2007), J. Mech. Phys. Solids 55, 473–488.
"""

from __future__ import annotations

import csv
import math
import time
from pathlib import Path

import numpy as np
from scipy.special import struve

from restitution import Body, Contact, Grid, JKRLimit, Pair, Surface, collide, solve
from restitution.theory import JKR

TABLE = Path(__file__).with_suffix(".csv")
W = 0.09
STEEL = Body(radius=500e-6, youngs_modulus=210e9, poissons_ratio=0.25, density=7850.0)
PAIR = Pair(STEEL, STEEL)
SMOOTH = JKR(PAIR.radius, PAIR.contact_modulus, W)
F_C, A_C = float(SMOOTH.pull_off_force), float(SMOOTH.pull_off_radius)
DEEPEST, NODES = 2.0, 16  # contact radius and nodes in pull-off radii
WAVES = ((1.0, 0.15), (1.0, 0.3), (1.0, 0.6), (0.5, 0.15), (0.5, 0.3), (0.5, 0.6))


def exact(length: float, amplitude: float, deepest: float) -> tuple[float, float]:
    """Indentation (m) with the contact radius `deepest` (m), and pull-off force (N) from there."""
    E, k = PAIR.contact_modulus, 2 * math.pi / length
    a = np.linspace(0.0, deepest, 200_001)[1:]
    g = a**2 / PAIR.radius + amplitude * k * a * 0.5 * math.pi * struve(0, k * a)
    depth = g - np.sqrt(2 * math.pi * a * W / E)
    whole = np.cumsum(g) * (a[1] - a[0])
    force = 2 * E * (depth * a - whole)
    # The edge stands still until the indentation is below all that it has passed.
    passed = np.minimum.accumulate(depth[::-1])[::-1]
    return float(depth[-1]), -float(force[depth <= passed].min())


def computed(length: float, amplitude: float, depth: float, nodes: int) -> float:
    """Pull-off force (N) with `nodes` cells in the pull-off radius of the smooth sphere."""
    h = A_C / nodes
    n = 2 * int(1.6 * DEEPEST * nodes) + 1
    grid = Grid((n, n), (h, h))
    r = np.hypot(grid.x[:, None], grid.y[None, :])
    height = amplitude * (np.cos(2 * math.pi * r / length) - 1)
    surface = Surface(height, grid, {"source": "waves"})
    state = solve(Contact(PAIR, surface, adhesion=JKRLimit(W)), depth)
    return collide(state).pull_off_force


def main() -> None:
    rows = []
    for wave, share in WAVES:
        length = wave * A_C
        # Johnson's parameter of the waves is (2 w λ/(π² E* A²))^½.
        amplitude = share * math.sqrt(2 * W * length / (math.pi**2 * PAIR.contact_modulus))
        began = time.process_time()
        depth, force = exact(length, amplitude, DEEPEST * A_C)
        found = [computed(length, amplitude, depth, nodes) for nodes in (NODES // 2, NODES)]
        rows.append(
            {
                "wave_over_pull_off_radius": wave,
                "johnson_parameter": f"{1 / share:.3g}",
                "amplitude_nm": f"{1e9 * amplitude:.3g}",
                "exact_over_smooth": f"{force / F_C:.3f}",
                f"computed_{NODES // 2}_nodes": f"{found[0] / F_C:.3f}",
                f"computed_{NODES}_nodes": f"{found[1] / F_C:.3f}",
                "seconds": f"{time.process_time() - began:.1f}",
            }
        )
        print(*rows[-1].values(), flush=True)
    with open(TABLE, "w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


if __name__ == "__main__":
    main()
