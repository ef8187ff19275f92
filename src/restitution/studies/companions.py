"""Curves beside the one of a run: what its surface, its grid and its materials do to COR.

They are solved on cells twice as large, which costs a fifth of the run each, and compared at the
same loading work, that is, at the same impact velocity.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.collision import UnloadingMethod, collide
from restitution.contact.contact import Contact
from restitution.contact.path import loading_path
from restitution.errors import DomainError, RestitutionError

Array = NDArray[np.float64]

_TOLERANCE = 0.005  # of COR, for the steps of adhesive unloading
_SHALLOWER, _DEEPER = 0.5, 1.3  # times the depths: other surfaces need them for the same work


@dataclass(frozen=True)
class Curve:
    """Loading works (J), increasing, and the coefficient of restitution at each."""

    work: Array
    restitution: Array

    def at(self, work: Array) -> Array:
        """COR at other works, by a monotone cubic in ln W; beyond the ends that of the end."""
        from scipy.interpolate import PchipInterpolator

        if self.work.size == 0:
            return np.full(np.shape(work), math.nan)
        if self.work.size == 1:
            return np.full(np.shape(work), self.restitution[0])
        inside = np.clip(work, self.work[0], self.work[-1])
        found: Array = PchipInterpolator(np.log(self.work), self.restitution)(np.log(inside))
        return found


def curve_of(contact: Contact, depths: Sequence[float], method: UnloadingMethod) -> Curve:
    """The curve of `contact` over `depths` (m) and one beyond either end.

    A depth that fails is left out; what reaches the edge of the grid ends the curve.
    """
    asked = [_SHALLOWER * depths[0], *depths, _DEEPER * depths[-1]]
    works: list[float] = []
    restitutions: list[float] = []
    for depth in asked:
        try:
            (state,) = loading_path(contact, [depth])
            collision = collide(state, method=method, tolerance=_TOLERANCE)
        except DomainError:
            break
        except RestitutionError:
            continue
        if collision.loading_work > (works[-1] if works else 0.0):
            works.append(collision.loading_work)
            restitutions.append(collision.restitution)
    return Curve(np.array(works), np.array(restitutions))
