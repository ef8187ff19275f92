"""The loads of a case, and how its contacts are unloaded, for `curve.follow`."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial
from pathlib import Path

from restitution.case.case import Case
from restitution.case.derived import deepest_indentation
from restitution.collision import Collision
from restitution.contact.checks.edge import needed_edges
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.prescribed.force import solve_at_force
from restitution.contact.prescribed.pressure import solve_at_pressure
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.curve.follow import Load, Unloading
from restitution.runs.messages import naming_keys
from restitution.surfaces import Surface


def later_touches(case: Case, folder: Path, factors: Iterable[int]) -> dict[int, float]:
    """Approach (m) at first touch on each grid minus that on the finest of these grids.

    A coarse grid touches later because the highest point of the surface lies between its nodes.
    """
    R = case.pair().radius
    touch = {factor: first_touch(case.refined(factor).surface(folder), R) for factor in factors}
    return {factor: touch[factor] - touch[max(touch)] for factor in touch}


def first_touch(surface: Surface, radius: float) -> float:
    """Approach (m) at which a sphere of the reduced `radius` (m) touches the rough `surface`."""
    x, y = surface.grid.x[:, None], surface.grid.y[None, :]
    return float(((x * x + y * y) / (2 * radius) - surface.height).min())


def load_to(case: Case, contact: Contact, depth: float, start: State | None = None) -> State:
    """Load `contact` to `depth`, one of `case.depths()`: m, N, m/s or Pa.

    `start` is the state at a shallower depth; it is not used if a pressure is prescribed. Errors
    name the keys of the case file.
    """
    with naming_keys(case.prescribed, lambda: needed_edges(contact, deepest_indentation(case))):
        if case.pressure is not None:
            return solve_at_pressure(contact, depth)
        if case.load is not None:
            return solve_at_force(contact, depth, start=start)
        if case.impact is not None:
            return solve_at_velocity(contact, depth, start=start)
        return solve(contact, depth, start=start)


def loads_of(
    case: Case, folder: Path, contact: Contact, *, unloaded: int | None = None
) -> Iterator[Load]:
    """The loads to every depth of `case`, from the shallowest to the deepest.

    `contact` is the contact on the grid of the deepest depth. `unloaded` is the number of unloading
    curves, by default that of the case, at evenly spaced depths including the deepest.
    """
    factors, depths = case.factors(), case.depths()
    # A coarse grid first touches at a larger approach than the finest grid. The extra approach is
    # added to all stored indentations, even if loads or velocities are prescribed.
    touches = later_touches(case, folder, set(factors)) if len(set(factors)) > 1 else {}
    curves = case.unloading.curves if unloaded is None else unloaded
    back = {len(depths) - 1 - (k * len(depths)) // curves for k in range(curves)}
    level, on = contact, factors[-1]
    for number, (depth, factor) in enumerate(zip(depths, factors, strict=True)):
        if factor != on:
            on = factor
            level = contact if factor == factors[-1] else case.refined(factor).contact(folder)
        touch = touches.get(factor, 0.0)
        to = partial(load_to, case, level, depth - touch if case.indentation else depth)
        yield Load(level, to, depth, factor, touch, unload=number in back)


class CaseUnloading(Unloading):
    """Unloading as a case prescribes it; errors name the keys of the case file."""

    @classmethod
    def of_case(cls, case: Case) -> CaseUnloading:
        table = case.unloading
        return cls(table.method, table.steps, table.restitution_error)

    def of(
        self, state: State, known: Sequence[State], *, always: bool
    ) -> tuple[Collision, Sequence[State]]:
        with naming_keys():
            return super().of(state, known, always=always)
