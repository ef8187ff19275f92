"""
Laws of DEM codes beside a computed curve
=========================================

This figure compares the computed COR of a rough bead with three laws of DEM codes: a constant, and
two laws with the same yield strength (Thornton and Ning, and ``mdr`` of LAMMPS). Laws for smooth
spheres predict no loss of energy below the yield velocity, but the rough bead loses the largest
share of its energy there. ``restitution fit-law`` fits seven laws to a computed curve and prints
the error of each law.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs
from restitution.theory import MDR, ThorntonNing

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
pair = rs.Pair(steel, steel)
grid = rs.Grid(nodes=(256, 256), spacing=(0.5e-6, 0.5e-6))
surface = rs.generate_surface(grid, kind="gaussian", rms=0.2e-6, correlation_length=5e-6, seed=1)
contact = rs.Contact(pair, surface, plasticity=rs.ExpandingCavity(290e6))
velocities = np.geomspace(0.01, 1, 9)
e = [rs.collide(state).restitution for state in rs.loading_path(contact, velocities=velocities)]

fig, ax = plt.subplots(layout="constrained")
ax.plot(velocities, e, "ko-", label="computed, rough")
ax.axhline(np.mean(e), color="C0", label="a constant")
V = np.geomspace(0.01, 1, 100)
R, E, m, Y = pair.radius, pair.contact_modulus, pair.mass, 290e6
ax.plot(V, ThorntonNing(R, E, 2.8 * Y).restitution(V, m), "C1", label="Thornton–Ning, 2.8 Y")
# Each of two equal spheres moves as if it hit a rigid wall at half the relative velocity.
mdr = MDR(steel.radius, steel.youngs_modulus, steel.poissons_ratio, Y)
ax.plot(V, mdr.restitution(V / 2, steel.mass), "C2", label="mdr")
ax.set(xscale="log", xlabel="impact velocity (m/s)", ylabel="COR", ylim=(0.3, 1.02))
ax.legend()
plt.show()
