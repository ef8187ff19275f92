"""The pull-off force of an adhesive pair, and why the exported contact models leave it out."""

from __future__ import annotations

import math

import numpy as np

from restitution.laws.law import Law
from restitution.theory.jkr import JKR

_LEFT_OUT = (
    "the pull-off force is not modelled below, because the damping alone produces the e of this "
    "pair: an adhesive contact model would dissipate additional energy and lower e"
)
_OBSTACLES = {
    "LAMMPS": "jkr and dmt do not accept coeff_restitution",
    "LIGGGHTS": "cohesion sjkr needs an energy density instead of the work of adhesion",
    "MuJoCo": "contact forces are never attractive",
    "Drake": "contact forces are never attractive",
}


def pull_off_force(law: Law, velocity: float) -> float:
    """Pull-off force (N) after an impact at `velocity` (m/s).

    The force is interpolated between the computed points, linearly in the logarithm of the
    velocity. NaN if one of the two neighbouring points has no pull-off force.
    """
    V, forces = law.column("velocity"), law.column("pull_off_force")
    return float(np.interp(math.log(velocity), np.log(V), forces))


def adhesion_lines(law: Law, velocity: float, code: str) -> list[str]:
    """Make comment lines about adhesion for the export of `law` to `code`; [] without adhesion."""
    if law.work_of_adhesion == 0:
        return []
    force = pull_off_force(law, velocity)
    said = "not known (it needs unloading curves)" if math.isnan(force) else f"{force:.4g} N"
    jkr = JKR(law.radius, law.contact_modulus, law.work_of_adhesion)
    obstacle = f"; {_OBSTACLES[code]}" if code in _OBSTACLES else ""
    return [
        f"  adhesion {law.work_of_adhesion:.4g} J/m^2: e includes its dissipation",
        f"  pull-off force after an impact at {velocity:.6g} m/s: {said}; JKR of the smooth "
        f"bodies: {float(jkr.pull_off_force):.4g} N",
        f"  {_LEFT_OUT}{obstacle}",
    ]
