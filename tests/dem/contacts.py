"""Laws with all that the portable contact needs, in closed form."""

from dataclasses import replace

import numpy as np

from restitution.laws.law import LawPoint
from restitution.theory import JKR, ThorntonNing


def sticking_law(law, first, points=9, second=None):
    """A law of two smooth elastic bodies, equal without `second`, by JKR; it sticks at first."""
    base = law(first, second or first, work_of_adhesion=0.05)
    theory = JKR(base.radius, base.contact_modulus, 0.05)
    V_s = float(theory.sticking_velocity(base.mass))
    rows = []
    for V in V_s * np.geomspace(0.5, 20, points):
        kinetic = 0.5 * base.mass * V**2
        deepest = _deepest(theory, kinetic)
        ratio = float(1 - (V_s / V) ** 2)
        rows.append(
            LawPoint(
                velocity=float(V),
                restitution=max(ratio, 0.0) ** 0.5,
                error=0.001,
                ratio=ratio,
                loading_work=kinetic,
                indentation=deepest,
                force=float(theory.force(deepest)),
                pull_off_force=float(theory.pull_off_force),
                separation=float(theory.indentation_at_contact_radius(theory.break_radius)),
                resolved=True,
            )
        )
    return replace(
        base,
        points=tuple(rows),
        yield_pressure=None,
        smooth_sticking_velocity=V_s,
        sticks_below=V_s,
    )


def _deepest(theory, kinetic):
    """The indentation at which spheres that jump into contact at δ = 0 have lost `kinetic`."""
    a = np.geomspace(0.5, 100, 20001) * theory.break_radius
    depth = theory.indentation_at_contact_radius(a)
    a, depth = a[depth >= 0], depth[depth >= 0]
    energy = theory.total_energy_at_contact_radius(a)
    return float(np.interp(kinetic, energy - energy[0], depth))


def plate_law(law, first, plate, share=0.9):
    """A sphere that yields on a plate, by Thornton and Ning; the plate leaves e times `share`."""
    base = law(first, plate, yield_pressure=1e9)
    theory = ThorntonNing(base.radius, base.contact_modulus, 1e9)
    rows = []
    for point in base.points:
        V = point.velocity
        deepest = float(theory.indentation_from_velocity(V, base.mass))
        e = share * float(theory.restitution(V, base.mass))
        force = float(theory.loading_force(deepest))
        changes = {"restitution": e, "ratio": e**2, "indentation": deepest, "force": force}
        rows.append(replace(point, **changes))
    return replace(base, points=tuple(rows))
