"""Friction in exports: the coefficient of each pair, and the tangential stiffness.

DEM codes have one tangential spring per contact, with the stiffness of a contact that sticks
(Mindlin 1949: 8 G* a, with the contact radius a and 1/G* = Σ 2 (2 − ν)(1 + ν)/E). In a real contact
the edge slides first, so the mean stiffness during an impact is smaller. The tangential restitution
of elastic spheres in LAMMPS (`mindlin_rescale/force`) was compared with `impacts.oblique`,
for ν from 0 to 0.45 and any angle (evidence/oblique_stiffness). With 0.8 times Mindlin's
stiffness, the difference is at most 0.03. With the full stiffness, the tangential restitution is up
to 0.13 too large.
"""

from __future__ import annotations

from collections.abc import Sequence

from restitution.dem.export_common import commented, wrapped
from restitution.dem.pair import FRICTION, Pair

STIFFNESS_SHARE = 0.8  # factor on Mindlin's tangential stiffness; see the top of this file


def friction_note(pairs: Sequence[Pair], sign: str = "", tangential: str = "") -> str:
    """Write comments on the origin of the coefficients of friction.

    Each line begins with the comment sign `sign`, if one is given. `tangential` describes the
    tangential settings of the pairs whose cases state a coefficient of friction.
    """
    missing = [f"{pair.i} {pair.j}" for pair in pairs if pair.law.friction is None]
    if len(missing) == len(pairs):
        said = (
            f"Friction {FRICTION} is a placeholder: friction is not computed here; set your value."
        )
    elif missing:
        said = (
            f"Friction {FRICTION} of the pairs {', '.join(missing)} is a placeholder: their cases "
            "have no interface.friction; set your value. The other coefficients of friction are "
            f"those of the cases. {tangential}"
        )
    else:
        said = f"The coefficients of friction are those of the cases. {tangential}"
    return commented(wrapped([said.strip()]), sign) if sign else said.strip()
