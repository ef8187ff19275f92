"""Errors of COR and of the pull-off force due to the models of plasticity and adhesion.

The error of plasticity comes from a comparison with finite elements of half-spaces
(docs/validation.md), as a function of the COR due to plasticity alone, sqrt(E_el/(E_el + W_p)). A
sphere that yields returns less energy than a half-space.
"""

from __future__ import annotations

import math

from restitution.contact.interface import interface_of
from restitution.contact.state import State

# Ratio a/R above which finite elements of a sphere differ from those of a half-space, and the
# largest difference of COR per a/R beyond it if a sphere or a flat body yields
# (validation/bodies.csv).
_SHALLOW, _OF_SPHERE, _OF_FLAT = 0.02, 0.33, 0.06
# Largest d ln COR/d ln hardness (5/8 for fully plastic spheres), and its largest multiple of
# √(1 − e²) (evidence/size_effect/sensitivity.csv).
_MOST_GROWTH, _OF_LOSS = 0.65, 1.2
_STEPS = 0.02  # relative error of the pull-off force due to the steps around the largest tension


def model_error(state: State, restitution: float) -> float:
    """Error of the COR `restitution` of an impact whose deepest point is `state`.

    It has two independent parts, one due to the plasticity model and one due to neglecting the
    range of adhesion.
    """
    by_range = interface_of(state.contact).range_error(state, restitution)
    parts = _plasticity_error(state, restitution), by_range
    error = math.hypot(*parts) if all(parts) else max(parts)
    return min(error, max(restitution, 1 - restitution))  # COR lies between 0 and 1


def pull_off_error(state: State, pull_off_force: float) -> float:
    """Error (N) of `pull_off_force` after loading to `state`, without that of grid and surface."""
    if state.contact.adhesion is None:
        return 0.0
    return math.hypot(_STEPS, state.contact.adhesion.pull_off_error(state)) * pull_off_force


def _plasticity_error(state: State, restitution: float) -> float:
    """Error of the COR `restitution` due to the plasticity model.

    The error is 0 for elastic bodies, and if no node has reached the pressure of first yield.
    """
    contact = state.contact
    onset = contact.plasticity.onset_pressure(contact.pair)
    if math.isinf(onset) or state.box_pressure.max(initial=0.0) < onset:
        return 0.0
    stored, lost = state.stored_energy, state.plastic_work
    returned = stored / (stored + lost) if stored + lost > 0 else 0.0
    due_to_yield = math.sqrt(returned)
    error = contact.plasticity.difference(contact, due_to_yield)
    error = math.hypot(error, hardness_difference(state, due_to_yield))
    if deeper := depth_difference(state, due_to_yield):
        error += deeper / due_to_yield if due_to_yield else 1.0
    # The error of the model of plasticity changes only the plastic loss of energy, and the adhesive
    # loss stays the same. Let e_p be the COR that the plastic loss alone would give. The square of
    # the actual COR then changes by the same amount as e_p².
    high, low = (
        math.sqrt(max(restitution**2 + returned * ((1 + off) ** 2 - 1), 0.0))
        for off in (error, -min(error, 1.0))
    )
    return max(min(high, 1.0) - restitution, restitution - low)


def hardness_difference(state: State, restitution: float) -> float:
    """Largest relative difference of COR due to the error of the hardness of small contacts.

    `restitution` is the COR that plasticity alone would give.
    """
    growth = min(_MOST_GROWTH, _OF_LOSS * math.sqrt(max(1 - restitution**2, 0.0)))
    return growth * state.contact.plasticity.hardness_error(state)


def depth_difference(state: State, restitution: float) -> float:
    """Largest difference of COR between the bodies and half-spaces at the depth of `state`.

    If both bodies yield, each dissipates half of the energy. If it is unknown which body yields,
    the larger difference is used. `restitution` is the COR that plasticity alone would give.
    """
    pair, yields = state.contact.pair, state.contact.yields
    radius = math.sqrt(state.contact_area / math.pi)
    flat = _OF_FLAT * (radius / pair.radius - _SHALLOW)
    first, second = (
        max(_OF_SPHERE * (radius / body.radius - _SHALLOW), flat, 0.0)
        for body in (pair.first, pair.second)
    )
    parts = {"first": first, "second": second, "both": 0.5 * (first + second)}
    largest = max(parts.values()) if yields is None else parts[yields]
    # A body that hardly yields differs little: elastic bodies return all energy.
    return largest * min(1.0, 2 * (1 - restitution**2))
