"""Contact area without the error of its staircase edge.

A node counts as in contact with its whole cell. On average, this adds a strip along the edge of the
contact to the area. The edge of a contact on a grid is longer than the true edge by 4/π on average,
and the excess area is (π − 1 + ln 2)/24 times the length S_d of the staircase edge times the
spacing (Yastrebov, Anciaux and Molinari 2017, Tribol. Int. 114, 161–171).
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.state import State
from restitution.numerics.box import reframe

_EXCESS = (math.pi - 1 + math.log(2)) / 24


def corrected_area(state: State) -> float:
    """Contact area (m²) of a periodic contact, with the correction for the staircase edge."""
    rows, columns = (slice(0, n) for n in state.contact.grid.nodes)
    touching = reframe(state.box_touching, state.box, (rows, columns))
    hx, hy = state.contact.grid.spacing
    # Faces across x have the length hy and belong to cells of the width hx, and vice versa.
    faces = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
    return state.contact_area - _EXCESS * int(faces) * hx * hy
