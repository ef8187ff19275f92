"""Follow a branch of equilibria of a cohesive contact step by step, with the dissipated energy.

In a step without instability the work of the force equals the change of the potential energy plus
the plastic work. Where the solve descends to another equilibrium, the excess of the work is the
energy dissipated by adhesion. Its uncertainty is half the jump of the force times the step.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.cohesive.equilibrium import (
    CohesiveState,
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
_FIRST_STEP = 0.25  # length of the first step, in units of the equilibrium separation z₀

# Longest step under tension, as a fraction of the sum of z₀ and the adhesive length, while the gap
# is below _NEAR z₀. Under tension, the error of a step is this share of that of others.
# At least, it is the share _SLIGHT of that where unloading began.
_UNDER_TENSION, _NEAR, _TENSE, _SLIGHT = 0.4, 2.0, 0.4, 0.02
# Largest relative error of the largest tension where it ends in a jump, but no step is made shorter
# than _AT_FOLD z₀ for it.
_AT_JUMP, _AT_FOLD = 3e-3, 0.01
_GROWTH = 3.0  # largest ratio of the lengths of two steps
_NEARLY = 0.8  # a step of this share of the way that is left goes all the way
# Shortest step, in units of z₀. If even this step fails, the path cannot be followed, and an error
# is raised.
_LEAST_STEP = 1e-5
_MOST_STEPS = 5000

# When the box (the part of the grid that is solved) must grow, it is made large enough for about
# this multiple of the next indentation. So it seldom grows.
_WIDER = 1.5
# In unloading it shrinks where this share of its nodes suffices.
_NARROWER = 0.4


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
    law, pair = law_of(state.contact), state.contact.pair
    z0 = law.equilibrium_separation
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
    require_inside_grid(state)
    for _ in range(_MOST_STEPS):
        target = target if goal is None else goal(state)
        left = abs(target - state.indentation)
        if left == 0:
            return
        if state.force < 0 and state.smallest_gap < _NEAR * z0:
            # Do not step over the largest tension.
            length = min(length, _UNDER_TENSION * (z0 + law.length(pair)))
        elif sign < 0 and state.force > 0 and state.before is not None:
            length = min(length, _to_tension(state, length))
        last = length >= _NEARLY * left
        at = target if last else state.indentation + sign * min(length, 0.5 * left)
        if guide is not None and not last:
            at = guide.stop(state.indentation, at)
        length = abs(at - state.indentation)
        state_on = _on_fitting_box(state, at, target, residual)
        if state_on is not state:
            rejected += state_on.convolutions
            state = state_on
        try:
            fine = last or state.force <= 0  # the forces of bodies far apart are small
            loose = _BETWEEN if sign > 0 else _BACK
            step = _try(state, at, residual if fine else max(residual, loose), guide)
        except NotConvergedError:
            if length <= 8 * _LEAST_STEP * z0:
                raise
            length /= 4
            continue
        new = step.state
        here = reference_energy(new, loading=sign > 0)
        if new.force > 0 and state.force > 0:
            ahead = _work_ahead(state, new, target) if sign > 0 else 0.0
            allowed = accuracy * max(scale, here + ahead)
        else:
            allowed = accuracy * max(_TENSE * here, _SLIGHT * scale)
        off = step.by_quartic - step.change
        correction = abs(step.by_quartic - step.by_trapezium)
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


def _try(state: CohesiveState, at: float, residual: float, guide: Guide | None) -> _Step:
    contact, box = state.contact, state.box
    limit, convolutions = contact.plasticity.bound_after(state, at, residual)
    previous = _earlier(state, at)
    p = state.box_pressure
    u: Array | None = state.box_displacement
    change = None if guide is None else guide.change(state.indentation, at, box)
    if change is not None:
        p, u = p + change, None
    elif previous is not None:
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
    quartic = trapezium if previous is None else _quartic(previous, state, new)
    return _Step(
        new,
        trapezium,
        quartic,
        new.potential_energy - state.potential_energy + plastic,
        0.5 * abs(force - before) * abs(way),
    )


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
