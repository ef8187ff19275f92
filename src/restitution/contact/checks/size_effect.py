"""How small the contact patches of a state are, as depths of Berkovich indents."""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.plasticity.size_effect import strengthening_at
from restitution.contact.state import State


def yielding_depth(state: State) -> float:
    """Depth (m) of the Berkovich indent that is as sharp as the median of what has yielded.

    The median is that of the plastic volume; inf if nothing has yielded.
    """
    given = state.plastic_displacement
    if not given.any():
        return math.inf
    ratio, _ = strengthening_at(state.contact, state.indentation, 1.0)
    sharpness = np.broadcast_to(np.square(ratio) - 1, given.shape)[given > 0]  # 1/h
    order = np.argsort(sharpness)
    volume = np.cumsum(given[given > 0][order])
    median = sharpness[order][np.searchsorted(volume, 0.5 * volume[-1])]
    return float(1 / median) if median > 0 else math.inf
