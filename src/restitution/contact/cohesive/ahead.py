"""Jumps on the way of a cohesive contact: where solves have left the branch, and how near to go."""

from __future__ import annotations

import math
from collections.abc import Callable

from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import CohesiveState
from restitution.contact.cohesive.trial import LEAP, TrialStep, earlier_state

# Largest relative error of the largest tension where it ends in a jump, but no step is made shorter
# than _AT_FOLD z₀ for it.
_AT_JUMP, _AT_FOLD = 3e-3, 0.01
# Longest step with a jump after another jump, in units of z₀. The energy lost in a longer one may
# be the error of the trapezium rule.
_ALONE = 0.08
_MOST_AHEAD = 4  # states that are kept
# Shortest step, in units of z₀. If even this step fails, the path cannot be followed, and an error
# is raised.
LEAST_STEP = 1e-5

Limit = Callable[[CohesiveState, CohesiveState], float]  # of the error (J) of a step


class WayAhead:
    """What solves that were not accepted have shown of the way ahead.

    `left` is the nearest indentation (m) at which a solve has left the branch; None if unknown.
    """

    def __init__(self, sign: float) -> None:
        self.left: float | None = None
        self._sign = sign
        self._states: list[CohesiveState] = []  # the nearest is the last
        self._allowed = 0.0
        self._compared: CohesiveState | None = None

    def reject(self, new: CohesiveState, allowed: float) -> None:
        self.left, self._allowed = new.indentation, allowed
        if self._states and self._states[-1].indentation == new.indentation:
            self._states.pop()
        self._states = [*self._states[1 - _MOST_AHEAD :], new]

    def pass_to(self, state: CohesiveState, smooth: bool) -> None:
        at = self._sign * state.indentation
        while self._states and self._sign * self._states[-1].indentation <= at:
            self._states.pop()
        if not smooth or (self.left is not None and self._sign * self.left <= at):
            self.left = None

    def joined(self, state: CohesiveState, limit: Limit) -> CohesiveState | None:
        """The nearest known state, if it is on the branch of `state`, as far as energies show."""
        if not self._states or self._compared is state:
            return None
        self._compared, nearest = state, self._states[-1]
        return nearest if TrialStep.of(state, nearest).is_smooth(limit(state, nearest)) else None

    def next(self, state: CohesiveState, tension: float) -> tuple[float, float]:
        """Where the next solve is to end, and how far it may go from its start (m)."""
        assert self.left is not None
        z0 = law_of(state.contact).equilibrium_separation
        width = abs(self.left - state.indentation)
        uncertainty = TrialStep.of(state, self._states[-1]).uncertainty
        near = uncertainty <= self._allowed and not is_long(state, self.left, tension)
        if near or width <= 2 * LEAST_STEP * z0:
            return self.left, math.inf
        # In a step longer than z₀, nodes move farther than in a jump.
        return 0.5 * (state.indentation + self.left), max(LEAP * z0, 0.5 * width)


def is_long(state: CohesiveState, at: float, tension: float) -> bool:
    """Whether a step with a jump to the indentation `at` is too long, wherever it jumps."""
    length = abs(at - state.indentation)
    alone = length > _ALONE * law_of(state.contact).equilibrium_separation
    return (alone and earlier_state(state, at) is None) or _misses_tension(state, length, tension)


def _misses_tension(state: CohesiveState, length: float, tension: float) -> bool:
    """Whether the largest tension may be larger than `tension`, that at `state`, before a jump."""
    before = state.before
    shortest = _AT_FOLD * law_of(state.contact).equilibrium_separation
    if before is None or state.force >= 0 or -state.force < tension or length < shortest:
        return False
    slope = (state.force - before.force) / (state.indentation - before.indentation)
    return slope * length > _AT_JUMP * tension
