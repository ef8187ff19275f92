"""Unloading of cohesive contacts to separation."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import cast

import numpy as np

from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import (
    CohesiveState,
    is_unique,
    solve_cohesive,
    with_interaction,
    with_losses_of,
)
from restitution.contact.cohesive.guide import Guide
from restitution.contact.cohesive.steps import ACCURACY, USUAL, follow
from restitution.contact.cohesive.trial import reference_energy
from restitution.contact.models import Separation
from restitution.contact.state import State
from restitution.numerics.box import reframe, shape_of, union
from restitution.numerics.quadrature import integrate_curve

# Tolerances of the solves under tension and at rest, and of those of inserted states.
_RESIDUAL, _INSERTED = 1e-8, 1e-6
# States are inserted at the largest tension until it agrees with its parabola within this fraction
# at the default accuracy, and in proportion to it.
_PEAK, _MOST_INSERTED = 1e-3, 4
# Nodes that part one by one make several largest tensions. So a state is inserted on either side
# of the largest where the next one is farther than _APART z₀, and again if a force differs from
# that of the parabola by more than the fraction _SMOOTH.
_APART, _ROUNDS, _SMOOTH = 0.03, 4, 3e-4
# Unloading ends where the tension is below this fraction of the largest tension, at the usual
# accuracy and, in proportion, at a lower one.
_FARTHEST = 0.02
# States are compared with those of a known unloading at this many indentations. They are the same
# if their displacements differ by at most this fraction of z₀.
_MEETINGS, _SAME = 4, 1e-3


def separate_cohesive(
    state: CohesiveState, *, accuracy: float = ACCURACY, known: Sequence[State] = ()
) -> Iterator[State]:
    """Yield `state` and the states of unloading until the rest of the separation is reversible.

    `known` are states of another unloading of the same contact, from a smaller indentation, which
    guide this one. If neither has yielded and both come to the same equilibrium, the states below
    it are taken from `known`.
    """
    own: list[CohesiveState] = []
    joined = _separating(state, accuracy, known, own)
    if joined and min(new.force for new in joined) <= min(new.force for new in own):
        yield from (*own, *joined)  # the states around the largest tension are known
    else:
        loose = accuracy / ACCURACY
        path = _with_largest_tension((*own, *joined), loose)
        yield from _between_nodes(path, loose)


def _separating(
    state: CohesiveState, accuracy: float, known: Sequence[State], own: list[CohesiveState]
) -> Sequence[CohesiveState]:
    """Append the states of unloading to `own`, and return those that are taken from `known`."""
    own.append(state)
    loaded, scale = state, reference_energy(state, loading=False)
    state = replace(state, is_first_loading=False, before=None)
    # Otherwise the steps of loading are too long.
    if accuracy >= law_of(loaded.contact).loading_accuracy(loaded.contact):
        passed = _shared(loaded, loaded.indentation, known)
        for earlier in _branch(loaded):
            state = _reversed(loaded, earlier)
            own.append(state)
            for number, other in enumerate(passed):
                if other.box_displacement is earlier.box_displacement:
                    return list(_continued(state, passed[number:]))
    shared = _shared(loaded, state.indentation, known)
    guide = Guide.of(known, loaded)
    back = partial(follow, residual=_RESIDUAL, accuracy=accuracy, scale=scale, guide=guide)
    for meeting in shared[:: max(1, len(shared) // _MEETINGS)]:
        own.extend(back(state, meeting.indentation))
        state = own[-1]
        if _is_same(state, meeting):
            return list(_continued(state, shared[shared.index(meeting) :]))
    tension, farthest = max(-one.force for one in own), _FARTHEST * max(1.0, accuracy / USUAL)
    for new in back(state, -math.inf):
        own.append(new)
        tension = max(tension, -new.force)
        if new.contact_nodes == 0 and -new.force <= farthest * tension and is_unique(new):
            break
    return ()


def _branch(state: CohesiveState) -> Iterator[CohesiveState]:
    """The shallower states through which a contact that has not yielded unloads reversibly."""
    if state.plastic_displacement.any():
        return
    while (before := state.before) is not None and before.indentation < state.indentation:
        state = before
        yield state


def _reversed(loaded: CohesiveState, earlier: CohesiveState) -> CohesiveState:
    """The state `earlier` of loading as a state of the unloading from `loaded`."""
    unaccounted = 2 * loaded.unaccounted - earlier.unaccounted
    return with_interaction(
        replace(
            earlier,
            adhesive_loss=loaded.adhesive_loss,
            jumps=loaded.jumps,
            unaccounted=unaccounted,
            work_error=2 * loaded.jump_error - earlier.jump_error + abs(unaccounted),
            convolutions=0,
            is_first_loading=False,
            before=None,
        )
    )


def _with_largest_tension(path: Sequence[CohesiveState], loose: float) -> Iterator[CohesiveState]:
    """Yield `path`, with states inserted where the tension is largest between its states.

    `loose` is the accuracy of the path, as a multiple of the default.
    """
    a, b = None, None
    for c in path:
        if b is not None:
            yield from _peak(a, b, c, loose)
        a, b = b, c
    assert b is not None
    yield b


def _between_nodes(path: Iterator[CohesiveState], loose: float) -> Iterator[CohesiveState]:
    """Yield `path`, with states inserted on either side of the largest tension.

    They are `loose` times as far apart as by default, and as inaccurate.
    """
    held: list[CohesiveState] = []  # from the state before that of the largest tension
    tension = 0.0
    for state in path:
        if -state.force > tension:
            tension = -state.force
            yield from held[:-1]
            held = held[-1:]
        held.append(state)
    for _ in range(_ROUNDS):
        k = min(range(len(held)), key=lambda i: held[i].force)
        top, ends = held[k], (*held[max(k - 1, 0) : k], *held[k + 1 : k + 2])
        inserted = [
            _between(end, top, at, loose) for end in ends if (at := _halfway(end, top, loose))
        ]
        held = sorted([*held, *inserted], key=lambda state: -state.indentation)
        if len(ends) < 2:
            break
        if all(_on_parabola((ends[0], top, ends[1]), new, loose) for new in inserted):
            break
    yield from held


def _halfway(end: CohesiveState, top: CohesiveState, loose: float) -> float | None:
    """Indentation between two states of one branch; None if they are near each other."""
    way = abs(end.indentation - top.indentation)
    near = way <= loose * _APART * law_of(top.contact).equilibrium_separation
    return None if near or end.jumps != top.jumps else 0.5 * (end.indentation + top.indentation)


def _on_parabola(
    around: tuple[CohesiveState, CohesiveState, CohesiveState], new: CohesiveState, loose: float
) -> bool:
    """Whether the force of `new` is that of the parabola through three states."""
    slope, second = _parabola(*around)
    x = new.indentation - around[1].indentation
    expected = around[1].force + x * (slope + second * x)
    return abs(new.force - expected) <= loose * _SMOOTH * abs(expected)


def _peak(
    a: CohesiveState | None, b: CohesiveState, c: CohesiveState, loose: float
) -> Iterator[CohesiveState]:
    """Yield `b` and the states inserted beside it."""
    states = [b]
    left, middle, right, tolerance = a, b, c, loose * _PEAK
    for _ in range(_MOST_INSERTED):
        if left is None or not left.jumps == middle.jumps == right.jumps:
            break
        if not middle.force < min(0.0, left.force, right.force):
            break
        at, expected = _vertex(left, middle, right)
        deeper = at > middle.indentation
        if abs(at - middle.indentation) < tolerance * abs(right.indentation - left.indentation):
            break
        new = _between(left if deeper else right, middle, at, loose)
        states.append(new)
        if abs(new.force - expected) <= tolerance * abs(expected):
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
    slope, second = _parabola(a, b, c)
    way = -0.5 * slope / second
    return b.indentation + way, b.force + 0.5 * slope * way


def _parabola(a: CohesiveState, b: CohesiveState, c: CohesiveState) -> tuple[float, float]:
    """Coefficients of x and x² of the force through three states, at the distance x from `b`."""
    left, right = b.indentation - a.indentation, c.indentation - b.indentation
    slopes = (b.force - a.force) / left, (c.force - b.force) / right
    second = (slopes[1] - slopes[0]) / (left + right)
    return slopes[0] + second * left, second


def _between(a: CohesiveState, b: CohesiveState, at: float, loose: float) -> CohesiveState:
    """The equilibrium at an indentation between two states of one branch, near `b`."""
    share = (at - b.indentation) / (a.indentation - b.indentation)
    p = b.box_pressure + share * (reframe(a.box_pressure, a.box, b.box) - b.box_pressure)
    new = solve_cohesive(
        b.contact,
        at,
        b.box,
        start=(p, None),
        limit=b.bound,
        history=b,
        residual=_INSERTED * min(1.0, loose),
    )
    return with_losses_of(b, new)


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
        unaccounted = state.unaccounted + new.unaccounted - first.unaccounted
        yield with_interaction(
            replace(
                new,
                adhesive_loss=state.adhesive_loss + new.adhesive_loss - first.adhesive_loss,
                jumps=state.jumps + new.jumps - first.jumps,
                unaccounted=unaccounted,
                work_error=state.jump_error + new.jump_error - first.jump_error + abs(unaccounted),
                convolutions=0,
            )
        )


def separation_of(path: list[State]) -> Separation:
    start, end = cast(CohesiveState, path[0]), cast(CohesiveState, path[-1])
    lost = end.adhesive_loss - start.adhesive_loss
    plastic = end.plastic_work - start.plastic_work
    work = start.potential_energy - lost - plastic
    depth, force = ([getattr(state, key) for state in path] for key in ("indentation", "force"))
    by_force = end.potential_energy - integrate_curve(depth, force)
    steps = end.jump_error - start.jump_error + abs(end.unaccounted - start.unaccounted)
    steps = max(steps, abs(by_force - work))
    return Separation(
        unloading_work=work,
        error=steps + law_of(start.contact).grid_loss(start.contact) * lost,
        adhesive_loss=lost,
        pull_off_force=_largest_tension(path),
        separation_indentation=_end_of_contact(path),
        convolutions=sum(state.convolutions for state in path[1:]),
        steps=len(path) - 1,
    )


def _end_of_contact(path: list[State]) -> float:
    """Indentation (m) at which the smallest gap becomes that of the largest attraction."""
    last = max((k for k, state in enumerate(path) if state.contact_nodes), default=None)
    if last is None or last + 1 == len(path):
        return path[0 if last is None else -1].indentation
    before, after = (cast(CohesiveState, state) for state in path[last : last + 2])
    if before.jumps != after.jumps:
        return after.indentation
    goal = law_of(before.contact).gap_of_largest_traction
    way = (goal - before.smallest_gap) / (after.smallest_gap - before.smallest_gap)
    way = min(max(way, 0.0), 1.0)  # the smallest gap need not be that of the last node
    return before.indentation + way * (after.indentation - before.indentation)


def _largest_tension(path: list[State]) -> float:
    """Largest tension (N): the vertex of a parabola, or a force if it jumps there."""
    force = [state.force for state in path]
    k = int(np.argmin(force))
    largest = max(0.0, -force[k])
    around = [cast(CohesiveState, state) for state in path[max(k - 1, 0) : k + 2]]
    alike = len({state.jumps for state in around}) == 1
    if len(around) < 3 or not alike or len({state.force for state in around}) == 1:
        return largest
    return max(largest, -_vertex(*around)[1])
