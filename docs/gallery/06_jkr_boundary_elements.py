"""
JKR against boundary elements
=============================

This figure compares a computed adhesive contact with the theory of Johnson, Kendall and Roberts
(1971). A smooth sphere is unloaded step by step until it snaps off. By the crack-closure criterion,
nodes are released where the energy release rate exceeds the work of adhesion.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs
from restitution.theory import JKR

toner = rs.Body(radius=5e-6, youngs_modulus=3e9, poissons_ratio=0.33, density=1050)
pair = rs.Pair(toner, toner)
work_of_adhesion = 0.05
jkr = JKR(pair.radius, pair.contact_modulus, work_of_adhesion)

grid = rs.Grid(nodes=(64, 64), spacing=(16e-9, 16e-9))
contact = rs.Contact(pair, rs.smooth(grid), adhesion=rs.JKRLimit(work_of_adhesion))
path = list(rs.unloading_path(rs.solve(contact, 8e-9), tolerance=0.02))
depth = np.array([state.indentation for state in path])
force = np.array([state.force for state in path])

fig, ax = plt.subplots(layout="constrained")
exact = np.linspace(jkr.break_indentation, depth.max(), 300)
ax.plot(1e9 * exact, 1e6 * jkr.force(exact), "k", label="JKR")
ax.plot(1e9 * depth, 1e6 * force, "o", ms=4, mfc="none", label="boundary elements")
ax.axhline(-1e6 * jkr.pull_off_force, color="0.6", ls=":", label="pull-off, 3/2 πwR*")
ax.axhline(0, color="0.8", lw=0.8)
ax.set(xlabel="indentation (nm)", ylabel="force (µN)")
ax.legend()
plt.show()
