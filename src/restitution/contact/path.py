"""Paths: states one after another, as generators that can be streamed, shown and stopped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.loading import solve, step
from restitution.contact.prescribed_force import solve_at_force
from restitution.contact.prescribed_velocity import solve_at_velocity
from restitution.contact.separation import RESTITUTION_ERROR, separate
from restitution.contact.state import State
from restitution.errors import CaseError


def loading_path(
    contact: Contact,
    indentations: Iterable[float] | None = None,
    *,
    forces: Iterable[float] | None = None,
    velocities: Iterable[float] | None = None,
    residual: float = RESIDUAL,
) -> Iterator[State]:
    """Yield the state at each of `indentations` (m), `forces` (N) or impact `velocities` (m/s).

    They come in the order given. Work that has to be integrated is integrated from each state to
    the next. Raises as `solve`, `solve_at_force` and `solve_at_velocity`, and `CaseError` unless
    exactly one of the three is given.
    """
    if sum(given is not None for given in (indentations, forces, velocities)) != 1:
        raise CaseError("a loading path takes one of indentations, forces and velocities")
    state: State | None = None
    for depth in () if indentations is None else indentations:
        state = solve(contact, depth, start=state, residual=residual)
        yield state
    for force in () if forces is None else forces:
        state = solve_at_force(contact, force, start=state)
        yield state
    for velocity in () if velocities is None else velocities:
        state = solve_at_velocity(contact, velocity, start=state)
        yield state


def unloading_path(
    state: State,
    *,
    steps: int = 16,
    tolerance: float = RESTITUTION_ERROR,
    residual: float = RESIDUAL,
) -> Iterator[State]:
    """Yield `state` and more on the way back to separation, where the force is zero.

    With adhesion the steps are as many as an error of restitution of `tolerance` takes, see
    `separate`. Without, where the restitution is known from the energies, there are `steps`.
    The steps crowd towards separation as (1 − t)², which makes the force of a Hertz-like unloading,
    (δ − δ_s)^1.5, a cubic in t. Raises as `solve`.
    """
    if state.contact.adhesive:
        yield from separate(state, tolerance=tolerance)
        return
    deepest, last = state.indentation, state.separation_indentation
    yield state
    for t in np.arange(1, steps + 1) / steps:
        state = step(state, float(last + (deepest - last) * (1 - t) ** 2), residual=residual)
        yield state
