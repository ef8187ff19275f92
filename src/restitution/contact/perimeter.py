"""Contact area with a correction for the staircase edge of a contact on a grid.

If a node is in contact, its whole cell counts as contact. On average, this adds a strip along the
contact edge to the area. The excess area is (π − 1 + ln 2)/24 times the length of the staircase
edge times the spacing. The factor accounts for the length of the staircase edge, which is on
average 4/π times that of the true edge (Yastrebov, Anciaux and Molinari 2017, Tribol. Int. 114,
161–171).
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.contact import whole_grid
from restitution.contact.state import State
from restitution.numerics.box import reframe

_EXCESS = (math.pi - 1 + math.log(2)) / 24


def corrected_area(state: State) -> float:
    """Contact area (m²) of a periodic contact, with the correction for the staircase edge."""
    touching = reframe(state.box_touching, state.box, whole_grid(state.contact))
    hx, hy = state.contact.grid.spacing
    # A face of the staircase edge has the length hy and separates cells of the width hx, or the
    # other way round. So length times spacing is hx hy for each face.
    faces = sum(np.count_nonzero(touching != np.roll(touching, 1, axis)) for axis in (0, 1))
    return state.contact_area - _EXCESS * int(faces) * hx * hy
