"""The interface of a contact: its adhesion, or surfaces that do not attract each other."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from restitution.contact.bodies import Pair
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import solve_nonadhesive
from restitution.contact.models import WORK_RESIDUAL, Adhesion, Separation
from restitution.contact.state import Array, State


@dataclass(frozen=True)
class NoAttraction(Adhesion):
    """Surfaces that only repel each other."""

    label = "none"
    attracts = False
    work_of_adhesion = 0.0

    def describe(self, unloading: str) -> dict[str, str]:
        return {"adhesion": self.label}

    def length(self, pair: Pair) -> float:
        return 0.0

    def load(
        self, contact: Contact, indentation: float, *, start: State | None, residual: float
    ) -> State:
        def solve(limit: Array | float) -> State:
            return solve_nonadhesive(contact, indentation, limit, residual)

        return load_under_bound(contact, indentation, residual, solve)

    def with_work(self, state: State, start: State | None) -> State:
        return state.contact.plasticity.with_loading_work(state, start, self.intermediate)

    def integrates_work(self, contact: Contact) -> bool:
        return not contact.plasticity.exact_work

    def intermediate(self, contact: Contact, depth: float, start: State | None) -> State:
        """Solve at a depth (m) of an integral."""
        return self.load(contact, depth, start=start, residual=WORK_RESIDUAL)

    def step(self, state: State, indentation: float, residual: float) -> State:
        model = state.contact.plasticity
        limit, convolutions = model.bound_after(state, indentation, residual)
        new = solve_nonadhesive(state.contact, indentation, limit, residual, history=state)
        if model.grows:
            work = state.plastic_work + model.work(state, new)[0]
            new = replace(new, plastic_work=work, convolutions=new.convolutions + convolutions)
        return new

    def unload(
        self, state: State, *, steps: int, tolerance: float, residual: float, known: Sequence[State]
    ) -> Iterator[State]:
        deepest, last = state.indentation, state.separation_indentation
        yield state
        for t in np.arange(1, steps + 1) / steps:
            new = self.step(state, float(last + (deepest - last) * (1 - t) ** 2), residual)
            require_inside_grid(new)
            state = replace(new, is_first_loading=False)
            yield state

    def separation_of(self, path: list[State]) -> Separation:
        start, convolutions = path[0], sum(state.convolutions for state in path[1:])
        at, steps = start.separation_indentation, len(path) - 1
        return Separation(start.stored_energy, 0.0, 0.0, 0.0, at, convolutions, steps)

    def needed_spacing(self, state: State) -> float:
        return math.inf


_NO_ATTRACTION = NoAttraction()


def interface_of(contact: Contact) -> Adhesion:
    """Return the adhesion of `contact`, or an interface without attraction."""
    return contact.adhesion or _NO_ATTRACTION


def load_under_bound(
    contact: Contact,
    indentation: float,
    residual: float,
    solve: Callable[[Array | float], State],
) -> State:
    """Load the undeformed bodies by `solve`, which takes the bound of the pressure (Pa)."""
    limit, convolutions = contact.plasticity.bound(contact, indentation, residual)
    state = contact.plasticity.finish(solve(limit))
    return replace(state, convolutions=state.convolutions + convolutions)
