r"""
Adhesion: from sticking to rebound
==================================

A smooth elastic adhesive sphere sticks below the velocity :math:`V_s`. Above :math:`V_s` it
rebounds with :math:`e = (1 - V_s^2/V^2)^{1/2}` (JKR; Thornton and Ning 1998). If the sphere also
yields, COR has a maximum, because adhesion reduces COR of slow impacts and yielding reduces COR of
fast impacts. The smaller the particle, the narrower the range of velocities with a high COR.
"""

import matplotlib.pyplot as plt
import numpy as np

import restitution as rs
from restitution.theory import JKR, AdhesiveThorntonNing

work_of_adhesion, yield_pressure = 0.05, 2.8 * 90e6  # polystyrene
velocities = np.geomspace(0.003, 30, 400)

fig, ax = plt.subplots(layout="constrained")
for i, radius in enumerate((50e-6, 5e-6, 1e-6)):
    bead = rs.Body(radius=radius, youngs_modulus=3e9, poissons_ratio=0.33, density=1050)
    pair = rs.Pair(bead, bead)
    elastic = JKR(pair.radius, pair.contact_modulus, work_of_adhesion)
    yielding = AdhesiveThorntonNing(
        pair.radius, pair.contact_modulus, yield_pressure, work_of_adhesion
    )
    ax.plot(velocities, elastic.restitution(velocities, pair.mass), f"C{i}--", lw=1)
    e = yielding.restitution(velocities, pair.mass)
    ax.plot(velocities, e, f"C{i}", label=f"{2e6 * radius:g} µm")
ax.set(xscale="log", xlabel="impact velocity (m/s)", ylabel="COR", ylim=(0, 1.02))
ax.legend(title="diameter; dashed: elastic")
plt.show()
