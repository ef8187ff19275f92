"""Factor on Mindlin's tangential stiffness with which LAMMPS reproduces the rebound of the law.

`tangential mindlin_rescale/force` for a sphere on a wall of like materials, friction 0.3, at angles
from sticking to full slip: elastic for several values of nu, and with Thornton and Ning's curve for
several yield pressures, where LAMMPS gets the normal restitution of the law. Writes
oblique_stiffness.csv: the largest and the root mean square difference of e_t. Needs `lmp`; takes
about a minute.
"""

from __future__ import annotations

import math

import numpy as np

from evidence.oblique import oblique_codes as codes
from evidence.shared import write_table
from restitution import Body, Pair
from restitution.impacts.oblique import ObliqueCollision, collide_obliquely
from restitution.impacts.stored_force import StoredForce
from restitution.theory import ThorntonNing

E, VELOCITY, FRICTION, RADIUS, DENSITY = 100e9, 3.9, 0.3, 2.5e-3, 4000.0
PSI = (0.3, 0.6, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5)  # kappa tan(angle)/mu
SHARES = (0.7, 0.75, 0.8, 0.85, 1.0)
ELASTIC = 1e12  # a yield pressure (Pa) that no impact reaches


def law(nu: float, yield_pressure: float) -> StoredForce:
    """Thornton and Ning's force of a sphere on a wall."""
    pair = Pair(Body(RADIUS, E, nu, DENSITY), Body(math.inf, E, nu))
    closed = ThorntonNing(pair.radius, pair.contact_modulus, yield_pressure)
    deepest = 1.01 * float(closed.indentation_from_velocity(VELOCITY, pair.mass))
    depths = np.geomspace(deepest / 50, deepest, 40)
    curves = []
    for depth in depths:
        end = float(closed.residual_indentation(depth))
        x = end + (depth - end) * np.linspace(0, 1, 400)
        curves.append((x, np.array(closed.unloading_force(x, depth), dtype=float)))
    return StoredForce(
        pair,
        deepest,
        1.005 * VELOCITY,
        lambda x: float(closed.loading_force(max(x, 0.0))),
        lambda depth: float(closed.residual_indentation(depth)),
        depths,
        tuple(curves),
    )


CONTACT = 1.6 * codes.CONTACT  # of the softer spheres of this study


def lammps(pair: Pair, share: float, impacts: list[ObliqueCollision]) -> list[float]:
    """The tangential restitution of all impacts in LAMMPS: one sphere and one wall for each."""
    x, stiffness = 4 * RADIUS, 2 * share * pair.tangential_modulus
    nu = pair.first.poissons_ratio
    lines = [
        "units si", "atom_style sphere", "atom_modify map array", "boundary f f f",
        "comm_modify vel yes", "newton off",
        f"region box block 0 {x * (len(impacts) + 1)} {-x} {x} 0 {x} units box",
        "create_box 1 box", "pair_style granular",
        f"pair_coeff * * hertz/material {E} 1.0 {nu} tangential mindlin NULL 1.0 0.5"
        " damping coeff_restitution",
        "fix move all nve/sphere", f"timestep {CONTACT / 4000}",
    ]  # fmt: skip
    for k, each in enumerate(impacts, 1):
        v_t, v_n = VELOCITY * math.sin(each.angle), -VELOCITY * math.cos(each.angle)
        model = (
            f"hertz/material {E} {min(each.normal_restitution, 1.0)} {nu} tangential"
            f" mindlin_rescale/force {stiffness} 1.0 {FRICTION} damping coeff_restitution"
        )
        lines += [
            f"create_atoms 1 single {x * k} 0 {RADIUS * (1 + 1e-9)} units box",
            f"set atom {k} diameter {2 * RADIUS} density {DENSITY} vx {v_t} vz {v_n}",
            f"group one_{k} id {k}",
            f"fix wall_{k} one_{k} wall/gran granular {model} zplane 0.0 NULL",
        ]
    lines += [
        "thermo 100000",
        "run 12000",
        "write_dump all custom end.txt id vx vz omegay modify format line '%d %.9g %.9g %.9g'",
    ]
    _, text = codes.run(["lmp", "-in", "in.txt", "-log", "none"], "\n".join(lines) + "\n", "in.txt")
    after = [v_t for v_t, _, _ in codes.numbers(text).values()]
    return [v / VELOCITY / math.sin(each.angle) for v, each in zip(after, impacts, strict=True)]


def rows(nu: float, yield_pressure: float, shares: tuple[float, ...]) -> list[dict[str, str]]:
    """Differences of e_t for one material and several shares of the stiffness."""
    force = law(nu, yield_pressure)
    kappa = force.pair.tangential_modulus / force.pair.contact_modulus
    impacts = [
        collide_obliquely(force, VELOCITY, math.atan(FRICTION * psi / kappa), FRICTION)
        for psi in PSI
    ]
    e_n = [each.normal_restitution for each in impacts]
    e_t = np.array([each.tangential_restitution for each in impacts])
    found = []
    for share in shares:
        differences = np.array(lammps(force.pair, share, impacts)) - e_t
        found.append(
            {
                "poissons_ratio": f"{nu:g}",
                "yield_pressure_Pa": "" if yield_pressure == ELASTIC else f"{yield_pressure:g}",
                "normal_restitution_from": f"{min(e_n):.3f}",
                "normal_restitution_to": f"{max(e_n):.3f}",
                "share": f"{share:g}",
                "largest_difference": f"{np.abs(differences).max():.4f}",
                "rms_difference": f"{math.sqrt(np.mean(differences**2)):.4f}",
            }
        )
        print(" | ".join(found[-1].values()), flush=True)
    return found


def main() -> None:
    """Write oblique_stiffness.csv."""
    elastic = [each for nu in (0.0, 0.2, 0.3, 0.45) for each in rows(nu, ELASTIC, SHARES)]
    yielding = [each for p_y in (2e9, 0.8e9, 0.3e9) for each in rows(0.3, p_y, (0.8, 1.0))]
    write_table("oblique_stiffness/oblique_stiffness.csv", elastic + yielding)


if __name__ == "__main__":
    main()
