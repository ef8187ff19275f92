"""
Loading and unloading curves
============================

COR is the square root of the ratio of two areas: the area below the unloading curve and the area
below the loading curve. The rough contact is softer at first, and it has lost more energy when the
bodies separate.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
grid = rs.Grid(nodes=(256, 256), spacing=(0.4e-6, 0.4e-6))
rough = rs.generate_surface(grid, kind="gaussian", rms=0.2e-6, correlation_length=4e-6, seed=1)

fig, ax = plt.subplots(layout="constrained")
for i, (name, surface) in enumerate({"smooth": rs.smooth(grid), "rough": rough}.items()):
    contact = rs.Contact(rs.Pair(steel, steel), surface, plasticity=rs.ExpandingCavity(290e6))
    loading = list(rs.loading_path(contact, np.linspace(50e-9, 800e-9, 8)))
    depth = [0] + [1e9 * state.indentation for state in loading]
    ax.plot(depth, [0] + [state.force for state in loading], f"C{i}o-", ms=3, label=name)
    for state in (loading[3], loading[-1]):
        path = list(rs.unloading_path(state, steps=8))
        ax.plot([1e9 * one.indentation for one in path], [one.force for one in path], f"C{i}--")
        e = rs.collide(state).restitution
        at = (1e9 * state.indentation, state.force)
        ax.annotate(f"{e:.2f}", at, (-5, 5), ha="right", textcoords="offset points")
ax.set(xlabel="indentation (nm)", ylabel="force (N)")
ax.legend(title="dashed: unloading, with COR")
plt.show()
