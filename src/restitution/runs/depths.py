"""The depths of a case, one after the other: load to each depth, and unload where needed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from restitution.case.case import Case
from restitution.case.derived import deepest_indentation
from restitution.collision import Collision, collide
from restitution.contact.checks.edge import needed_edges
from restitution.contact.contact import Contact
from restitution.contact.loading import solve
from restitution.contact.path import unloading_path
from restitution.contact.prescribed.force import solve_at_force
from restitution.contact.prescribed.pressure import solve_at_pressure
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.errors import DomainError, NotConvergedError
from restitution.runs.messages import naming_keys


@dataclass(frozen=True)
class Depth:
    """One depth of a case, after loading.

    `asked` is the prescribed value (m, N or m/s), and `refine` the refinement factor of the grid on
    which the depth is solved. `touch` (m) is the approach at which the bodies first touch on this
    grid minus the approach at which they first touch on the finest grid. `state` is None if loading
    failed with `error`.
    """

    asked: float
    refine: int
    touch: float
    state: State | None = None
    error: NotConvergedError | DomainError | None = None


def later_touches(case: Case, folder: Path, factors: Iterable[int]) -> dict[int, float]:
    """Approach (m) at first touch on each grid minus that on the finest of these grids.

    A coarse grid touches later because the highest point of the surface lies between its nodes.
    """
    R, touch = case.pair().radius, {}
    for factor in factors:
        surface = case.refined(factor).surface(folder)
        x, y = surface.grid.x[:, None], surface.grid.y[None, :]
        touch[factor] = float(((x * x + y * y) / (2 * R) - surface.height).min())
    return {factor: touch[factor] - touch[max(touch)] for factor in touch}


def load_to(case: Case, contact: Contact, depth: float, start: State | None = None) -> State:
    """Load `contact` to `depth`, one of `case.depths()`.

    Depending on the case, `depth` is an indentation (m), a force (N), an impact velocity (m/s) or a
    nominal pressure (Pa). `start` is the state at a shallower depth. It saves time, but it is not
    used if a pressure is prescribed. Raises the errors of `solve`, `solve_at_force`,
    `solve_at_velocity` or `solve_at_pressure`.
    """
    with naming_keys(case.prescribed, lambda: needed_edges(contact, deepest_indentation(case))):
        if case.pressure is not None:
            return solve_at_pressure(contact, depth)
        if case.load is not None:
            return solve_at_force(contact, depth, start=start)
        if case.impact is not None:
            return solve_at_velocity(contact, depth, start=start)
        return solve(contact, depth, start=start)


def loaded_depths(case: Case, folder: Path, contact: Contact) -> Iterator[Depth]:
    """Load to every depth of `case`, from the shallowest to the deepest.

    `contact` is the contact on the grid of the deepest depth. File names in the case are relative
    to `folder`. Each load starts from the previous state on the same grid.
    """
    factors = case.factors()
    # A coarse grid first touches at a larger approach than the finest grid. The extra approach is
    # added to all stored indentations, even if loads or velocities are prescribed.
    touches = later_touches(case, folder, set(factors)) if len(set(factors)) > 1 else {}
    for factor in sorted(set(factors), reverse=True):
        last = factor == factors[-1]
        level = contact if last else case.refined(factor).contact(folder)
        touch, state = touches.get(factor, 0.0), None
        for asked in [d for d, its in zip(case.depths(), factors, strict=True) if its == factor]:
            try:
                state = load_to(case, level, asked - touch if case.indentation else asked, state)
            except (NotConvergedError, DomainError) as error:
                yield Depth(asked, factor, touch, error=error)
            else:
                yield Depth(asked, factor, touch, state)


def collision_at(
    case: Case, state: State, *, unload: bool = False, known: Sequence[State] = ()
) -> tuple[Collision, Sequence[State]]:
    """Return the collision whose deepest state is `state`, and its unloading curve.

    The curve is computed if `unload` is true or if the collision needs it; otherwise it is empty.
    `known` is the unloading curve of a shallower depth, which `unloading_path` may reuse.
    """
    followed = state.contact.adhesive and case.unloading.method == "path"
    back: list[State] = []
    if followed or unload:
        with naming_keys():
            back = list(
                unloading_path(
                    state,
                    steps=case.unloading.steps,
                    tolerance=case.unloading.restitution_error,
                    known=known,
                )
            )
    return collide(state, back if followed else None, method=case.unloading.method), back
