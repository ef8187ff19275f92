"""
Pressure maps
=============

These maps show the pressure in a rough contact at three depths. At the smallest depth a few
asperities carry the load, at up to four times the yield strength of 290 MPa. At the largest depth
most patches have merged. The asperities still carry the largest pressures. The valleys between
them, which touch last, yield at 1.6 times the yield strength.
"""

import matplotlib.pyplot as plt

import restitution as rs

steel = rs.Body(radius=0.5e-3, youngs_modulus=193e9, poissons_ratio=0.29, density=8000)
grid = rs.Grid(nodes=(320, 320), spacing=(0.25e-6, 0.25e-6))
surface = rs.generate_surface(grid, kind="gaussian", rms=0.2e-6, correlation_length=4e-6, seed=2)
contact = rs.Contact(rs.Pair(steel, steel), surface, plasticity=rs.ExpandingCavity(290e6))

fig, axes = plt.subplots(1, 3, figsize=(9, 3.4), layout="constrained", sharey=True)
for ax, state in zip(axes, rs.loading_path(contact, velocities=[0.02, 0.1, 0.5]), strict=True):
    pressure = 1e-6 * state.pressure
    edges = [1e6 * grid.x[0], 1e6 * grid.x[-1], 1e6 * grid.y[0], 1e6 * grid.y[-1]]
    image = ax.imshow(pressure.T, origin="lower", extent=edges, cmap="magma", vmin=0, vmax=1300)
    collision = rs.collide(state)
    ax.set(
        xlim=(-25, 25),
        ylim=(-25, 25),
        title=f"{collision.impact_velocity:.2f} m/s, COR {collision.restitution:.2f}",
        xlabel="x (µm)",
    )
axes[0].set_ylabel("y (µm)")
fig.colorbar(image, ax=axes, label="pressure (MPa)", shrink=0.8)
plt.show()
