"""Paths of cohesive contacts: loading and unloading to separation, with the dissipated energy.

In a step without instability the work of the force equals the change of the potential energy plus
the plastic work. Where the solve descends to another equilibrium, the excess of the work is the
energy dissipated by adhesion. Its uncertainty is half the jump of the force times the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import cast

import numpy as np

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive.equilibrium import (
    CohesiveState,
    interacting_box,
    is_unique,
    law_of,
    on_box,
    rigid_start,
    solve_cohesive,
    with_interaction,
)
from restitution.contact.contact import Contact
from restitution.contact.models import Separation
from restitution.contact.state import Array, State
from restitution.errors import NotConvergedError
from restitution.numerics.box import reframe, shape_of, union

# In a step without a jump, the work of the force must equal the change of energy. This is the
# largest accepted difference, as a fraction of the reference energy `_scale`.
ACCURACY = 5e-4
# The work of the force in a step is computed twice: by the trapezium rule, and from the parabola
# through three forces. A step counts as free of jumps only if the two works are nearly equal. Their
# difference must not exceed _CORRECTION times the error that is allowed for the step. If the
# difference is larger, the force may have jumped, and the parabola may be right only by chance.
_CORRECTION = 10.0
# Tolerances of the solves of unloading under tension and at rest, of the solves of loading between
# the given depths, whose errors can become plastic displacement, and of unloading under pressure.
_RESIDUAL, _BETWEEN, _BACK = 1e-8, 1e-5, 1e-4
_FIRST_STEP = 0.25  # length of the first step, in units of the equilibrium separation z₀

# Longest step under tension, as a fraction of the sum of z₀ and the adhesive length, while the gap
# is below _NEAR z₀. Under tension, the error of a step is this share of that of others.
# At least, it is the share _SLIGHT of that where unloading began.
_UNDER_TENSION, _NEAR, _TENSE, _SLIGHT = 0.4, 2.0, 0.4, 0.02
# Largest relative error of the largest tension where it ends in a jump, but no step is made shorter
# than _AT_FOLD z₀ for it.
_AT_JUMP, _AT_FOLD = 3e-3, 0.01
_GROWTH = 3.0  # largest ratio of the lengths of two steps
# A path to a force or work goes this multiple of the estimated distance, to end beyond it.
_BEYOND = 1.02
# States are inserted at the largest tension until it agrees with its parabola within this fraction.
_PEAK, _MOST_INSERTED = 1e-3, 4
# Shortest step, in units of z₀. If even this step fails, the path cannot be followed, and an error
# is raised.
_LEAST_STEP = 1e-5
_MOST_STEPS = 5000
_FARTHEST = 0.02  # unloading ends where the tension is below this fraction of the largest tension

# States are compared with those of a known unloading at this many indentations. They are the same
# if their displacements differ by at most this fraction of z₀.
_MEETINGS, _SAME = 4, 1e-3

# When the box (the part of the grid that is solved) must grow, it is made large enough for about
# this multiple of the next indentation. So it seldom grows.
_WIDER = 2.0
# In unloading it shrinks where this share of its nodes suffices.
_NARROWER = 0.4


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
) -> tuple[CohesiveState, CohesiveState]:
    """Return the last state of loading that is not `reached`, and the first state that is.

    If it is true at the beginning, both are this state. `ahead` estimates the distance (m) that is
    left from a state and the stiffness there (N/m).
    """
    before = _on_the_way(start, reached)
    if before is None:
        before = load_cohesive(contact, -math.inf, start=None, residual=residual)
    if reached(before):
        return before, before
    z0 = law_of(contact).equilibrium_separation
    while True:
        way = max(before.indentation, 4 * z0)
        if before.force > 0 and before.before is not None:
            stiffness = before.force - before.before.force
            stiffness /= before.indentation - before.before.indentation
            way = min(way, _BEYOND * ahead(before, stiffness))
        for state in follow(before, before.indentation + way, residual=residual):
            if reached(state):
                return before, state
            before = state


def separate_cohesive(
    state: CohesiveState, *, accuracy: float = ACCURACY, known: Sequence[State] = ()
) -> Iterator[State]:
    """Yield `state` and the states of unloading until the rest of the separation is reversible.

    `known` are states of another unloading of the same contact, from a smaller indentation. If
    neither has yielded and both come to the same equilibrium, the states below it are taken from
    `known`.
    """
    yield from _with_largest_tension(_separating(state, accuracy, known))


def _separating(
    state: CohesiveState, accuracy: float, known: Sequence[State]
) -> Iterator[CohesiveState]:
    yield state
    tension = max(0.0, -state.force)
    loaded, scale = state, _scale(state, loading=False)
    options = {"residual": _RESIDUAL, "accuracy": accuracy, "scale": scale}
    state = replace(state, is_first_loading=False, before=None)
    if accuracy >= ACCURACY:  # otherwise the steps of loading are too long
        for earlier in _branch(loaded):
            state = _reversed(loaded, earlier)
            tension = max(tension, -state.force)
            yield state
    shared = _shared(loaded, state.indentation, known)
    for meeting in shared[:: max(1, len(shared) // _MEETINGS)]:
        for new in follow(state, meeting.indentation, **options):
            tension = max(tension, -new.force)
            state = new
            yield new
        if _is_same(state, meeting):
            yield from _continued(state, shared[shared.index(meeting) :])
            return
    for new in follow(state, -math.inf, **options):
        tension = max(tension, -new.force)
        yield new
        if new.contact_nodes == 0 and -new.force <= _FARTHEST * tension and is_unique(new):
            return


def _branch(state: CohesiveState) -> Iterator[CohesiveState]:
    """The shallower states through which a contact that has not yielded unloads reversibly."""
    if state.plastic_displacement.any():
        return
    while (before := state.before) is not None and before.indentation < state.indentation:
        state = before
        yield state


def _reversed(loaded: CohesiveState, earlier: CohesiveState) -> CohesiveState:
    """The state `earlier` of loading as a state of the unloading from `loaded`."""
    return with_interaction(
        replace(
            earlier,
            adhesive_loss=loaded.adhesive_loss,
            jumps=loaded.jumps,
            unaccounted=2 * loaded.unaccounted - earlier.unaccounted,
            work_error=2 * loaded.work_error - earlier.work_error,
            convolutions=0,
            is_first_loading=False,
            before=None,
        )
    )


def _with_largest_tension(path: Iterator[CohesiveState]) -> Iterator[CohesiveState]:
    """Yield `path`, with states inserted where the tension is largest between its states."""
    a, b = None, None
    for c in path:
        if b is not None:
            yield from _peak(a, b, c)
        a, b = b, c
    assert b is not None
    yield b


def _peak(a: CohesiveState | None, b: CohesiveState, c: CohesiveState) -> Iterator[CohesiveState]:
    """Yield `b` and the states inserted beside it."""
    states = [b]
    left, middle, right = a, b, c
    for _ in range(_MOST_INSERTED):
        if left is None or not left.jumps == middle.jumps == right.jumps:
            break
        if not middle.force < min(0.0, left.force, right.force):
            break
        at, expected = _vertex(left, middle, right)
        deeper = at > middle.indentation
        if abs(at - middle.indentation) < _PEAK * abs(right.indentation - left.indentation):
            break
        new = _between(left if deeper else right, middle, at)
        states.append(new)
        if abs(new.force - expected) <= _PEAK * abs(expected):
            break
        if new.force < middle.force:
            left, right = (left, middle) if deeper else (middle, right)
            middle = new
        elif deeper:
            left = new
        else:
            right = new
    yield from sorted(states, key=lambda state: -state.indentation)


def _vertex(a: CohesiveState, b: CohesiveState, c: CohesiveState) -> tuple[float, float]:
    """Indentation and force at the vertex of the parabola through three states."""
    left, right = b.indentation - a.indentation, c.indentation - b.indentation
    slopes = (b.force - a.force) / left, (c.force - b.force) / right
    second = (slopes[1] - slopes[0]) / (left + right)
    slope = slopes[0] + second * left
    way = -0.5 * slope / second
    return b.indentation + way, b.force + 0.5 * slope * way


def _between(a: CohesiveState, b: CohesiveState, at: float) -> CohesiveState:
    """The equilibrium at an indentation between two states of one branch, near `b`."""
    share = (at - b.indentation) / (a.indentation - b.indentation)
    p = b.box_pressure + share * (reframe(a.box_pressure, a.box, b.box) - b.box_pressure)
    new = solve_cohesive(b.contact, at, b.box, p=p, limit=b.bound, history=b, residual=_RESIDUAL)
    return with_interaction(
        replace(
            new,
            adhesive_loss=b.adhesive_loss,
            jumps=b.jumps,
            unaccounted=b.unaccounted,
        )
    )


def _shared(
    loaded: CohesiveState, indentation: float, known: Sequence[State]
) -> list[CohesiveState]:
    """The states of `known`, not above `indentation`, that unloading may pass through."""
    path = [cast(CohesiveState, earlier) for earlier in known]
    if not path or path[0].contact is not loaded.contact:
        return []
    if loaded.plastic_displacement.any() or path[-1].plastic_displacement.any():
        return []
    if path[0].indentation >= loaded.indentation:
        return []
    return [state for state in path if state.indentation <= indentation]


def _is_same(state: CohesiveState, other: CohesiveState) -> bool:
    box = union(state.box, other.box)
    assert box is not None
    here, there = (reframe(one.box_displacement, one.box, box) for one in (state, other))
    inside = reframe(np.ones(shape_of(state.box), dtype=bool), state.box, box)
    inside &= reframe(np.ones(shape_of(other.box), dtype=bool), other.box, box)
    apart = float(np.abs(here - there)[inside].max(initial=0.0))
    return apart <= _SAME * law_of(state.contact).equilibrium_separation


def _continued(state: CohesiveState, path: Sequence[CohesiveState]) -> Iterator[CohesiveState]:
    """Yield `path` after its first state, with the losses and errors of `state` added."""
    first = path[0]
    for new in path[1:]:
        yield with_interaction(
            replace(
                new,
                adhesive_loss=state.adhesive_loss + new.adhesive_loss - first.adhesive_loss,
                jumps=state.jumps + new.jumps - first.jumps,
                unaccounted=state.unaccounted + new.unaccounted - first.unaccounted,
                work_error=state.work_error + new.work_error - first.work_error,
                convolutions=0,
            )
        )


@dataclass(frozen=True)
class _Step:
    """A trial step: the state at its end, the work of the force by three rules, and energies (J).

    `by_quartic` uses two earlier states if there are two, `by_parabola` three forces. `change` is
    that of the potential energy plus the plastic work. `uncertainty` is the error if the force has
    jumped in the step.
    """

    state: CohesiveState
    by_trapezium: float
    by_parabola: float
    by_quartic: float
    change: float
    uncertainty: float


def follow(
    state: CohesiveState,
    target: float,
    *,
    residual: float,
    accuracy: float = ACCURACY,
    scale: float = 0.0,
) -> Iterator[CohesiveState]:
    """Yield the equilibria from `state` (not included) to the indentation `target`.

    The error of a step is `accuracy` times the energy `scale` (J), at least that of the step
    itself and, in loading, a lower bound of that at `target`. If `target` is infinite, the caller
    must stop the iteration. Raises `NotConvergedError` if an equilibrium cannot be followed.
    """
    law, pair = law_of(state.contact), state.contact.pair
    z0 = law.equilibrium_separation
    sign = 1.0 if target > state.indentation else -1.0
    shortest = _FIRST_STEP * z0
    if state.smallest_gap < 1.1 * z0:  # the bodies touch
        shortest = max(shortest, (0.02 if sign > 0 else 0.08) * abs(state.indentation))
    length = shortest
    if (earlier := _earlier(state, target)) is not None:
        length = max(length, abs(state.indentation - earlier.indentation))
    rejected = 0  # convolutions of steps that were not accepted
    tension = 0.0
    require_inside_grid(state)
    for _ in range(_MOST_STEPS):
        left = abs(target - state.indentation)
        if left == 0:
            return
        if state.force < 0 and state.smallest_gap < _NEAR * z0:
            # Do not step over the largest tension.
            length = min(length, _UNDER_TENSION * (z0 + law.length(pair)))
        elif sign < 0 and state.force > 0 and state.before is not None:
            length = min(length, _to_tension(state, length))
        last = length >= left * (1 - 1e-9)
        at = target if last else state.indentation + sign * min(length, 0.5 * left)
        length = abs(at - state.indentation)
        state_on = _on_fitting_box(state, at, target, residual)
        if state_on is not state:
            rejected += state_on.convolutions
            state = state_on
        try:
            fine = last or state.force <= 0  # the forces of bodies far apart are small
            loose = _BETWEEN if sign > 0 else _BACK
            step = _try(state, at, residual if fine else max(residual, loose))
        except NotConvergedError:
            if length <= 8 * _LEAST_STEP * z0:
                raise
            length /= 4
            continue
        new = step.state
        here = _scale(new, loading=sign > 0)
        if new.force > 0 and state.force > 0:
            ahead = _work_ahead(state, new, target) if sign > 0 else 0.0
            allowed = accuracy * max(scale, here + ahead)
        else:
            allowed = accuracy * max(_TENSE * here, _SLIGHT * scale)
        off = step.by_quartic - step.change
        correction = abs(step.by_quartic - step.by_parabola)
        smooth = abs(off) <= allowed and correction <= _CORRECTION * allowed
        tension = max(tension, -state.force)
        coarse = step.uncertainty > allowed or _misses_tension(state, length, tension)
        if not smooth and coarse and length > _LEAST_STEP * z0:
            length /= 2 if step.uncertainty < 4 * allowed else 4
            rejected += new.convolutions
            continue
        state = _accounted(state, step, smooth)
        require_inside_grid(state)
        yield replace(state, convolutions=state.convolutions + rejected)
        rejected = 0
        if smooth:
            room = allowed / max(abs(off), 1e-300)
            length *= min(_GROWTH, max(0.5, 0.8 * room ** (1 / 4)))
        else:
            length = max(2 * length, shortest)
    raise NotConvergedError(
        f"the cohesive contact took more than {_MOST_STEPS} steps up to an indentation of "
        f"{1e9 * state.indentation:.4g} nm; refine the grid"
    )


def _work_ahead(state: CohesiveState, new: CohesiveState, target: float) -> float:
    """Lower bound of the work (J) from `new` to `target`, because the contact stiffens."""
    if math.isinf(target):
        return 0.0
    left = target - new.indentation
    stiffness = (new.force - state.force) / (new.indentation - state.indentation)
    return left * (new.force + 0.5 * max(stiffness, 0.0) * left)


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


def _try(state: CohesiveState, at: float, residual: float) -> _Step:
    contact, box = state.contact, state.box
    limit, convolutions = contact.plasticity.bound_after(state, at, residual)
    previous = _earlier(state, at)
    p = state.box_pressure
    u: Array | None = state.box_displacement
    if previous is not None:
        ratio = (at - state.indentation) / (state.indentation - previous.indentation)
        if previous.box == box:
            p = p + ratio * (p - previous.box_pressure)
            u = state.box_displacement + ratio * (
                state.box_displacement - previous.box_displacement
            )
        else:
            known = reframe(np.ones(shape_of(previous.box), dtype=bool), previous.box, box)
            change = p - reframe(previous.box_pressure, previous.box, box)
            p, u = p + ratio * np.where(known, change, 0.0), None
    new = solve_cohesive(contact, at, box, p=p, u=u, limit=limit, history=state, residual=residual)
    plastic, plastic_error = contact.plasticity.work(state, new)
    new = replace(
        new,
        plastic_work=state.plastic_work + plastic,
        work_error=state.work_error + plastic_error,
        convolutions=new.convolutions + convolutions,
    )
    way, force, before = at - state.indentation, new.force, state.force
    trapezium = 0.5 * (force + before) * way
    parabola = trapezium if previous is None else _parabola(previous, state, new)
    quartic = trapezium if previous is None else _quartic(previous, state, new)
    return _Step(
        new,
        trapezium,
        parabola,
        quartic,
        new.potential_energy - state.potential_energy + plastic,
        0.5 * abs(force - before) * abs(way),
    )


def _parabola(previous: CohesiveState, state: CohesiveState, new: CohesiveState) -> float:
    a = state.indentation - previous.indentation
    b = new.indentation - state.indentation
    second = ((new.force - state.force) / b - (state.force - previous.force) / a) / (a + b)
    return 0.5 * (new.force + state.force) * b - second * b**3 / 6


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


def _scale(state: CohesiveState, *, loading: bool) -> float:
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


def separation_of(path: list[State]) -> Separation:
    start, end = cast(CohesiveState, path[0]), cast(CohesiveState, path[-1])
    lost = end.adhesive_loss - start.adhesive_loss
    plastic = end.plastic_work - start.plastic_work
    work = start.potential_energy - lost - plastic
    steps = abs(end.work_error - start.work_error)
    last = max((k for k, state in enumerate(path) if state.contact_nodes), default=0)
    return Separation(
        unloading_work=work,
        error=steps + law_of(start.contact).grid_loss(start.contact) * lost,
        adhesive_loss=lost,
        pull_off_force=_largest_tension(path),
        separation_indentation=path[min(last + 1, len(path) - 1)].indentation,
        convolutions=sum(state.convolutions for state in path[1:]),
        steps=len(path) - 1,
    )


def _largest_tension(path: list[State]) -> float:
    """Largest tension (N): the vertex of a parabola, or a force if it jumps there."""
    force = np.array([state.force for state in path])
    k = int(force.argmin())
    largest = max(0.0, -float(force[k]))
    around = path[k - 1 : k + 2]
    if not 0 < k < len(path) - 1 or len({cast(CohesiveState, s).jumps for s in around}) > 1:
        return largest
    depth = np.array([state.indentation for state in around]) - path[k].indentation
    scale = float(np.abs(depth).max())
    a, b, c = np.polyfit(depth / scale, force[k - 1 : k + 2], 2)
    return max(largest, float(b * b / (4 * a) - c)) if a > 0 else largest
