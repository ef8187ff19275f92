"""
An ensemble of rough surfaces
=============================

This figure shows COR of twelve surfaces with the same statistics: the mean, the standard deviation
between surfaces, and single curves. The standard deviation is largest where a few asperities carry
the load. With ``realisations = 12`` in a case, the program computes the mean with its confidence
interval.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
pair = rs.Pair(steel, steel)
grid = rs.Grid(nodes=(160, 160), spacing=(0.6e-6, 0.6e-6))
velocities = np.geomspace(0.02, 1, 6)

curves = []
for seed in range(12):
    surface = rs.generate_surface(
        grid, kind="gaussian", rms=0.2e-6, correlation_length=5e-6, seed=seed
    )
    contact = rs.Contact(pair, surface, plasticity=rs.ExpandingCavity(290e6))
    states = rs.loading_path(contact, velocities=velocities)
    curves.append([rs.collide(state).restitution for state in states])

mean, spread = np.mean(curves, axis=0), np.std(curves, axis=0, ddof=1)
fig, ax = plt.subplots(layout="constrained")
ax.plot(velocities, np.transpose(curves), color="0.75", lw=0.8)
ax.fill_between(velocities, mean - spread, mean + spread, alpha=0.3, label="± standard deviation")
ax.plot(velocities, mean, "C0", lw=2, label="mean of 12")
ax.set(xscale="log", xlabel="impact velocity (m/s)", ylabel="COR", ylim=(0.3, 0.7))
ax.legend()
plt.show()
