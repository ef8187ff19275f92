"""Adhesion of nominally flat rough bodies, for the table of docs/periodic.md.

Steel on steel, self-affine surfaces (H = 0.8, one seed) in a period of 4.8 µm, loaded to 0.9 of the
mean gap at first touch and separated; each on two grids.
"""

from __future__ import annotations

import math

import restitution as rs
from restitution.contact.jkr.separation import separate, separation_of
from restitution.contact.models import COMPANION
from restitution.theory import LennardJones

WORK = 0.05  # J/m²
WALL = rs.Body(radius=math.inf, youngs_modulus=210e9, poissons_ratio=0.3)
PAIR = rs.Pair(WALL, WALL)
LARGEST = float(LennardJones(WORK, 0.3e-9).largest_traction)


def line(rms: float, cells: int) -> str:
    """Compute one surface on a grid with `cells` times 64 nodes on a side."""
    coarse = rs.generate_surface(
        rs.Grid(64, 75e-9),
        kind="self-affine",
        rms=rms,
        hurst=0.8,
        rolloff=2.4e-6,
        shortest=0.6e-6,
        seed=1,
    )
    surface = rs.refine(coarse, cells) if cells > 1 else coarse
    # Cells of 75 nm are coarser than the program accepts, except for a comparison of grids.
    surface = rs.Surface(surface.height, surface.grid, {COMPANION: True})
    contact = rs.Contact(PAIR, surface, adhesion=rs.Cohesive(WORK), periodic=True)
    state = rs.solve(contact, 0.9 * float(contact.gap.mean()))
    found = separation_of(list(separate(state)))
    per_area = 1 / (WORK * math.prod(contact.grid.size))
    tension = found.pull_off_force / (LARGEST * math.prod(contact.grid.size))
    loss = state.adhesive_loss + found.adhesive_loss
    return (
        f"| {1e9 * rms:g} | {64 * cells} | {100 * state.relative_area:.1f} | {tension:.4f} | "
        f"{-state.potential_energy * per_area:.3f} | {loss * per_area:.4f} | "
        f"{(found.error + state.work_error) * per_area:.4f} |"
    )


if __name__ == "__main__":
    for rms in (0.05e-9, 0.2e-9, 0.5e-9, 1e-9, 2e-9):
        for cells in (1, 2):
            print(line(rms, cells), flush=True)
