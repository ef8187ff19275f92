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
from restitution.contact.state import State
from restitution.errors import NotConvergedError
from restitution.numerics.box import reframe, shape_of, union
from restitution.numerics.quadrature import integrate_curve

# In a step without a jump, the work of the force must equal the change of energy. This is the
# largest accepted difference, as a fraction of the reference energy `_scale`.
ACCURACY = 2e-4
# The work of the force in a step is computed twice: by the trapezium rule, and from the parabola
# through three forces. A step counts as free of jumps only if the two works are nearly equal. Their
# difference must not exceed _CORRECTION times the error that is allowed for the step. If the
# difference is larger, the force may have jumped, and the parabola may be right only by chance.
_CORRECTION = 10.0
_FIRST_STEP = 0.25  # length of the first step, in units of the equilibrium separation z₀

# Longest step of unloading under tension, as a fraction of the sum of z₀ and the adhesive length.
_UNDER_TENSION = 0.15
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
_WIDER = 1.3


def load_cohesive(
    contact: Contact,
    indentation: float,
    *,
    start: State | None,
    residual: float,
    accuracy: float = ACCURACY,
) -> CohesiveState:
    """Load the undeformed bodies to `indentation` from far apart, or from a shallower `start`.

    Raises `CaseError` if the grid is too coarse, and `NotConvergedError`.
    """
    law_of(contact).require_fine_grid(contact)
    if (
        isinstance(start, CohesiveState)
        and start.is_first_loading
        and start.indentation <= indentation
    ):
        return move(start, indentation, residual, accuracy)
    limit, convolutions = contact.plasticity.bound(contact, -math.inf, residual)
    begin = rigid_start(contact, limit=limit, residual=residual)
    convolutions += begin.convolutions
    if begin.indentation > indentation:
        return replace(begin, convolutions=convolutions)
    end = move(begin, indentation, residual, accuracy)
    return replace(end, convolutions=convolutions + end.convolutions)


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
    *,
    start: State | None,
    residual: float,
) -> tuple[CohesiveState, CohesiveState]:
    """Return the last state of loading that is not `reached`, and the first state that is.

    If it is true at the beginning, both are this state.
    """
    begin = start.indentation if isinstance(start, CohesiveState) else -math.inf
    before = load_cohesive(contact, begin, start=start, residual=residual)
    if reached(before):
        return before, before
    for state in follow(before, math.inf, residual=residual):
        if reached(state):
            return before, state
        before = state
    raise NotConvergedError("the loading path has ended early")  # never: `follow` raises first


def separate_cohesive(
    state: CohesiveState, *, accuracy: float = ACCURACY, known: Sequence[State] = ()
) -> Iterator[State]:
    """Yield `state` and the states of unloading until the rest of the separation is reversible.

    `known` are states of another unloading of the same contact, from a smaller indentation. If
    neither has yielded and both come to the same equilibrium, the states below it are taken from
    `known`.
    """
    yield state
    tension = max(0.0, -state.force)
    state = replace(state, is_first_loading=False)
    shared = _shared(state, known)
    for meeting in shared[:: max(1, len(shared) // _MEETINGS)]:
        for new in follow(state, meeting.indentation, residual=1e-8, accuracy=accuracy):
            tension = max(tension, -new.force)
            state = new
            yield new
        if _is_same(state, meeting):
            yield from _continued(state, shared[shared.index(meeting) :])
            return
    for new in follow(state, -math.inf, residual=1e-8, accuracy=accuracy):
        tension = max(tension, -new.force)
        yield new
        if new.contact_nodes == 0 and -new.force <= _FARTHEST * tension and is_unique(new):
            return


def _shared(state: CohesiveState, known: Sequence[State]) -> list[CohesiveState]:
    """The states of `known` in contact that unloading from `state` may pass through."""
    path = [cast(CohesiveState, earlier) for earlier in known]
    if not path or path[0].contact is not state.contact:
        return []
    if state.plastic_displacement.any() or path[-1].plastic_displacement.any():
        return []
    return path if path[0].indentation < state.indentation else []


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
    """A trial step: the state at its end, the work of the force by two rules, and energies (J).

    `change` is that of the potential energy plus the plastic work. `uncertainty` is the error
    if the force has jumped in the step.
    """

    state: CohesiveState
    by_trapezium: float
    by_parabola: float
    change: float
    uncertainty: float


def follow(
    state: CohesiveState, target: float, *, residual: float, accuracy: float = ACCURACY
) -> Iterator[CohesiveState]:
    """Yield the equilibria from `state` (not included) to the indentation `target`.

    If `target` is infinite, the caller must stop the iteration. Raises `NotConvergedError` if an
    equilibrium cannot be followed.
    """
    law, pair = law_of(state.contact), state.contact.pair
    z0 = law.equilibrium_separation
    sign = 1.0 if target > state.indentation else -1.0
    length = _FIRST_STEP * z0
    # If the bodies touch, the first step is at least 2 % of the indentation.
    if state.smallest_gap < 1.1 * z0:
        length = max(length, 0.02 * abs(state.indentation))
    previous: CohesiveState | None = None
    rejected = 0  # convolutions of steps that were not accepted
    require_inside_grid(state)
    for _ in range(_MOST_STEPS):
        left = abs(target - state.indentation)
        if left == 0:
            return
        if sign < 0 and state.force < 0 and state.smallest_gap < 1.2 * z0:
            # Do not step over the largest tension.
            length = min(length, _UNDER_TENSION * (z0 + law.length(pair)))
        last = length >= left * (1 - 1e-9)
        at = target if last else state.indentation + sign * min(length, 0.5 * left)
        length = abs(at - state.indentation)
        state_on = _on_wider_box(state, at, residual)
        if state_on is not state:
            rejected += state_on.convolutions
            state, previous = state_on, None
        try:
            step = _try(previous, state, at, residual)
        except NotConvergedError:
            if length <= 8 * _LEAST_STEP * z0:
                raise
            length /= 4
            continue
        allowed = accuracy * _scale(step.state, loading=sign > 0)
        off = step.by_parabola - step.change
        correction = abs(step.by_parabola - step.by_trapezium)
        smooth = abs(off) <= allowed and correction <= _CORRECTION * allowed
        if not smooth and step.uncertainty > allowed and length > _LEAST_STEP * z0:
            length /= 2 if step.uncertainty < 4 * allowed else 4
            rejected += step.state.convolutions
            continue
        new = _accounted(state, step, smooth)
        require_inside_grid(new)
        # The next step must not extrapolate across a jump between equilibria.
        previous, state = (state if smooth else None), new
        yield replace(new, convolutions=new.convolutions + rejected)
        rejected = 0
        room = allowed / max(abs(off), 1e-300)
        length *= min(2.0, max(0.5, 0.8 * room ** (1 / 3))) if smooth else 2.0
    raise NotConvergedError(
        f"the cohesive contact took more than {_MOST_STEPS} steps up to an indentation of "
        f"{1e9 * state.indentation:.4g} nm; refine the grid"
    )


def _accounted(state: CohesiveState, step: _Step, smooth: bool) -> CohesiveState:
    lost = 0.0 if smooth else max(step.by_trapezium - step.change, 0.0)
    error = 0.0 if smooth else min(step.uncertainty, max(lost, abs(step.change)))
    unaccounted = state.unaccounted + (step.by_parabola - step.change if smooth else 0.0)
    return with_interaction(
        replace(
            step.state,
            adhesive_loss=state.adhesive_loss + lost,
            jumps=state.jumps + int(not smooth),
            unaccounted=unaccounted,
            work_error=step.state.work_error + abs(unaccounted) - abs(state.unaccounted) + error,
        )
    )


def _try(previous: CohesiveState | None, state: CohesiveState, at: float, residual: float) -> _Step:
    contact, box = state.contact, state.box
    limit, convolutions = contact.plasticity.bound_after(state, at, residual)
    p, u = state.box_pressure, state.box_displacement
    if previous is not None and previous.box == box:
        ratio = (at - state.indentation) / (state.indentation - previous.indentation)
        if ratio > 0:
            p = p + ratio * (p - previous.box_pressure)
            u = u + ratio * (u - previous.box_displacement)
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
    return _Step(
        new,
        trapezium,
        parabola,
        new.potential_energy - state.potential_energy + plastic,
        0.5 * abs(force - before) * abs(way),
    )


def _parabola(previous: CohesiveState, state: CohesiveState, new: CohesiveState) -> float:
    a = state.indentation - previous.indentation
    b = new.indentation - state.indentation
    second = ((new.force - state.force) / b - (state.force - previous.force) / a) / (a + b)
    return 0.5 * (new.force + state.force) * b - second * b**3 / 6


def _scale(state: CohesiveState, *, loading: bool) -> float:
    """Reference energy (J). The allowed error of a step is a fraction of this energy."""
    scale = state.stored_energy + abs(state.interaction_energy)
    return scale + state.plastic_work if loading else scale


def _on_wider_box(state: CohesiveState, at: float, residual: float) -> CohesiveState:
    needed = interacting_box(state.contact, at, state)
    if union(state.box, needed) == state.box:
        return state
    z0 = law_of(state.contact).equilibrium_separation
    wider = interacting_box(state.contact, at + (_WIDER - 1) * (max(at, 0.0) + 10 * z0), state)
    box = union(state.box, union(needed, wider))
    assert box is not None
    return on_box(state, box, residual=residual)


def separation_of(path: list[State]) -> Separation:
    start, end = cast(CohesiveState, path[0]), cast(CohesiveState, path[-1])
    lost = end.adhesive_loss - start.adhesive_loss
    plastic = end.plastic_work - start.plastic_work
    work = start.potential_energy - lost - plastic
    depth, force = ([getattr(state, key) for state in path] for key in ("indentation", "force"))
    by_force = end.potential_energy - integrate_curve(depth, force)
    steps = max(abs(end.work_error - start.work_error), abs(by_force - work))
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
