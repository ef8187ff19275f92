"""Work of adhesive loading, from the balances of a few contact areas or from the force.

The force of a loaded state scatters, because its contact edge moves by whole nodes. The force at
balances (see `area`) does not, so few depths suffice.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.jkr.area import balance_of, jkr_of
from restitution.contact.state import State
from restitution.numerics.quadrature import integrate_adaptively

# Number of intervals of the integral over depth. The initial number is _FROM_TOUCH if the integral
# begins at first touch, and _FROM_STATE if it begins at another state. The largest number is _MOST.
_FROM_TOUCH, _FROM_STATE, _MOST = 4, 2, 16
# The depths are proportional to t^_CROWDING with evenly spaced t. So they are closer together near
# first touch, where the curvature of the force is large.
_CROWDING = 1.5
# The error estimate is this factor times the change of the work when every second depth is left
# out. The factor is above 1 because the force of rough contacts jumps.
_MARGIN = 1.5
# Largest number of bisections of the quadrature of `work_by_force`.
_HALVINGS = 5

Point = tuple[float, float]  # indentation (m) and force (N)


def work_by_balance(
    state: State,
    start: State | None,
    load: Callable[[Contact, float, State | None], State],
    tolerance: float,
) -> tuple[float, float, int]:
    """Return the loading work (J), the error of its quadrature (J) and the number of convolutions.

    The force at the balances of a few depths is integrated from `start` (None: first touch). `load`
    solves the contact at a depth (m), from a shallower state or None. `tolerance` is relative.
    """
    contact, last = state.contact, state.indentation
    first, work, convolutions = 0.0, 0.0, 0
    if start is None:
        begin = load(contact, 0.0, None)  # right after the jump into contact
        convolutions += begin.convolutions
    else:
        begin, first, work = start, start.indentation, start.loading_work
    points = {0.0: balance_of(begin), 1.0: balance_of(state)}
    parts = 1
    value = _integral([points[0.0], points[1.0]], first, last)
    scale = abs(work) + 0.5 * (abs(begin.force) + abs(state.force)) * (last - first)
    # `value` is the work of a force that is linear in the indentation. The actual force increases
    # with the indentation, so the actual work differs from `value` by at most this error.
    error = 0.5 * abs(points[1.0][1] - points[0.0][1]) * (last - first)
    while error > tolerance * scale and parts < _MOST:
        parts = max(2 * parts, _FROM_TOUCH if start is None else _FROM_STATE)
        loaded = begin
        for k in range(1, parts):
            t = k / parts
            if t not in points:
                loaded = load(contact, first + (last - first) * t**_CROWDING, loaded)
                convolutions += loaded.convolutions
                points[t] = balance_of(loaded)
        ordered = [points[t] for t in sorted(points)]
        value = _integral(ordered, first, last)
        error = _MARGIN * abs(value - _integral(ordered[::2], first, last))
    return work + value, error, convolutions


def work_by_force(
    state: State,
    start: State | None,
    load: Callable[[Contact, float, State | None], State],
    tolerance: float,
) -> tuple[float, float, int]:
    """Integrate the force of loaded states, adaptively in the indentation.

    Arguments and results are those of `work_by_balance`, but the error includes `pinning_error`.
    """
    contact, indentation = state.contact, state.indentation
    guess, convolutions = start, 0

    def force_at(depth: float) -> float:
        nonlocal guess, convolutions
        guess = load(contact, depth, guess)
        convolutions += guess.convolutions
        return guess.force

    first, first_force, work, error = 0.0, 0.0, 0.0, 0.0
    if start is not None:
        first, first_force = start.indentation, start.force
        work, error = start.loading_work, start.work_error - pinning_error(start)
    elif jkr_of(contact).approach.in_equilibrium:
        first_force = force_at(0.0)  # the force right after the jump into contact
    scale = abs(work) + 0.5 * (abs(first_force) + abs(state.force)) * (indentation - first)
    increment, increment_error = integrate_adaptively(
        force_at, first, indentation, first_force, state.force, tolerance * scale, depth=_HALVINGS
    )
    return work + increment, error + increment_error + pinning_error(state), convolutions


def pinning_error(state: State) -> float:
    model = jkr_of(state.contact)
    return model.approach.pinning * model.work_of_adhesion * state.contact_area


def _integral(points: list[Point], first: float, last: float) -> float:
    from scipy.interpolate import CubicSpline

    x, F = np.array(points).T
    # Keep only points whose indentation is larger than the indentation of every earlier point.
    kept = np.append(True, x[1:] > np.maximum.accumulate(x)[:-1])
    x, F = x[kept], F[kept]
    if x.size == 1:
        return float(F[0]) * (last - first)
    slopes = np.diff(F) / np.diff(x)
    before, after = x[0] - first, last - x[-1]
    ends = F[0] * before - 0.5 * slopes[0] * before**2
    ends += F[-1] * after + 0.5 * slopes[-1] * after**2
    return float(CubicSpline(x, F).integrate(x[0], x[-1])) + float(ends)
