# needs peclet-dem==1.1.0
"""e of two spheres (R 1 mm, 1 m/s) in peclet-dem, by solver, time step and restitution."""

from importlib.metadata import version

import numpy as np
import peclet.dem as dem

R, MASS, E, NU = 1e-3, 4 / 3 * np.pi * 1e-9 * 2500, 70e9, 0.25
CONTACT = 2.87 * ((MASS / 2) ** 2 / (R / 2 * (E / (2 * (1 - NU**2))) ** 2)) ** 0.2  # s at 1 m/s


def rebound(e, step, solver, V=1.0):
    run = dem.Simulation(8)
    run.set_domain([0.0, 0.0, 0.0], [0.02, 0.02, 0.02])
    run.initialize_shape("sphere", R)
    gap = 0.3 * V * step
    centres = [[0.01, 0.01, 0.01 - R - gap / 2], [0.01, 0.01, 0.01 + R + gap / 2]]
    run.set_positions(np.array(centres, dtype=np.float32))
    run.set_scales_uniform(1.0)
    run.set_inv_mass(np.full(2, 1 / MASS, dtype=np.float32))
    run.set_inv_inertia(np.full((2, 3), 1 / (0.4 * MASS * R**2), dtype=np.float32))
    run.set_velocities(np.array([[0, 0, V / 2], [0, 0, -V / 2]], dtype=np.float32))
    run.set_gravity([0.0, 0.0, 0.0])
    run.set_material_params(e)
    run.set_dt(step)
    if solver == "hertz":
        run.set_hertz_material(0, E, NU)
        run.step_hertz(int(4 * CONTACT / step))
    else:
        run.set_restitution_model(solver)
        run.set_solver_iterations(8, 8)
        run.step(20)
    v = run.get_velocities()
    return float(v[1, 2] - v[0, 2]) / V


print("RESULT peclet-dem", version("peclet-dem"))
for e in (1.0, 0.8, 0.5, 0.2):
    row = ", ".join(f"{rebound(e, CONTACT / n, 'hertz'):.4f}" for n in (20, 50, 200))
    print(f"RESULT step_hertz, e {e}, 20, 50, 200 steps per contact: {row}", flush=True)
    for solver in ("newton", "poisson"):
        row = ", ".join(f"{rebound(e, step, solver):.4f}" for step in (1e-6, 1e-5, 1e-4))
        print(f"RESULT step, {solver}, e {e}, steps of 1, 10, 100 us: {row}", flush=True)
