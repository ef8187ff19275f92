"""Error of the one-dimensional tangential law, from a comparison with boundary elements.

docs/oblique.md describes the comparison (`docs/studies/tangential.py` and `unlike.py`). The law is
exact for like bodies with ν = 0 and any roughness, as long as they do not yield. Four effects cause
an error:

* Patches that are not round. A point load along x moves the surface at a given distance along x by
  1 + χ and along y by 1 − χ times the mean, with χ = ν/(2 − ν) for like bodies. The law uses the
  mean, so its stiffness of a contact with the shape of a line has an error of up to χ. The patches
  of rough contacts point in all directions, and their effects cancel as the square root of their
  number. A lay aligns them.
* Yield. During loading, the largest traction of nodes at the pressure bound does not grow, but that
  of all springs of the law does.
* Few unloading curves. Between two of them, the stiffness is interpolated.
* Unlike bodies. Pressure also moves the surfaces tangentially, in proportion to the second constant
  of Dundurs β. Without slip this adds no tangential force by symmetry, and the stiffness grows only
  by about β²/3 (atanh(β)/β − 1 for a round punch; Spence 1968, Proc. R. Soc. A 305, 55–80). But if
  µ is not large compared with |β|, the surfaces slip radially under pressure alone (Spence 1975, J.
  Elast. 5, 297–319), and friction cannot hold them against a tangential motion at the same time.
  In coupled solutions, the impulse changed as if the stiffness changed by less than |β| for
  µ < |β|, and by less than |β|³/µ² for larger µ. In full slip the radial slip turns the friction
  away from the motion, and the impulse is smaller.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.contact.bodies import Pair
from restitution.laws.foundation import has_yielded
from restitution.laws.time_integration import StoredForce

# Numbers that bound all differences found in the comparison. _NUMERICAL is the relative error of
# the stiffness of smooth contacts for ν = 0, and _ROUGH what roughness adds. _SHAPE is the error of
# one patch over χ. It is as large for up to _ALIGNED patches, and does not decrease further beyond
# _INDEPENDENT patches, because small patches are parts of larger ones.
_NUMERICAL, _ROUGH = 0.005, 0.04
_SHAPE, _ALIGNED, _INDEPENDENT = 0.35, 4.0, 36.0
# Relative errors of stiffness and impulse after yield, for each factor between the depths of two
# neighbouring unloading curves.
_YIELDED_STIFFNESS, _YIELDED_IMPULSE = 0.01, 0.1
_TURNED = 0.15  # relative error of the impulse of full slip over that of the stiffness by β
_SHALLOWEST = 0.2  # depth over the deepest one below which the number of curves does not matter


@dataclass(frozen=True)
class TangentialError:
    """Relative errors of the tangential law (1).

    `stiffness` is that of the tangential stiffness, `impulse` an additional one of the tangential
    impulse of a contact that is far from full slip, and `sliding` that of the impulse of full slip.
    """

    stiffness: float
    impulse: float
    sliding: float


def tangential_error(law: StoredForce, deepest: float, friction: float) -> TangentialError:
    """Error of the tangential law for an impact that turns at the depth `deepest` (m).

    `friction` is the coefficient of friction (1). The errors hold for the grid of the stored
    contact, and do not contain the error of the normal forces.
    """
    beta = abs(dundurs(law.pair))
    slipping = min(beta / friction, 1.0) ** 2 if friction > 0 else 1.0
    stiffness, impulse = _NUMERICAL + beta * max(slipping, beta / 3), 0.0
    sliding = _TURNED * beta * slipping
    rough = law.roughness
    if rough is not None:
        across, along = law.pair.shear_compliances
        patches = min(float(np.interp(deepest, rough.depths, rough.patches)), _INDEPENDENT)
        shape = max(_SHAPE / math.sqrt(max(1.0, patches / _ALIGNED)), rough.lay)
        stiffness += _ROUGH + shape * (along - across) / (along + across)
    if has_yielded(law, deepest):
        gap = 1.0 if rough is None else _largest_gap(law, deepest)
        stiffness += _YIELDED_STIFFNESS * gap
        impulse = min(_YIELDED_IMPULSE * gap, 1.0)
    return TangentialError(stiffness, impulse, sliding)


def dundurs(pair: Pair) -> float:
    """The second constant of Dundurs β of a pair (1), zero for like bodies.

    β = [(1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂]/2[(1 − ν₁)/G₁ + (1 − ν₂)/G₂] (Johnson 1985, eq. 5.3).
    """
    (first, one), (second, two) = (
        (body.poissons_ratio, (1 + body.poissons_ratio) / body.youngs_modulus)
        for body in (pair.first, pair.second)
    )
    coupled = (1 - 2 * first) * one - (1 - 2 * second) * two
    return 0.5 * coupled / ((1 - first) * one + (1 - second) * two)


def _largest_gap(law: StoredForce, deepest: float) -> float:
    """Largest factor between the depths of two unloading curves next to each other."""
    depths = law.unloading_from
    below = depths[(depths > _SHALLOWEST * deepest) & (depths < deepest)]
    ends = [depths[depths <= _SHALLOWEST * deepest][-1:], below, depths[depths >= deepest][:1]]
    if not ends[0].size:
        ends[0] = np.array([_SHALLOWEST * deepest])
    inside = np.concatenate(ends)
    return float((inside[1:] / inside[:-1]).max()) if inside.size > 1 else 1.0
