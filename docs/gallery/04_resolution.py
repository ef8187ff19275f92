"""
Resolution
==========

This figure shows COR of one band-limited surface on successively finer grids. If a contact patch
has only a few nodes, COR depends on the grid. Once the patch that contains the median contact node
has about 20 nodes or more, COR changes by less than 2 % on still finer grids.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
pair = rs.Pair(steel, steel)
grid = rs.Grid(nodes=(64, 64), spacing=(1e-6, 1e-6))
surface = rs.generate_surface(grid, kind="gaussian", rms=0.2e-6, correlation_length=5e-6, seed=4)
velocities = [0.01, 0.03, 0.1]

fig, ax = plt.subplots(layout="constrained")
for i, velocity in enumerate(velocities):
    spacing, e, resolved = [], [], []
    for factor in (1, 2, 4, 8):
        finer = rs.refine(surface, factor)
        contact = rs.Contact(pair, finer, plasticity=rs.ExpandingCavity(290e6))
        state = rs.solve_at_velocity(contact, velocity)
        sizes = state.patch_sizes()
        spacing.append(1e6 * finer.grid.spacing[0])
        e.append(rs.collide(state).restitution)
        resolved.append(sizes[np.searchsorted(sizes.cumsum(), sizes.sum() / 2)] >= 20)
    colour, resolved = f"C{i}", np.array(resolved)
    spacing, e = np.array(spacing), np.array(e)
    ax.plot(spacing, e, color=colour, label=f"{velocity:g} m/s")
    ax.plot(spacing[resolved], e[resolved], "o", color=colour)
    ax.plot(spacing[~resolved], e[~resolved], "o", color=colour, mfc="white")
ax.set(xscale="log", xlabel="grid spacing (µm)", ylabel="COR")
ax.set_xticks(spacing, [f"{one:g}" for one in spacing])
ax.minorticks_off()
ax.legend(title="filled: resolved")
plt.show()
