"""Follow a branch of equilibria of a cohesive contact step by step, with the dissipated energy.

In a step without instability the work of the force equals the change of the potential energy plus
the plastic work. Where the solve descends to another equilibrium, the excess of the work is the
energy dissipated by adhesion. Its uncertainty is half the jump of the force times the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive.equilibrium import (
    CohesiveState,
    FarEquilibriumError,
    interacting_box,
    law_of,
    on_box,
    solve_cohesive,
    with_interaction,
)
from restitution.contact.cohesive.guide import Guide
from restitution.contact.state import Array
from restitution.errors import NotConvergedError
from restitution.numerics.box import reframe, shape_of, union

# In a step without a jump, the work of the force must equal the change of energy. This is the
# largest accepted difference, as a fraction of the reference energy `reference_energy`.
ACCURACY = 5e-4
# The work of the force in a step is computed twice: by the trapezium rule, and from the quartic
# through energies and forces. A step counts as free of jumps only if the two works are nearly
# equal. Their difference must not exceed _CORRECTION times the error that is allowed for the step.
# If the difference is larger, the force may have jumped, and the quartic may be right by chance.
_CORRECTION = 10.0
# Tolerances of the solves of loading between the given depths, whose errors can become plastic
# displacement, and of unloading under pressure.
_BETWEEN, _BACK = 1e-5, 1e-4
# Under tension, at most this fraction of the length of a step in units of z₀, because short steps
# are those before a jump, and less where the largest displacement is below z₀.
_OF_STEP = 2e-5
_FIRST_STEP = 0.25  # length of the first step, in units of the equilibrium separation z₀

# Longest step under tension, as a fraction of the sum of z₀ and the adhesive length, while the gap
# is below _NEAR z₀. Under tension, the error of a step is this share of that of others.
# At least, it is the share _SLIGHT of that where unloading began.
_UNDER_TENSION, _NEAR, _TENSE, _SLIGHT = 0.4, 2.0, 0.4, 0.02
# Largest relative error of the largest tension where it ends in a jump, but no step is made shorter
# than _AT_FOLD z₀ for it.
_AT_JUMP, _AT_FOLD = 3e-3, 0.01
# Longest step with a jump after another jump, in units of z₀. The energy lost in a longer one may
# be the error of the trapezium rule.
_ALONE = 0.08
_GROWTH = 3.0  # largest ratio of the lengths of two steps
_NEARLY = 0.8  # a step of this share of the way that is left goes all the way
# A solve that may pass a jump ends where a node moves by this distance, in units of z₀, from its
# start. In lactose with Rq 0.15 nm the largest change was below 0.35 z₀ on the branch, and above
# 1.2 z₀ after a jump.
_REACH = 0.5
_MOST_AHEAD = 4  # states that are kept
# Shortest step, in units of z₀. If even this step fails, the path cannot be followed, and an error
# is raised.
_LEAST_STEP = 1e-5
_MOST_STEPS = 5000

# When the box (the part of the grid that is solved) must grow, it is made large enough for about
# this multiple of the next indentation. So it seldom grows.
_WIDER = 1.5
# In unloading it shrinks where this share of its nodes suffices.
_NARROWER = 0.4

_Limit = Callable[[CohesiveState, CohesiveState], float]  # of the error (J) of a step


@dataclass(frozen=True)
class _Step:
    """A trial step: the state at its end, the work of the force by two rules, and energies (J).

    `change` is that of the potential energy plus the plastic work. `uncertainty` is the error if
    the force has jumped in the step.
    """

    state: CohesiveState
    by_trapezium: float
    by_quartic: float
    change: float
    uncertainty: float

    @classmethod
    def of(cls, state: CohesiveState, new: CohesiveState) -> _Step:
        previous = _earlier(state, new.indentation)
        way, force, before = new.indentation - state.indentation, new.force, state.force
        trapezium = 0.5 * (force + before) * way
        change = new.potential_energy - state.potential_energy
        return cls(
            new,
            trapezium,
            trapezium if previous is None else _quartic(previous, state, new),
            change + new.plastic_work - state.plastic_work,
            0.5 * abs(force - before) * abs(way),
        )

    @property
    def off(self) -> float:
        """Work of the force (J) minus the change of energy."""
        return self.by_quartic - self.change

    def is_smooth(self, allowed: float) -> bool:
        correction = abs(self.by_quartic - self.by_trapezium)
        return abs(self.off) <= allowed and correction <= _CORRECTION * allowed


class _Ahead:
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

    def joined(self, state: CohesiveState, limit: _Limit) -> CohesiveState | None:
        """The nearest known state, if it is on the branch of `state`, as far as energies show."""
        if not self._states or self._compared is state:
            return None
        self._compared, nearest = state, self._states[-1]
        return nearest if _Step.of(state, nearest).is_smooth(limit(state, nearest)) else None

    def next(self, state: CohesiveState, tension: float) -> tuple[float, float]:
        """Where the next solve is to end, and how far it may go from its start (m)."""
        assert self.left is not None
        z0 = law_of(state.contact).equilibrium_separation
        width = abs(self.left - state.indentation)
        jump = abs(self._states[-1].force - state.force)
        near = 0.5 * jump * width <= self._allowed and not _is_long(state, self.left, tension)
        if near or width <= 2 * _LEAST_STEP * z0:
            return self.left, math.inf
        return 0.5 * (state.indentation + self.left), _REACH * z0


def follow(
    state: CohesiveState,
    target: float,
    *,
    residual: float,
    accuracy: float = ACCURACY,
    scale: float = 0.0,
    guide: Guide | None = None,
    goal: Callable[[CohesiveState], float] | None = None,
) -> Iterator[CohesiveState]:
    """Yield the equilibria from `state` (not included) to the indentation `target`.

    The error of a step is `accuracy` times the energy `scale` (J), at least that of the step
    itself and, in loading, a lower bound of that at `target`. If `target` is infinite, the caller
    must stop the iteration. `goal` estimates the target from each state anew. The solves start from
    the changes along `guide`. Raises `NotConvergedError` if an equilibrium cannot be followed.
    """
    z0 = law_of(state.contact).equilibrium_separation
    sign = 1.0 if target > state.indentation else -1.0
    shortest = _FIRST_STEP * z0
    if state.smallest_gap < 1.1 * z0:  # the bodies touch
        shortest = max(shortest, (0.02 if sign > 0 else 0.08) * abs(state.indentation))
    length = shortest
    # The last step before a prescribed depth is often short, so the one before counts, too.
    later, earlier = state, _earlier(state, target)
    for _ in range(2):
        if earlier is not None:
            length = max(length, abs(later.indentation - earlier.indentation))
            later, earlier = earlier, _earlier(earlier, target)
    rejected = 0  # convolutions of steps that were not accepted
    tension = 0.0
    ahead = _Ahead(sign)
    require_inside_grid(state)
    for _ in range(_MOST_STEPS):
        target = target if goal is None else goal(state)
        limit = partial(_allowed, accuracy=accuracy, scale=scale, target=target)
        left = abs(target - state.indentation)
        if left == 0:
            return
        tension = max(tension, -state.force)
        reach = math.inf
        known = ahead.joined(state, limit)
        if known is not None:
            at = known.indentation
        elif ahead.left is not None:
            at, reach = ahead.next(state, tension)
        else:
            at = _next(state, target, length)
            if guide is not None and at != target:
                at = guide.stop(state.indentation, at)
        length, last = abs(at - state.indentation), at == target
        state_on = _on_fitting_box(state, at, target, residual)
        if state_on is not state:
            rejected += state_on.convolutions
            state = state_on
        try:
            loose = residual if last else max(residual, _tolerance(state, at))
            step = _try(state, at, loose, known or guide, reach)
        except FarEquilibriumError as left_branch:
            rejected += left_branch.convolutions
            ahead.left = at
            continue
        except NotConvergedError:
            if length <= 8 * _LEAST_STEP * z0:
                raise
            length /= 4
            ahead.left = None
            continue
        new = step.state
        allowed = limit(state, new)
        smooth = step.is_smooth(allowed)
        coarse = step.uncertainty > allowed or _is_long(state, at, tension)
        if not smooth and coarse and length > _LEAST_STEP * z0:
            ahead.reject(new, allowed)
            rejected += new.convolutions
            continue
        state = _accounted(state, step, smooth)
        require_inside_grid(state)
        yield replace(state, convolutions=state.convolutions + rejected)
        rejected = 0
        ahead.pass_to(state, smooth)
        if smooth:
            room = allowed / max(abs(step.off), 1e-300)
            length *= min(_GROWTH, max(0.5, 0.8 * room ** (1 / 4)))
        else:
            length = max(2 * length, shortest)
    raise NotConvergedError(
        f"the cohesive contact took more than {_MOST_STEPS} steps up to an indentation of "
        f"{1e9 * state.indentation:.4g} nm; refine the grid"
    )


def _next(state: CohesiveState, target: float, length: float) -> float:
    """Indentation (m) at the end of a step of about `length` (m) towards `target`."""
    law, z0 = law_of(state.contact), law_of(state.contact).equilibrium_separation
    left = abs(target - state.indentation)
    if state.force < 0 and state.smallest_gap < _NEAR * z0:
        # Do not step over the largest tension.
        length = min(length, _UNDER_TENSION * (z0 + law.length(state.contact.pair)))
    elif target < state.indentation and state.force > 0 and state.before is not None:
        length = min(length, _to_tension(state, length))
    if length >= _NEARLY * left:
        return target
    return state.indentation + math.copysign(min(length, 0.5 * left), target - state.indentation)


def _tolerance(state: CohesiveState, at: float) -> float:
    """Tolerance of a solve at the indentation `at` between the given depths."""
    if state.force > 0:
        return _BETWEEN if at > state.indentation else _BACK
    z0 = law_of(state.contact).equilibrium_separation
    if state.smallest_gap > _NEAR * z0:  # the forces of bodies far apart are small
        return 0.0
    deformed = min(float(np.abs(state.box_displacement).max()) / z0, 1.0)
    return min(_BETWEEN, _OF_STEP * deformed * abs(at - state.indentation) / z0)


def _allowed(
    state: CohesiveState, new: CohesiveState, *, accuracy: float, scale: float, target: float
) -> float:
    """Largest accepted error (J) of the step from `state` to `new`."""
    loading = new.indentation > state.indentation
    here = reference_energy(new, loading=loading)
    if new.force > 0 and state.force > 0:
        return accuracy * max(scale, here + (_work_ahead(state, new, target) if loading else 0.0))
    return accuracy * max(_TENSE * here, _SLIGHT * scale)


def _work_ahead(state: CohesiveState, new: CohesiveState, target: float) -> float:
    """Lower bound of the work (J) from `new` to `target`, because the contact stiffens."""
    if math.isinf(target):
        return 0.0
    left = target - new.indentation
    stiffness = (new.force - state.force) / (new.indentation - state.indentation)
    return left * (new.force + 0.5 * max(stiffness, 0.0) * left)


def _is_long(state: CohesiveState, at: float, tension: float) -> bool:
    """Whether a step with a jump to the indentation `at` is too long, wherever it jumps."""
    length = abs(at - state.indentation)
    alone = length > _ALONE * law_of(state.contact).equilibrium_separation
    return (alone and _earlier(state, at) is None) or _misses_tension(state, length, tension)


def _misses_tension(state: CohesiveState, length: float, tension: float) -> bool:
    """Whether the largest tension may be larger than `tension`, that at `state`, before a jump."""
    before = state.before
    shortest = _AT_FOLD * law_of(state.contact).equilibrium_separation
    if before is None or state.force >= 0 or -state.force < tension or length < shortest:
        return False
    slope = (state.force - before.force) / (state.indentation - before.indentation)
    return slope * length > _AT_JUMP * tension


def _to_tension(state: CohesiveState, length: float) -> float:
    """Distance (m) to where the force is expected to vanish, at least a quarter of `length`."""
    assert state.before is not None
    slope = (state.force - state.before.force) / (state.indentation - state.before.indentation)
    return max(state.force / slope, 0.25 * length) if slope > 0 else length


def _accounted(state: CohesiveState, step: _Step, smooth: bool) -> CohesiveState:
    lost = 0.0 if smooth else max(step.by_trapezium - step.change, 0.0)
    error = 0.0 if smooth else min(step.uncertainty, max(lost, abs(step.change)))
    unaccounted = state.unaccounted + (step.by_quartic - step.change if smooth else 0.0)
    return with_interaction(
        replace(
            step.state,
            adhesive_loss=state.adhesive_loss + lost,
            jumps=state.jumps + int(not smooth),
            unaccounted=unaccounted,
            work_error=step.state.work_error + abs(unaccounted) - abs(state.unaccounted) + error,
            before=state if smooth else None,
        )
    )


def _earlier(state: CohesiveState, at: float) -> CohesiveState | None:
    """The state before `state` on the way to the indentation `at`."""
    before = state.before
    if before is None or (at - state.indentation) * (state.indentation - before.indentation) <= 0:
        return None
    return before


def _try(
    state: CohesiveState,
    at: float,
    residual: float,
    guide: Guide | CohesiveState | None,
    reach: float = math.inf,
) -> _Step:
    contact, box = state.contact, state.box
    limit, convolutions = contact.plasticity.bound_after(state, at, residual)
    new = solve_cohesive(
        contact,
        at,
        box,
        start=_start(state, at, guide),
        limit=limit,
        history=state,
        residual=residual,
        reach=reach,
    )
    plastic, plastic_error = contact.plasticity.work(state, new)
    new = replace(
        new,
        plastic_work=state.plastic_work + plastic,
        work_error=state.work_error + plastic_error,
        convolutions=new.convolutions + convolutions,
    )
    return _Step.of(state, new)


def _start(
    state: CohesiveState, at: float, guide: Guide | CohesiveState | None
) -> tuple[Array, Array | None]:
    """Pressure and displacement from which the solve at the indentation `at` begins.

    `guide` is the path of other bodies, or a state at `at`.
    """
    box, p = state.box, state.box_pressure
    if isinstance(guide, CohesiveState):
        if guide.box == box:
            return guide.box_pressure, guide.box_displacement
        return reframe(guide.box_pressure, guide.box, box), None
    change = None if guide is None else guide.change(state.indentation, at, box)
    if change is not None:
        return p + change, None
    previous = _earlier(state, at)
    if previous is None:
        return p, state.box_displacement
    ratio = (at - state.indentation) / (state.indentation - previous.indentation)
    if previous.box == box:
        u = state.box_displacement
        p = p + ratio * (p - previous.box_pressure)
        return p, u + ratio * (u - previous.box_displacement)
    inside = reframe(np.ones(shape_of(previous.box), dtype=bool), previous.box, box)
    change = p - reframe(previous.box_pressure, previous.box, box)
    return p + ratio * np.where(inside, change, 0.0), None


def _quartic(previous: CohesiveState, state: CohesiveState, new: CohesiveState) -> float:
    """Work in the step from `state` to `new` by the quartic through energies and forces.

    The derivative of the energy is the force in all three states; the energy of `new` is not used.
    """
    way = new.indentation - state.indentation
    g = (previous.indentation - state.indentation) / way
    energy = previous.potential_energy + previous.plastic_work
    energy -= state.potential_energy + state.plastic_work
    first = state.force * way
    c = np.linalg.solve(
        [[g**2, g**3, g**4], [2 * g, 3 * g**2, 4 * g**3], [2.0, 3.0, 4.0]],
        [energy - first * g, previous.force * way - first, new.force * way - first],
    )
    return first + float(c.sum())


def reference_energy(state: CohesiveState, *, loading: bool) -> float:
    """Reference energy (J). The allowed error of a step is a fraction of this energy."""
    scale = state.stored_energy + abs(state.interaction_energy)
    return scale + state.plastic_work if loading else scale


def _on_fitting_box(
    state: CohesiveState, at: float, target: float, residual: float
) -> CohesiveState:
    """`state` on a box for the way to `at`: wider in loading, narrower in unloading."""
    contact = state.contact
    if at < state.indentation:
        box = interacting_box(contact, state.indentation, state)
        if math.prod(shape_of(box)) > _NARROWER * math.prod(shape_of(state.box)):
            return state
        return on_box(state, box, residual=residual)
    needed = interacting_box(contact, at, state)
    if union(state.box, needed) == state.box:
        return state
    z0 = law_of(contact).equilibrium_separation
    far = at + (_WIDER - 1) * (max(at, 0.0) + 10 * z0)
    wider = interacting_box(contact, min(far, max(target, at)), state)
    joined = union(state.box, union(needed, wider))
    assert joined is not None
    return on_box(state, joined, residual=max(residual, _BETWEEN))
