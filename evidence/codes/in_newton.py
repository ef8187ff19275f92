# needs newton==1.8.0 warp-lang==1.19.0
"""e of a sphere (R 0.1 m, 1 kg, 1 m/s) on a plane in Newton on the CPU, by solver.

The spring and dashpot of the semi-implicit and Featherstone solvers are chosen by the textbook's
formula for a dashpot that acts in both directions.
"""

import math
from functools import partial
from importlib.metadata import version

import newton
import warp as wp

wp.config.quiet = True
V, R, KE = 1.0, 0.1, 1.0e4


def rebound(solver, step, duration=0.3, **shape):
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
    config = newton.ModelBuilder.ShapeConfig(density=0.0, mu=0.0, kf=0.0, **shape)
    inertia = wp.mat33(*(0.4 * R * R if k in (0, 4, 8) else 0.0 for k in range(9)))
    start = wp.transform(wp.vec3(0.0, 0.0, R + 0.05 + 0.3 * V * step), wp.quat_identity())
    body = builder.add_body(xform=start, mass=1.0, inertia=inertia)
    builder.add_shape_sphere(body, radius=R, cfg=config)
    builder.add_ground_plane(cfg=config)
    model = builder.finalize(device="cpu")
    engine = solver(model)
    one, two = model.state(), model.state()
    speeds = one.body_qd.numpy()
    speeds[0, 2] = -V
    one.body_qd.assign(speeds)
    if one.joint_qd is not None and len(one.joint_qd):
        joint = one.joint_qd.numpy()
        joint[2] = -V
        one.joint_qd.assign(joint)
    control, contacts = model.control(), model.contacts()
    for _ in range(int(duration / step)):
        one.clear_forces()
        model.collide(one, contacts)
        engine.step(one, two, control, contacts, step)
        one, two = two, one
    return float(one.body_qd.numpy()[0, 2]) / V


print("RESULT newton", version("newton"))
for e in (1.0, 0.8, 0.5, 0.25):
    ratio = -math.log(e) / math.hypot(math.pi, math.log(e))
    kd = 2 * ratio * math.sqrt(KE)
    for name in ("SemiImplicit", "Featherstone"):
        solver = getattr(newton.solvers, f"Solver{name}")
        row = [rebound(solver, step, ke=KE, kd=kd) for step in (1e-3, 1e-4)]
        print(
            f"RESULT {name}, dashpot for e {e}, steps of 1 and 0.1 ms: "
            + ", ".join(f"{x:.4f}" for x in row),
            flush=True,
        )
    xpbd = [
        rebound(partial(newton.solvers.SolverXPBD, enable_restitution=on), step, restitution=e)
        for on in (False, True)
        for step in (1e-3, 1e-4)
    ]
    print(
        f"RESULT XPBD, restitution {e}, off and on, steps of 1 and 0.1 ms: "
        + ", ".join(f"{x:.4f}" for x in xpbd),
        flush=True,
    )
