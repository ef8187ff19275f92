"""
COR of smooth and rough spheres
===============================

This figure shows COR of the same pair of 1 mm steel beads with three roughnesses. Asperities yield
under very small forces, so a rough bead loses energy at any velocity. At higher velocities the bulk
carries the load, and COR rises towards the curve of the smooth bead. Open markers show contacts
that the grid does not resolve.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
pair = rs.Pair(steel, steel)
grid = rs.Grid(nodes=(320, 320), spacing=(0.4e-6, 0.4e-6))
velocities = np.geomspace(0.005, 2, 10)


def median_patch(state):
    """Number of nodes of the patch that contains the median contact node."""
    sizes = state.patch_sizes()
    return sizes[np.searchsorted(sizes.cumsum(), sizes.sum() / 2)]


fig, ax = plt.subplots(layout="constrained")
for colour, rms in zip(("0.5", "C0", "C1", "C3"), (0, 0.05e-6, 0.1e-6, 0.3e-6), strict=True):
    surface = rs.smooth(grid)
    if rms:
        surface = rs.generate_surface(
            grid, kind="gaussian", rms=rms, correlation_length=4e-6, seed=1
        )
    contact = rs.Contact(pair, surface, plasticity=rs.ExpandingCavity(290e6))
    states = list(rs.loading_path(contact, velocities=velocities))
    e = np.array([rs.collide(state).restitution for state in states])
    resolved = np.array([median_patch(state) >= 20 for state in states])
    label = f"Rq = {1e6 * rms:g} µm" if rms else "smooth"
    ax.plot(velocities, e, color=colour, label=label)
    ax.plot(velocities[resolved], e[resolved], "o", color=colour)
    ax.plot(velocities[~resolved], e[~resolved], "o", color=colour, mfc="white")
ax.set(xscale="log", xlabel="impact velocity (m/s)", ylabel="COR", ylim=(0.25, 1))
ax.legend()
plt.show()
