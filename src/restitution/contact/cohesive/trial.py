"""Steps along a branch of equilibria: the work of the force beside the change of the energies."""

from __future__ import annotations

from dataclasses import dataclass

from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import CohesiveState
from restitution.numerics.box import intersection, reframe
from restitution.numerics.expressions import max_magnitude

# The work of the force in a step is computed twice: by the trapezium rule, and from the quartic
# through energies and forces. A step counts as free of jumps only if the two works are nearly
# equal. Their difference must not exceed _CORRECTION times the error that is allowed for the step.
# If the difference is larger, the force may have jumped, and the quartic may be right by chance.
_CORRECTION = 10.0
# Under tension, a step in which a node moves by this distance, in units of z₀, may have a jump. In
# lactose with Rq 0.15 nm the largest change was below 0.35 z₀ on the branch, and above 0.6 z₀
# after a jump.
LEAP = 0.5


@dataclass(frozen=True)
class TrialStep:
    """A trial step: the state at its end, the work of the force by two rules, and energies (J).

    `change` is that of the potential energy plus the plastic work. `uncertainty` is the error if
    the force has jumped in the step, from the force at its beginning or from that which the step
    before predicts. `leaps` tells whether a node has moved too far under tension.
    """

    state: CohesiveState
    by_trapezium: float
    by_quartic: float
    change: float
    uncertainty: float
    leaps: bool

    @classmethod
    def of(cls, state: CohesiveState, new: CohesiveState) -> TrialStep:
        previous = earlier_state(state, new.indentation)
        way, force, before = new.indentation - state.indentation, new.force, state.force
        trapezium = 0.5 * (force + before) * way
        change = new.potential_energy - state.potential_energy
        quartic, slope, jump = trapezium, 0.0, force - before
        if previous is not None:
            quartic = _quartic(previous, state, new)
            slope = (before - previous.force) / (state.indentation - previous.indentation)
        return cls(
            new,
            trapezium,
            quartic,
            change + new.plastic_work - state.plastic_work,
            0.5 * abs(way) * max(abs(jump), abs(jump - slope * way)),
            min(force, before) < 0 and _largest_move(state, new) > LEAP,
        )

    @property
    def off(self) -> float:
        """Work of the force (J) minus the change of energy."""
        return self.by_quartic - self.change

    def is_smooth(self, allowed: float) -> bool:
        if self.leaps and self.uncertainty > allowed:
            return False
        correction = abs(self.by_quartic - self.by_trapezium)
        return abs(self.off) <= allowed and correction <= _CORRECTION * allowed


def _largest_move(state: CohesiveState, new: CohesiveState) -> float:
    """Largest change of the displacement of a node of both boxes, in units of z₀."""
    box = intersection(state.box, new.box)
    here, there = (reframe(one.box_displacement, one.box, box) for one in (state, new))
    return max_magnitude(there - here) / law_of(new.contact).equilibrium_separation


def earlier_state(state: CohesiveState, at: float) -> CohesiveState | None:
    """The state before `state` on the way to the indentation `at`."""
    before = state.before
    if before is None or (at - state.indentation) * (state.indentation - before.indentation) <= 0:
        return None
    return before


def _quartic(previous: CohesiveState, state: CohesiveState, new: CohesiveState) -> float:
    """Work in the step from `state` to `new` by the quartic through energies and forces.

    The derivative of the energy is the force in all three states; the energy of `new` is not used.
    """
    way = new.indentation - state.indentation
    g = (previous.indentation - state.indentation) / way
    first = state.force * way
    energy = previous.potential_energy + previous.plastic_work
    energy -= state.potential_energy + state.plastic_work
    # Beyond `first` x, the quartic is c₂x² + c₃x³ + c₄x⁴ with x from 0 to 1 in the step; here are
    # its value and slope at x = g, and its slope at x = 1.
    energy -= first * g
    before, after = previous.force * way - first, new.force * way - first
    c4 = after + 6 * energy * (1 - g) / g**3 + before * (2 * g - 3) / g**2
    c4 /= 2 * (g - 1) * (g - 2)
    c3 = (before - 2 * energy / g) / g**2 - 2 * g * c4
    c2 = energy / g**2 - g * c3 - g**2 * c4
    return first + c2 + c3 + c4


def reference_energy(state: CohesiveState, *, loading: bool) -> float:
    """Reference energy (J). The allowed error of a step is a fraction of this energy."""
    scale = state.stored_energy + abs(state.interaction_energy)
    return scale + state.plastic_work if loading else scale
