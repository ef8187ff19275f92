"""Unloading an adhesive contact until it has separated, in steps that fit the error asked for.

At each step the bodies move back with the contact held, which is linear, and then nodes let go at
the new indentation. Letting go late costs work: the steps' exact (sawtooth) work is below that of a
continuous withdrawal by half of what the force jumps at the end of each.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.contact.adhesion import unload_adhesive
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.state import State
from restitution.errors import NotConvergedError
from restitution.numerics.quadrature import integrate_curve
from restitution.theory import Kendall

RESTITUTION_ERROR = 0.002
_ACCURACY = 1e-3  # of the solves on the way, in parts of the opening at the edge
_STEPS_OF_RECOVERY = 8  # at least so many steps over the elastic recovery
_STEPS_OF_TENSION = 16  # and so many over the stretch a punch of this area bears in tension
_FINEST = 400
_FINER = (1, 2, 4)  # times as many steps, as long as the error is above what was asked
_MOST_STEPS = 3000
# The trapezium through the settled states removes the work of letting go late, to first order. Of
# that work, what steps ten times finer still moved was below a tenth with crack closure and below
# a third with the tension limit, whose contacts let go in larger jumps; half more is reported.
_LATENESS = {"crack-closure": 0.15, "pohrt-popov": 0.5}


@dataclass(frozen=True)
class Separation:
    """What unloading to separation returned: work, its error, pull-off and where it ended."""

    unloading_work: float
    error: float
    adhesive_loss: float
    pull_off_force: float
    separation_indentation: float
    convolutions: int
    steps: int


def separate(state: State, *, tolerance: float = RESTITUTION_ERROR) -> Iterator[State]:
    """Yield `state` and the states on the way to separation, the last one without contact.

    A `state` without contact is all of it.

    `tolerance` is the error of the coefficient of restitution that the steps may cause; where their
    own estimate is above it, the way back is gone again in finer steps, at last four times as many.
    Raises `NotConvergedError` when the bodies do not come apart.
    """
    for finer in _FINER:
        path = list(_way_back(state, tolerance / finer, finer))
        separation = separation_of(path)
        returned, given = separation.unloading_work, state.loading_work
        # e = sqrt(W_u/W_l) makes 2 de/e = dW_u/W_u + dW_l/W_l. A pair that sticks has no e. The
        # error of the loading work, which finer steps do not reduce, takes half of it at most.
        if returned <= 0 or given <= 0:
            break
        half = 0.5 * math.sqrt(returned / given)
        loading = min(half * state.work_error / given, 0.5 * tolerance)
        if half * separation.error / returned + loading <= tolerance:
            break
    yield from path


def _way_back(state: State, tolerance: float, finer: int) -> Iterator[State]:
    """`state` and the states to separation, by at least `finer` times as many steps as usual."""
    contact = state.contact
    yield state
    if state.contact_nodes == 0:
        return  # `approach = "pull-increments"` has let go of everything already
    recovery, allowed = _plan(state, tolerance)
    step = recovery / (finer * _STEPS_OF_RECOVERY)
    previous: State | None = None
    for _ in range(_MOST_STEPS):
        reach = _tension_reach(state)
        longest = recovery / (finer * _STEPS_OF_RECOVERY)
        shortened = reach / (finer * _STEPS_OF_TENSION)
        if state.force < 0.1 * abs(_punch_force(state)):
            longest = min(longest, shortened)
        elif previous is not None:
            # Not past the force's zero, where the tension asks for shorter steps: the slope of a
            # Hertz-like recovery leads to two thirds of the way there.
            slope = (previous.force - state.force) / (previous.indentation - state.indentation)
            if slope > 0:
                longest = min(longest, max(1.3 * state.force / slope, shortened))
        step = min(step, longest)
        length = contact.residual_length(state.indentation - step)
        accuracy = _ACCURACY * contact.crack_opening / length
        new = unload_adhesive(
            state,
            state.indentation - step,
            first_guess=_predict(previous, state, step),
            residual=accuracy,
        )
        late = _late_force(new)
        if new.contact_nodes == 0:
            # The last stretch: approach the break until the step is a small part of it.
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
        step *= min(2.0, max(0.5, 0.8 * allowed / late if late > 0 else 2.0))
    raise NotConvergedError(
        f"the bodies have not separated after {_MOST_STEPS} steps of unloading (indentation "
        f"{1e9 * state.indentation:.4g} nm, force {state.force:.3g} N); check work_of_adhesion, "
        f"{contact.work_of_adhesion:g} J/m2, or ask for a larger restitution error"
    )


def separation_of(path: list[State]) -> Separation:
    """The energies of a path that `separate` has yielded."""
    depth = np.array([state.indentation for state in path])
    force = np.array([state.force for state in path])
    start, end = path[0], path[-1]
    work = -integrate_curve(depth, force)
    trapezoid = -float(np.trapezoid(force, depth))
    # What half of the steps would have made of it: four times the error, and more.
    fewer = np.append(np.arange(0, len(path) - 1, 2), len(path) - 1)
    halved = -integrate_curve(depth[fewer], force[fewer])
    late = -float(np.dot([_late_force(state) for state in path[1:]], np.diff(depth)))
    # The energy that the states have lost must be the work of their steps, pulled and let go.
    unaccounted = (start.loading_work - end.loading_work) - (trapezoid - late)
    return Separation(
        unloading_work=work,
        error=abs(work - halved)
        + _LATENESS[start.contact.detachment] * abs(late)
        + abs(unaccounted),
        adhesive_loss=start.adhesive_work - end.adhesive_work - late,
        pull_off_force=max(0.0, -float(force.min())),
        separation_indentation=end.indentation,
        convolutions=sum(state.convolutions for state in path[1:]),
        steps=len(path) - 1,
    )


def _late_force(state: State) -> float:
    """Half of what the force jumped when nodes let go at the end of a step, N."""
    assert state.force_before_release is not None  # set by every `unload_adhesive`
    return 0.5 * (state.force - state.force_before_release)


def _plan(state: State, tolerance: float) -> tuple[float, float]:
    """Length of the elastic recovery (m), and the loss of force per step (N) the error allows."""
    stored, adhesion = state.stored_energy, state.contact.work_of_adhesion * state.contact_area
    # Elastic recovery of a Hertz-like contact, from its force, and of a punch of its area.
    a = math.sqrt(state.contact_area / math.pi)
    recovery = 1.5 * math.sqrt(stored / (state.contact.pair.contact_modulus * a))
    if state.force > 0:
        recovery = min(recovery, 2.2 * stored / state.force)
    recovery = max(recovery, _tension_reach(state))
    # Of pairs that stick or nearly do, COR below 0.05 is not worth ever finer steps.
    work = max(state.loading_work, 0.05 * stored)
    restitution = math.sqrt(max(stored - adhesion, 0.0) / work)
    # dCOR = dW/(2 W_l COR); half is left to the error of the loading work.
    allowed = 1.0 * tolerance * max(restitution, 0.05) * work
    return recovery, allowed / (_LATENESS[state.contact.detachment] * recovery)


def _tension_reach(state: State) -> float:
    """Displacement (m) at which a punch of the same area breaks off (Kendall 1971)."""
    punch, a = _punch(state)
    return float(punch.pull_off_displacement(a))


def _punch_force(state: State) -> float:
    """Pull-off force (N) of a punch of the same area (Kendall 1971)."""
    punch, a = _punch(state)
    return float(punch.pull_off_force(a))


def _punch(state: State) -> tuple[Kendall, float]:
    """Punches of these bodies, and the radius (m) of the one that has the area of the contact."""
    contact = state.contact
    punch = Kendall(contact.pair.contact_modulus, contact.work_of_adhesion)
    return punch, math.sqrt(state.contact_area / math.pi)


def _predict(previous: State | None, state: State, step: float) -> NDArray[np.float64] | None:
    """Linear continuation of the pressure, on the nodes that are still in contact.

    Not for speed: a step is solved loosely, and ends nearer to the solution from a guess that is.
    """
    if previous is None:
        return None
    slope = step / (previous.indentation - state.indentation)
    before, now = previous.pressure_on(state.box), state.box_pressure
    return np.where(now != 0, now + slope * (now - before), 0.0)
