"""The depths of a case, one after the other: load to each depth, and unload where needed."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from restitution.case.case import Case
from restitution.collision import Collision, collide
from restitution.contact.contact import Contact
from restitution.contact.path import unloading_path
from restitution.contact.state import State
from restitution.errors import DomainError, NotConvergedError
from restitution.runs.loading import load_to
from restitution.runs.messages import naming_keys
from restitution.runs.refinement import later_touches


@dataclass(frozen=True)
class Depth:
    """One depth of a case, after loading.

    `asked` is the prescribed value (m, N or m/s), and `refine` the refinement factor of the grid on
    which the depth is solved. `touch` (m) is the approach to first touch on this grid minus that on
    the finest grid. `state` is None if loading failed with `error`.
    """

    asked: float
    refine: int
    touch: float
    state: State | None = None
    error: NotConvergedError | DomainError | None = None


@dataclass(frozen=True)
class _Level:
    """The contact on one grid, and the depths that are computed on it."""

    contact: Contact
    refine: int
    depths: list[float]
    touch: float

    def load(self, case: Case, depth: float, start: State | None) -> Depth:
        own = depth - self.touch if case.indentation else depth
        try:
            state = load_to(case, self.contact, own, start)
        except (NotConvergedError, DomainError) as error:
            return Depth(depth, self.refine, self.touch, error=error)
        return Depth(depth, self.refine, self.touch, state)


def loaded_depths(case: Case, folder: Path, contact: Contact) -> Iterator[Depth]:
    """Load to every depth of `case`, from the shallowest to the deepest.

    `contact` is the contact on the grid of the deepest depth, and files are relative to `folder`.
    Each load starts from the previous state on the same grid.
    """
    for level in _levels(case, folder, contact):
        before: State | None = None
        for depth in level.depths:
            loaded = level.load(case, depth, before)
            before = loaded.state or before
            yield loaded


def collision_at(
    case: Case, state: State, *, unload: bool = False, known: Sequence[State] = ()
) -> tuple[Collision, Sequence[State]]:
    """Return the collision with the maximum indentation of `state`, and its unloading curve.

    The curve is computed if `unload` is true or if the collision needs it; otherwise it is empty.
    `known` is the unloading curve of a shallower depth, which `unloading_path` may reuse.
    """
    followed = state.contact.adhesive and case.unloading.method == "path"
    back: list[State] = []
    if followed or unload:
        steps, tolerance = case.unloading.steps, case.unloading.restitution_error
        with naming_keys():
            back = list(unloading_path(state, steps=steps, tolerance=tolerance, known=known))
    return collide(state, back if followed else None, method=case.unloading.method), back


def _levels(case: Case, folder: Path, deepest: Contact) -> Iterator[_Level]:
    """Yield the grids of a case with their depths, from the shallowest depths to the deepest."""
    factors, depths = case.factors(), case.depths()
    # On a coarse grid, first touch is at a larger approach. The difference is added to the stored
    # indentations, so it is also needed if loads or velocities are prescribed.
    touches = later_touches(case, folder, set(factors)) if len(set(factors)) > 1 else {}
    for factor in sorted(set(factors), reverse=True):
        own = [depth for depth, its in zip(depths, factors, strict=True) if its == factor]
        last = factor == factors[-1]
        contact = deepest if last else case.refined(factor).contact(folder)
        yield _Level(contact, factor, own, touches.get(factor, 0.0))
