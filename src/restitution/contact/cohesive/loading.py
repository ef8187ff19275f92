"""Loading of cohesive contacts: the path from bodies far apart to a depth, a force or a work."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from functools import partial

from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import CohesiveState, rigid_start
from restitution.contact.cohesive.steps import ACCURACY, follow
from restitution.contact.contact import Contact
from restitution.contact.state import State

# A path to a force or work goes this multiple of the estimated distance, to end beyond it, and at
# least _ONWARD z₀.
_BEYOND, _ONWARD = 1.02, 0.01


def load_cohesive(
    contact: Contact,
    indentation: float,
    *,
    start: State | None,
    residual: float,
    accuracy: float = ACCURACY,
) -> CohesiveState:
    """Load the undeformed bodies to `indentation` from far apart, or from the path to `start`.

    Raises `CaseError` if the grid is too coarse, and `NotConvergedError`.
    """
    law_of(contact).require_fine_grid(contact)
    begin = _on_the_way(start, lambda state: state.indentation > indentation)
    if begin is not None:
        return move(begin, indentation, residual, accuracy)
    limit, convolutions = contact.plasticity.bound(contact, -math.inf, residual)
    begin = rigid_start(contact, limit=limit, residual=residual)
    convolutions += begin.convolutions
    if begin.indentation > indentation:
        return replace(begin, convolutions=convolutions)
    end = move(begin, indentation, residual, accuracy)
    return replace(end, convolutions=convolutions + end.convolutions)


def _on_the_way(
    start: State | None, beyond: Callable[[CohesiveState], bool]
) -> CohesiveState | None:
    """The deepest state of the loading path to `start` that is not `beyond`; None if unknown."""
    if not isinstance(start, CohesiveState) or not start.is_first_loading:
        return None
    state: CohesiveState | None = start
    while state is not None and beyond(state):
        state = state.before
    return state


def move(
    state: CohesiveState, indentation: float, residual: float, accuracy: float = ACCURACY
) -> CohesiveState:
    """Follow the path to `indentation`; the last state has the `convolutions` of the path."""
    end, convolutions = state, 0
    for end in follow(state, indentation, residual=residual, accuracy=accuracy):
        convolutions += end.convolutions
    return replace(end, convolutions=convolutions)


def load_until(
    contact: Contact,
    reached: Callable[[State], bool],
    ahead: Callable[[State, float], float],
    *,
    start: State | None,
    residual: float,
    scale: float = 0.0,
    accuracy: float = ACCURACY,
) -> tuple[CohesiveState, CohesiveState]:
    """Return the last state of loading that is not `reached`, and the first state that is.

    If it is true at the beginning, both are this state. `ahead` estimates the distance (m) that is
    left from a state and the stiffness there (N/m). `scale` and `accuracy` are those of `follow`.
    """
    before = _on_the_way(start, reached)
    if before is None:
        before = load_cohesive(contact, -math.inf, start=None, residual=residual)
    if reached(before):
        return before, before
    z0 = law_of(contact).equilibrium_separation

    def goal(state: CohesiveState) -> float:
        if state.force <= 0 or state.before is None:
            return math.inf
        stiffness = state.force - state.before.force
        stiffness /= state.indentation - state.before.indentation
        return state.indentation + max(_BEYOND * ahead(state, stiffness), _ONWARD * z0)

    onward = partial(follow, residual=residual, accuracy=accuracy, scale=scale, goal=goal)
    for state in onward(before, math.inf):
        if reached(state):
            return before, state
        before = state
    raise AssertionError("a path without an end ended")
