"""Follow a branch of equilibria of a cohesive contact step by step, with the dissipated energy.

In a step without instability the work of the force equals the change of the potential energy plus
the plastic work. Where the solve descends to another equilibrium, the excess of the work is the
energy dissipated by adhesion. Its uncertainty is half the jump of the force times the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive.ahead import LEAST_STEP, WayAhead, is_long
from restitution.contact.cohesive.bounded_law import law_of
from restitution.contact.cohesive.equilibrium import (
    CohesiveState,
    FarEquilibriumError,
    interacting_box,
    on_box,
    solve_cohesive,
    with_interaction,
)
from restitution.contact.cohesive.guide import Guide
from restitution.contact.cohesive.trial import TrialStep, earlier_state, reference_energy
from restitution.contact.state import Array
from restitution.errors import NotConvergedError
from restitution.numerics.box import reframe, shape_of, union

# In a step without a jump, the work of the force must equal the change of energy. This is the
# largest accepted difference, as a fraction of the reference energy `reference_energy`.
ACCURACY = 5e-4
# Tolerances of the solves of loading between the given depths, whose errors can become plastic
# displacement, and of unloading under pressure, at most _LOOSEST times as large.
_BETWEEN, _BACK, _LOOSEST = 1e-5, 1e-4, 3.0
USUAL = 0.5 * ACCURACY  # accuracy of unloading by default
# Under tension, at most this fraction of the length of a step in units of z₀, because short steps
# are those before a jump, and less where the largest displacement is below z₀.
_OF_STEP = 2e-5
_FIRST_STEP = 0.25  # length of the first step, in units of the equilibrium separation z₀

# Longest step under tension, as a fraction of the sum of z₀ and the adhesive length, while the gap
# is below _NEAR z₀. Under tension, the error of a step is this share of that of others.
# At least, it is the share _SLIGHT of that where unloading began.
_UNDER_TENSION, _NEAR, _TENSE, _SLIGHT = 0.4, 2.0, 0.4, 0.02
_GROWTH = 3.0  # largest ratio of the lengths of two steps
_NEARLY = 0.8  # a step of this share of the way that is left goes all the way
_MOST_STEPS = 5000

# When the box (the part of the grid that is solved) must grow, it is made large enough for about
# this multiple of the next indentation. So it seldom grows.
_WIDER = 1.5
# In unloading it shrinks where this share of its nodes suffices.
_NARROWER = 0.4


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
        share = 0.02 if sign > 0 else 0.08 * (accuracy / USUAL) ** (1 / 4)
        shortest = max(shortest, share * abs(state.indentation))
    length = shortest
    # The last step before a prescribed depth is often short, so the one before counts, too.
    later, earlier = state, earlier_state(state, target)
    for _ in range(2):
        if earlier is not None:
            length = max(length, abs(later.indentation - earlier.indentation))
            later, earlier = earlier, earlier_state(earlier, target)
    rejected = 0  # convolutions of steps that were not accepted
    tension = 0.0
    ahead = WayAhead(sign)
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
        loose = _tolerance(state, at, accuracy, residual)
        state_on = _on_fitting_box(state, at, target, loose)
        if state_on is not state:
            rejected += state_on.convolutions
            state = state_on
        try:
            step = _try(state, at, residual if last else loose, known or guide, reach)
        except FarEquilibriumError as left_branch:
            rejected += left_branch.convolutions
            ahead.left = at
            continue
        except NotConvergedError:
            if length <= 8 * LEAST_STEP * z0:
                raise
            length /= 4
            ahead.left = None
            continue
        new = step.state
        allowed = limit(state, new)
        smooth = step.is_smooth(allowed)
        coarse = step.uncertainty > allowed or is_long(state, at, tension)
        if not smooth and coarse and length > LEAST_STEP * z0:
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
            if step.leaps:
                length = max(length, shortest)
        else:
            length = max(2 * length, shortest)
    raise NotConvergedError(
        f"the cohesive contact took more than {_MOST_STEPS} steps up to an indentation of "
        f"{1e9 * state.indentation:.4g} nm; refine the grid"
    )


def _next(state: CohesiveState, target: float, length: float) -> float:
    """Indentation (m) at the end of a step of about `length` (m) towards `target`."""
    law = law_of(state.contact)
    z0 = law.equilibrium_separation
    left = abs(target - state.indentation)
    if state.force < 0 and state.smallest_gap < _NEAR * z0:
        # Do not step over the largest tension.
        length = min(length, _UNDER_TENSION * (z0 + law.length(state.contact.pair)))
    elif target < state.indentation and state.force > 0 and state.before is not None:
        length = min(length, _to_tension(state, length))
    if length >= _NEARLY * left:
        return target
    return state.indentation + math.copysign(min(length, 0.5 * left), target - state.indentation)


def _tolerance(state: CohesiveState, at: float, accuracy: float, residual: float) -> float:
    """Tolerance of a solve at the indentation `at` between the given depths.

    It falls with the accuracy of steps, or else errors of the forces would count as jumps; without
    pressure, an accepted `residual` is no reason to exceed _BETWEEN.
    """
    if state.force > 0:
        if at > state.indentation:
            return max(residual, _BETWEEN * min(1.0, accuracy / ACCURACY))
        return max(residual, _BACK * min(_LOOSEST, accuracy / USUAL))
    z0 = law_of(state.contact).equilibrium_separation
    if state.smallest_gap > _NEAR * z0:  # the forces of bodies far apart are small
        return min(residual, _BETWEEN)
    deformed = min(float(np.abs(state.box_displacement).max()) / z0, 1.0)
    return min(_BETWEEN, max(residual, _OF_STEP * deformed * abs(at - state.indentation) / z0))


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


def _to_tension(state: CohesiveState, length: float) -> float:
    """Distance (m) to where the force is expected to vanish, at least a quarter of `length`."""
    assert state.before is not None
    slope = (state.force - state.before.force) / (state.indentation - state.before.indentation)
    return max(state.force / slope, 0.25 * length) if slope > 0 else length


def _accounted(state: CohesiveState, step: TrialStep, smooth: bool) -> CohesiveState:
    lost = 0.0 if smooth else max(step.by_trapezium - step.change, 0.0)
    error = 0.0 if smooth else min(step.uncertainty, max(lost, abs(step.change)))
    unaccounted = state.unaccounted + (step.off if smooth else 0.0)
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


def _try(
    state: CohesiveState,
    at: float,
    residual: float,
    guide: Guide | CohesiveState | None,
    reach: float = math.inf,
) -> TrialStep:
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
    return TrialStep.of(state, new)


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
    previous = earlier_state(state, at)
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
