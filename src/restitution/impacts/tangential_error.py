"""Error of the tangential law (`foundation`), from a comparison with boundary elements.

docs/oblique.md describes the comparison (evidence/tangential, evidence/unlike). The law is exact
for bodies of equal materials with ν = 0 that do not yield. Errors come from patches that are not
round (a point load displaces the points of a circle by 1 ± χ times their mean, χ = ν/(2 − ν)), from
yield, from few unloading curves, and from unlike materials (Dundurs' β): the surfaces slip radially
under pressure alone (Spence 1968, Proc. R. Soc. A 305, 55–80, and 1975, J. Elast. 5, 297–319).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.contact.bodies import Pair
from restitution.impacts.foundation import has_yielded
from restitution.impacts.stored_force import StoredForce

# With these constants, the error estimate is at least as large as every difference that was found
# in the comparison with boundary elements. The top of this file defines χ and β.
#
# Relative errors of the stiffness for ν = 0. Every contact has the error _NUMERICAL. Rough contacts
# have the additional error _ROUGH.
_NUMERICAL, _ROUGH = 0.005, 0.04
# Contact patches that are not round cause a relative error of the stiffness. This error is χ times
# _SHAPE for up to _ALIGNED patches, and decreases from _ALIGNED to _INDEPENDENT patches. With even
# more patches it is constant, because additional patches are only fragments of larger ones.
_SHAPE, _ALIGNED, _INDEPENDENT = 0.35, 4.0, 36.0
# Relative errors of stiffness and impulse after yield. For rough contacts they are multiplied by
# the largest ratio of the depths of two neighbouring unloading curves.
_YIELDED_STIFFNESS, _YIELDED_IMPULSE = 0.01, 0.1
# For unlike materials in full slip, the relative error of the impulse is this factor times
# |β| min(1, β²/µ²), with Dundurs' parameter β.
_TURNED = 0.15
# Unloading curves that start below this fraction of the largest indentation are ignored, except the
# deepest of these curves.
_SHALLOWEST = 0.2


@dataclass(frozen=True)
class TangentialError:
    """Relative errors of the tangential law (dimensionless).

    `stiffness` is that of the tangential stiffness. `impulse` and `sliding` are additional errors
    of the tangential impulse; `impulse` decreases to zero towards full slip, and `sliding` does
    not.
    """

    stiffness: float
    impulse: float
    sliding: float


def tangential_error(law: StoredForce, deepest: float, friction: float) -> TangentialError:
    """Error of the tangential law for an impact with the maximum indentation `deepest` (m).

    The errors of the grid and of the normal forces are not included.
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
    """Dundurs' second constant β of a pair (dimensionless), zero for equal materials.

    β = ½ [(1 − 2ν₁)/G₁ − (1 − 2ν₂)/G₂]/[(1 − ν₁)/G₁ + (1 − ν₂)/G₂] (Johnson 1985, eq. 5.3).
    """
    (first, one), (second, two) = (
        (body.poissons_ratio, (1 + body.poissons_ratio) / body.youngs_modulus)
        for body in (pair.first, pair.second)
    )
    coupled = (1 - 2 * first) * one - (1 - 2 * second) * two
    return 0.5 * coupled / ((1 - first) * one + (1 - second) * two)


def _largest_gap(law: StoredForce, deepest: float) -> float:
    """Largest ratio of the depths of two neighbouring unloading curves that the impact uses."""
    depths = law.unloading_from
    if depths[0] > _SHALLOWEST * deepest:
        depths = np.append(_SHALLOWEST * deepest, depths)
    first = np.searchsorted(depths, _SHALLOWEST * deepest, side="right") - 1
    inside = depths[first : np.searchsorted(depths, deepest) + 1]
    return float((inside[1:] / inside[:-1]).max()) if inside.size > 1 else 1.0
