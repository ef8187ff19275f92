"""Unload a contact in the JKR limit to separation, with step sizes that meet a tolerance.

In each step the bodies first retract with a fixed contact area, so the force is linear in the
indentation. Then nodes are released, later than in continuous unloading. The late release reduces
the work that the contact returns by half the jump of the force times the step.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.jkr.area import (
    balances_are_reliable,
    jkr_of,
    pull_off_of_punch,
    unload_adhesive,
)
from restitution.contact.jkr.unloading_curve import SharedUnloading, complete_curve, unloading_curve
from restitution.contact.models import RESTITUTION_ERROR, Separation
from restitution.contact.state import State
from restitution.errors import NotConvergedError

_ACCURACY = 1e-3  # tolerance of the solves as a fraction of the crack opening at the edge
_STEPS_OF_RECOVERY = 8  # smallest number of steps into which the elastic recovery is divided

_FINEST = 400  # the shortest step is the pull-off displacement of this punch divided by _FINEST
_REFINEMENTS = (1, 2, 4)  # factors of the number of steps, tried in turn to meet the tolerance

_MOST_STEPS = 3000  # steps after which unloading counts as not converged


def separate(
    state: State,
    *,
    tolerance: float = RESTITUTION_ERROR,
    known: Sequence[State] = (),
) -> Iterator[State]:
    """Yield `state` and the states of unloading to separation, the last of them without contact.

    If the estimated error of COR exceeds `tolerance`, unloading is repeated with 2 and finally 4
    times as many steps. `known` are states of another unloading of the same contact, which began at
    a smaller indentation. If no node has yielded, unloading ends as soon as its force agrees with
    theirs, and the remaining states are taken from `known`. Raises `NotConvergedError` if the
    bodies do not separate.
    """
    model = jkr_of(state.contact)
    for finer in _REFINEMENTS:
        path = list(_unload(state, tolerance / finer, finer, known))
        separation = separation_of(path)
        returned, given = separation.unloading_work, state.loading_work
        # COR is e = sqrt(W_u/W_l) with the works of unloading and loading, so the errors satisfy
        # 2 de/e = dW_u/W_u + dW_l/W_l. If the pair sticks, e = 0 and the number of steps does not
        # matter. Finer steps do not reduce the error due to the loading work. So this error counts
        # at most as half of the tolerance.
        if returned <= 0 or given <= 0:
            break
        half = 0.5 * math.sqrt(returned / given)
        loading = min(half * state.work_error / given, 0.5 * tolerance)
        if half * separation.error / returned + loading <= tolerance:
            break
        surface_energy = model.work_of_adhesion * state.contact_area
        if separation.error <= model.detachment.small_error * surface_energy:
            break
    yield from path


def _unload(
    state: State, tolerance: float, finer: int, known: Sequence[State] = ()
) -> Iterator[State]:
    contact, model = state.contact, jkr_of(state.contact)
    other = SharedUnloading.of(state, known)
    yield state
    if state.contact_nodes == 0:
        return  # loading by `PullIncrements` can end with all nodes released
    recovery, allowed = _plan(state, tolerance)
    step = math.inf
    previous: State | None = None
    for _ in range(_MOST_STEPS):
        reach, punch_force = pull_off_of_punch(state)
        longest = recovery / (finer * _STEPS_OF_RECOVERY)
        shortened = reach / (finer * model.detachment.steps_of_tension)
        if state.force < 0.1 * abs(punch_force):
            longest = min(longest, shortened)
        elif previous is not None:
            # End the step before the force reaches zero, because steps under tension must be
            # shorter. In a Hertz-like recovery (F ∝ δ^1.5), a step of force/slope covers two thirds
            # of the way to zero force. The factor 1.3 extends the step to 87 % of the way.
            slope = (previous.force - state.force) / (previous.indentation - state.indentation)
            if slope > 0:
                longest = min(longest, max(1.3 * state.force / slope, shortened))
        step = min(step, longest)
        at = state.indentation - step
        new = unload_adhesive(
            state,
            at,
            first_guess=_predict(previous, state, step),
            residual=_ACCURACY
            * model.crack_opening(contact)
            / model.residual_length(contact.pair, at),
        )
        late = _late_force(new)
        if new.contact_nodes == 0:
            # Pull-off lies within this step. Shorten the step to locate pull-off more closely.
            if step > reach / _FINEST:
                step /= 4
                continue
            yield new
            return
        if late > 3 * allowed and step > reach / _FINEST:
            step /= 2
            continue
        require_inside_grid(new)
        previous, state = state, new
        yield state
        if other is not None and other.agrees(state):
            yield from other.below(state)
            return
        step *= min(2.0, max(0.5, 0.8 * allowed / late if late > 0 else 2.0))
    raise NotConvergedError(
        f"the bodies have not separated after {_MOST_STEPS} steps of unloading (indentation "
        f"{1e9 * state.indentation:.4g} nm, force {state.force:.3g} N); check work_of_adhesion "
        f"({model.work_of_adhesion:g} J/m2), or increase the tolerance of COR"
    )


def separation_of(path: list[State]) -> Separation:
    depth = np.array([state.indentation for state in path])
    force = np.array([state.force for state in path])
    start, end = path[0], path[-1]
    trapezoid = -float(np.trapezoid(force, depth))
    late = -float(np.dot([_late_force(state) for state in path[1:]], np.diff(depth)))
    # The energy that the bodies lose along the path must equal the work of the force. In each step,
    # the force falls linearly and then jumps up when nodes are released. `trapezoid` uses the force
    # after the jump instead of the force before it, so it exceeds the work by `late`.
    unaccounted = (start.loading_work - end.loading_work) - (trapezoid - late)
    curve, lateness = unloading_curve(path), jkr_of(start.contact).detachment.lateness
    by_curve = curve.work()
    # Unloading returns at most the elastic energy.
    work = min(by_curve, start.stored_energy) if curve.balanced else by_curve
    # Unloading work from the curve minus unloading work from the forces of the states.
    scatter = work - trapezoid if curve.balanced else 0.0
    return Separation(
        unloading_work=work,
        error=abs(by_curve - curve.halved().work())
        + (by_curve - work)
        + (0.0 if curve.balanced else lateness * abs(late))
        + abs(unaccounted),
        adhesive_loss=start.adhesive_work - end.adhesive_work - late - scatter,
        pull_off_force=max(0.0, curve.largest_tension()),
        separation_indentation=complete_curve(path)[-1][0],
        convolutions=sum(state.convolutions for state in path[1:]),
        steps=len(path) - 1,
    )


def _late_force(state: State) -> float:
    """Error of the mean force (N) of a step, because nodes are released only at its end."""
    assert state.force_before_release is not None  # `unload_adhesive` always sets it
    return 0.5 * (state.force - state.force_before_release)


def _plan(state: State, tolerance: float) -> tuple[float, float]:
    """Estimate the elastic recovery (m), and the `_late_force` (N) that meets the `tolerance`."""
    model = jkr_of(state.contact)
    stored, adhesion = state.stored_energy, model.work_of_adhesion * state.contact_area
    # The elastic recovery is estimated in two ways, and the smaller value is used. The first
    # estimate belongs to a flat punch with the same area and stored energy. The second one belongs
    # to a Hertz-like contact with the same force and stored energy.
    a = math.sqrt(state.contact_area / math.pi)
    recovery = 1.5 * math.sqrt(stored / (state.contact.pair.contact_modulus * a))
    if state.force > 0:
        recovery = min(recovery, 2.2 * stored / state.force)
    recovery = max(recovery, pull_off_of_punch(state)[0])
    # The allowed error of the work is proportional to COR, so it would vanish for pairs that stick.
    # For COR below 0.05, the value at COR = 0.05 is used.
    work = max(state.loading_work, 0.05 * stored)
    restitution = math.sqrt(max(stored - adhesion, 0.0) / work)
    # With the loading work W_l, dCOR = dW/(2 W_l COR). If dCOR is the tolerance, the allowed error
    # of the work is dW = 2 W_l COR dCOR. Half of dW is reserved for the error of the loading work.
    allowed = tolerance * max(restitution, 0.05) * work
    # Where balances (G equals the work of adhesion) are reliable, the work is computed from them. A
    # late release of nodes then does no harm, so `_late_force` needs no limit.
    if balances_are_reliable(state):
        return recovery, math.inf
    return recovery, allowed / (model.detachment.lateness * recovery)


def _predict(previous: State | None, state: State, step: float) -> NDArray[np.float64] | None:
    """Extrapolate the pressure at the nodes in contact linearly, by a `step` (m) of unloading.

    The tolerance of a solve is large, so a better first guess gives a more accurate result.
    """
    if previous is None:
        return None
    slope = step / (previous.indentation - state.indentation)
    before, now = previous.pressure_on(state.box), state.box_pressure
    return np.where(now != 0, now + slope * (now - before), 0.0)
