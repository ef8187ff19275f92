# needs pybullet==3.2.7 numpy==1.26.4
"""e of a sphere of 1 m on a plane in PyBullet, by restitution, time step and velocity.

The restitution of the sphere is e and that of the plane 1, without gravity and damping.
"""

import pybullet


def rebound(e, V, step, plane=1.0, margin=0.02, threshold=0.2):
    client = pybullet.connect(pybullet.DIRECT)
    pybullet.setPhysicsEngineParameter(
        fixedTimeStep=step,
        numSubSteps=0,
        contactBreakingThreshold=margin,
        restitutionVelocityThreshold=threshold,
    )
    floor = pybullet.createMultiBody(0, pybullet.createCollisionShape(pybullet.GEOM_PLANE))
    shape = pybullet.createCollisionShape(pybullet.GEOM_SPHERE, radius=1.0)
    ball = pybullet.createMultiBody(1.0, shape, basePosition=[0, 0, 1.2 + 0.37 * V * step])
    pybullet.changeDynamics(ball, -1, restitution=e, linearDamping=0, angularDamping=0)
    pybullet.changeDynamics(floor, -1, restitution=plane, linearDamping=0, angularDamping=0)
    pybullet.resetBaseVelocity(ball, [0, 0, -V])
    for _ in range(int(1.0 / V / step) + 200):
        pybullet.stepSimulation()
    v = pybullet.getBaseVelocity(ball)[0][2]
    pybullet.disconnect(client)
    return v / V


print("pybullet", pybullet.getAPIVersion())
for e in (1.0, 0.9, 0.5):
    for V in (0.05, 0.3, 1.0, 5.0):
        row = ", ".join(f"{rebound(e, V, 1 / rate):.4f}" for rate in (60, 240, 1000, 10000))
        print(f"e {e}, {V} m/s, steps of 1/60, 1/240, 1/1000, 1/10000 s: {row}", flush=True)
for e in (1.0, 0.5):
    for V in (0.05, 1.0):
        row = ", ".join(
            f"{rebound(e, V, 1 / rate, margin=1e-5, threshold=1e-3):.4f}"
            for rate in (60, 240, 1000)
        )
        print(
            f"contactBreakingThreshold 1e-5: e {e}, {V} m/s, 1/60, 1/240, 1/1000 s: {row}",
            flush=True,
        )
print("0.8 and 0.5 at 1 m/s:", f"{rebound(0.8, 1.0, 1 / 240, 0.5, 1e-5):.4f}")
