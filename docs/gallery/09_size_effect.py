"""
Size effect
===========

This figure shows COR of beads of different sizes with the same roughness, at one impact velocity.
Smooth spheres have the same COR at every size. The dots show three surfaces with the same
statistics for each size. COR measured on large balls is therefore not valid for powder of the same
material.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs

velocity = 0.1
sizes = np.geomspace(0.1e-3, 5e-3, 6)

smooth, rough = [], []
for radius in sizes / 2:
    steel = rs.Body(radius=radius, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
    pair = rs.Pair(steel, steel)
    edge = 0.3 * radius**0.7 * 0.5e-3**0.3
    grid = rs.Grid(nodes=(288, 288), spacing=(edge / 288, edge / 288))
    surfaces = [rs.smooth(grid)] + [
        rs.generate_surface(grid, kind="gaussian", rms=0.1e-6, correlation_length=4e-6, seed=seed)
        for seed in (1, 2, 3)
    ]
    found = [
        rs.collide(
            rs.solve_at_velocity(
                rs.Contact(pair, one, plasticity=rs.ExpandingCavity(290e6)),
                velocity,
            )
        ).restitution
        for one in surfaces
    ]
    smooth.append(found[0])
    rough.append(found[1:])

fig, ax = plt.subplots(layout="constrained")
ax.plot(1e3 * sizes, smooth, "k", label="smooth")
ax.plot(1e3 * sizes, np.mean(rough, axis=1), "C0", label="Rq = 0.1 µm, mean")
ax.plot(1e3 * sizes, rough, "C0o", ms=4, mfc="none")
ax.set(xscale="log", xlabel="diameter (mm)", ylabel=f"COR at {velocity:g} m/s", ylim=(0.3, 1))
ax.legend()
plt.show()
