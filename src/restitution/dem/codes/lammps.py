"""LAMMPS: `pair_style granular` with `hertz/material` and `damping coeff_restitution`.

LAMMPS uses the E and ν of a pair_coeff for both bodies, also at walls: E* = E/2(1 − ν²),
G* = E/4(2 − ν)(1 + ν). Each pair is given the E and ν that yield its own E* and G*. LAMMPS' mixing
of two materials applies the ½ twice and is not used. Force and damping (Antypov & Elliott, EPL 94
(2011) 50004) act until δ = 0, with a tension at the end; `limit_damping` would cut the tension off
and raise e. `damping tsuji` has an error of √2 in released versions.
"""

from __future__ import annotations

from restitution.dem.codes.lammps_kokkos import linear_spring, velocity_damping
from restitution.dem.codes.lammps_mdr import mdr_offers
from restitution.dem.export_common import STEPS, commented, header, pairs_at, render, summary
from restitution.dem.pair_table import PairTable
from restitution.dem.velocity_matching import SCRIPT, Target, matching_script

CODE = "LAMMPS"
LOWEST = 0.001  # reproduced within 0.5 % with `STEPS` steps a contact
FRAGMENT, COLLISION = "restitution.lmp", "collision.in"
KOKKOS = "restitution_kokkos.lmp"
_MATCHED = Target(CODE, "lmp -in my.in", FRAGMENT, "matched.lmp", LOWEST)
_ENDS = (
    "the overlap is back to zero. The damping pulls shortly before; do not add limit_damping, "
    "which cuts that off and raises e (0.808 for 0.8)."
)

_KOKKOS_ENDS = "the overlap is back to zero. The damping pulls before; do not add limit_damping."


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The fragment to include, one for KOKKOS, and a test collision: file names and texts.

    Raises `CaseError`, `DomainError`.
    """
    walls_only = all(j > len(table.spheres) for _, j in table.laws)
    if not walls_only:
        table.require_spheres(CODE)
    pairs = pairs_at(table, velocity, CODE, LOWEST)
    head = header(table, pairs, velocity, code=CODE, ends=_ENDS)
    short = summary(pairs, velocity, code=CODE, ends=_ENDS, fragment=FRAGMENT)
    kokkos = summary(
        pairs, velocity, code=CODE, ends=_KOKKOS_ENDS, fragment=FRAGMENT, constant=False
    )
    return {
        FRAGMENT: render(
            FRAGMENT,
            comments=commented(head, "#"),
            spheres=[pair for pair in pairs if not pair.wall],
            walls=[pair for pair in pairs if pair.wall],
            mdr=mdr_offers(pairs, velocity),
        ),
        KOKKOS: render(
            KOKKOS,
            comments=commented(kokkos, "#"),
            spheres=[pair for pair in pairs if not pair.wall],
            damping=velocity_damping(pairs, velocity),
            spring=linear_spring(pairs, velocity),
            velocity=velocity,
        ),
        SCRIPT: matching_script(_MATCHED, pairs, commented(short, "#")),
        COLLISION: render(
            COLLISION,
            comments=commented(short, "#"),
            table=table,
            pairs=pairs,
            velocity=velocity,
            size=table.largest_radius,
            steps=STEPS,
        ),
    }
