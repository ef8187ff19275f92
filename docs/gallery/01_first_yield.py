r"""
First yield
===========

This figure shows the velocity at which a smooth sphere starts to lose energy. The largest pressure
follows from the theory of Hertz, :math:`p_0 = 2 E^* a/(\pi R^*)`. The sphere yields below its
surface when :math:`p_0` reaches 1.6 times the yield strength. The impact velocity at which this
happens does not depend on the size of the particle. This velocity is below the range of granular
flow for annealed stainless steel, within this range for aluminium and hardened steel, and above it
for the two plastics.
"""

import matplotlib.pyplot as plt

import restitution as rs
from restitution.theory import FirstYield, yield_coefficient

names, velocities = [], []
for key in ["polystyrene", "pmma", "aluminium", "stainless-steel", "steel"]:
    found = rs.material(key)
    names.append(found.name.partition(" (")[0])
    E, nu, rho = (
        quantity.value for quantity in (found.youngs_modulus, found.poissons_ratio, found.density)
    )
    body = rs.Body(radius=1e-3, youngs_modulus=E, poissons_ratio=nu, density=rho)
    pair = rs.Pair(body, body)
    pressure = yield_coefficient(nu) * found.yield_strength.value
    velocities.append(FirstYield(pair.radius, pair.contact_modulus, pressure).velocity(pair.mass))

fig, ax = plt.subplots(layout="constrained")
ax.barh(names, velocities, color="C0")
ax.axvspan(0.01, 1, color="C1", alpha=0.15, zorder=0, label="typical of granular flow")
ax.set(xscale="log", xlabel="velocity of first yield, two equal spheres (m/s)")
ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1))
plt.show()
