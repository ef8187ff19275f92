"""YADE: `Ip2_FrictMat_FrictMat_MindlinPhys` with a `betan` for each pair of materials.

YADE adds the damping force 2β(m* dF/dδ)^½ dδ/dt to Hertz's force F at the overlap δ. The sum is
never attractive, so a contact ends when the force returns to zero. YADE 2023.02a converts the
coefficient of restitution `en` to β by a fit (Thornton et al., Powder Technol. 233 (2013) 30, eqs.
B6, B7). With this fit, contacts have e = 0.979 for en = 0.99 and e = 0.948 for en = 0.95. Other
releases convert `en` differently. The export therefore writes β (`betan`), which it computes from e
by a fit of its own:

    β = L exp(Σ c_k L^k),  L = −ln e,  with the coefficients c_k in `_FIT`.

This fit reproduces the motion under the elastic and the damping force. It is valid for e ≥ 0.01,
and the resulting e differs by less than 10⁻⁵ from the required e.

YADE computes E* from the two materials. On a wall, YADE uses R/2 for R*, which makes the contact
softer by a factor of √2 and does not change e. Each contact has its own `betan`. The exported
function `follow` can set `betan` at first touch according to the impact velocity V, so that e
follows the law e(V).
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import Any

from restitution.dem.export_common import Export, density_of, law_points
from restitution.dem.own_laws import OwnLaw, constant
from restitution.dem.pair import FRICTION, STIFFNESS_SHARE, ExportedPair, contact_time
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, wrapped
from restitution.laws.particle import Particle

CODE = "YADE"
LOWEST = 0.01  # lowest e for which the fit of betan is valid
FRAGMENT, COLLISION = "restitution_yade.py", "collision_yade.py"
_ENDS = (
    "the force is back to zero, which is before the overlap is zero: the force is never tensile. e "
    "is given as betan, not as en, because en = 0.99 gives e = 0.979 in YADE 2023.02a. On a wall "
    "YADE uses half of R*, so the contact is softer by a factor of sqrt(2); e is the same."
)
_TANGENTIAL = (
    "The functions `soften` and `follow` reduce the tangential stiffness of these pairs, because "
    "the edge of a contact slides first (docs/oblique.md)."
)
SETTING = (
    "give it as the second argument of physics, such as physics(ids, {(1, 1): 0.9}). Friction of "
    f"these pairs is {FRICTION}, a placeholder."
)
_STEPS = 2000  # number of time steps in the contact of the test collision
_ADHESIVE_STEPS = 500  # the same with adhesion, where spheres that stick oscillate for long
# Density (kg/m³) of a wall whose case gives none. YADE needs a value, which has no effect.
_WALL_DENSITY = 1000.0

_FIT = (-1.23589, 0.202669, 0.0108748, 0.000410051, -3.09169e-5, -1.19887e-6)


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Notes, a module to import and a test collision; names and texts."""
    table.require_all(CODE)
    export = Export(table, velocity, CODE, LOWEST, _ENDS, setting=SETTING, own=own_laws)
    return inputs(export, {"attractions": {}, "misfits": []}) | export.notes()


def own_laws(pair: ExportedPair) -> list[OwnLaw]:
    """The laws e(V) that YADE has for `pair`."""
    return [*constant(pair), OwnLaw("e(V) by `follow`", pair.law.column("restitution"))]


def inputs(export: Export, values: Mapping[str, Any]) -> dict[str, str]:
    """The module and the collision; `values` has the adhesive pairs of both, and their misfits."""
    table = export.table
    misfits = commented(wrapped(values["misfits"]), "#")
    return {
        FRAGMENT: export.render(
            FRAGMENT,
            **{**values, "misfits": misfits},
            unset=table.missing_spheres(),
            placeholder=FRICTION,
            fit=_FIT,
            lowest=LOWEST,
            wall_density=_WALL_DENSITY,
            density=_density,
            points=partial(law_points, lowest=LOWEST),
            friction_note=export.friction_note("#", _TANGENTIAL),
            tangential=_tangential,
        ),
        COLLISION: export.render(
            COLLISION,
            attractions=values["attractions"],
            steps=_ADHESIVE_STEPS if values["attractions"] else _STEPS,
            pair_time=_contact_time,
        ),
    }


def _tangential(pair: ExportedPair) -> float:
    return 1.0 if pair.law.friction is None else STIFFNESS_SHARE


def _density(body: Particle) -> float:
    return _WALL_DENSITY if body.wall and body.density is None else density_of(body)


def _contact_time(pair: ExportedPair) -> float:
    """On a wall YADE uses half the radius of the sphere for R*."""
    return contact_time(pair.law, pair.law.radius / (2 if pair.wall else 1))
