"""How far the model of plasticity may move COR, from finite elements (docs/validation.md).

The largest differences of COR found there, in parts of it, are given for each model against the COR
that plasticity alone leaves, e_p = sqrt(E_el/(E_el + W_p)): it falls steadily from first yield to
full plasticity, on smooth bodies and on asperities. Below the range of the finite elements the last
value stands, and so it may be too small there.
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.state import State

# COR without adhesion, and the largest relative difference found there.
_FOUND = {
    "expanding-cavity": (
        (0.38, 0.5, 0.65, 0.94, 0.98, 1.0),
        (0.04, 0.04, 0.065, 0.065, 0.02, 0.01),
    ),
    "equilibrium": (
        (0.34, 0.46, 0.56, 0.68, 0.77, 0.86, 0.99, 1.0),
        (0.09, 0.06, 0.04, 0.05, 0.08, 0.11, 0.11, 0.07),
    ),
    "truncated": (
        (0.29, 0.41, 0.49, 0.6, 0.69, 0.75, 0.9, 0.97, 1.0),
        (0.23, 0.18, 0.15, 0.12, 0.08, 0.05, 0.06, 0.1, 0.07),
    ),
}
_ONSET = 1.6 / 2.8  # first yield over a yield pressure, which is fully plastic contact


def model_error(state: State, restitution: float) -> float:
    """Error of `restitution` (of an impact as deep as `state`) by the model of plasticity.

    Zero where no node is at the pressure of first yield, and for bodies that are elastic.
    """
    contact = state.contact
    onset = contact.first_yield_pressure * (1.0 if contact.grows else _ONSET)
    if math.isinf(onset) or state.box_pressure.max(initial=0.0) < onset:
        return 0.0
    stored, lost = state.stored_energy, state.plastic_work
    returned = stored / (stored + lost) if stored + lost > 0 else 0.0
    error = float(np.interp(math.sqrt(returned), *_FOUND[str(contact.plasticity)]))
    # What adhesion takes is taken from either: e² and e_p² differ by as much.
    high, low = (
        math.sqrt(max(restitution**2 + returned * ((1 + off) ** 2 - 1), 0.0))
        for off in (error, -error)
    )
    return max(min(high, 1.0) - restitution, restitution - low)
