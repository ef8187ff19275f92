"""Follow a curve: load to one depth after the other, and unload. The only loop over depths."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from restitution.collision import Collision, UnloadingMethod, collide
from restitution.contact.contact import Contact
from restitution.contact.models import RESTITUTION_ERROR
from restitution.contact.path import unloading_path
from restitution.contact.state import State
from restitution.curve.point import Point
from restitution.errors import RestitutionError

Failed = Callable[[RestitutionError], bool]
"""Takes the error of a depth that is left out; returns whether the curve goes on."""


@dataclass(frozen=True, eq=False)
class Load:
    """One depth of a curve to be computed.

    `to` loads `contact`, from a state at a smaller depth on the same contact or None. `prescribed`
    is the prescribed value (m, N, m/s or Pa). `refine` and `touch` are those of `Point.of`. With
    `unload`, the unloading curve is computed even if the collision does not need it.
    """

    contact: Contact
    to: Callable[[State | None], State]
    prescribed: float
    refine: int = 1
    touch: float = 0.0
    unload: bool = False


@dataclass(frozen=True)
class Unloading:
    """How contacts are unloaded: method, steps without adhesion, and error of COR by the steps."""

    method: UnloadingMethod = "path"
    steps: int = 16
    tolerance: float = RESTITUTION_ERROR

    def of(
        self, state: State, known: Sequence[State], *, always: bool
    ) -> tuple[Collision, Sequence[State]]:
        """The collision whose deepest state is `state`, and its unloading curve."""
        followed = state.contact.adhesive and self.method == "path"
        path: Sequence[State] = ()
        if followed or always:
            path = list(
                unloading_path(state, steps=self.steps, tolerance=self.tolerance, known=known)
            )
        collision = collide(
            state, path if followed else None, method=self.method, tolerance=self.tolerance
        )
        return collision, path


@dataclass(frozen=True, eq=False)
class Impact:
    """The impact at one depth: deepest state, works, and the unloading curve if it was computed."""

    load: Load
    state: State
    collision: Collision
    unloading: Sequence[State]

    @cached_property
    def point(self) -> Point:
        return Point.of(self.state, self.collision, self.load.refine, self.load.touch)


def loaded(loads: Iterable[Load], failed: Failed | None = None) -> Iterator[tuple[Load, State]]:
    """Load to one depth after the other, each from the state before on the same contact."""
    contact: Contact | None = None
    state: State | None = None
    for load in loads:
        if load.contact != contact:
            contact, state = load.contact, None
        try:
            state = load.to(state)
        except RestitutionError as error:
            if failed is None:
                raise
            if failed(error):
                continue
            return
        yield load, state


def follow(
    loads: Iterable[Load], unloading: Unloading, failed: Failed | None = None
) -> Iterator[Impact]:
    """Compute the impact at each depth of a curve.

    Args:
        loads: The depths, in increasing order.
        unloading: How the contacts are unloaded. An adhesive contact reuses the unloading curve of
            the depth before.
        failed: Called with the error of a depth that is left out; returns whether the curve goes
            on. Without it, errors are raised.

    Raises:
        NotConvergedError: A tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    contact: Contact | None = None
    path: Sequence[State] = ()
    for load, state in loaded(loads, failed):
        if load.contact != contact:
            contact, path = load.contact, ()
        try:
            collision, path = unloading.of(state, path, always=load.unload)
        except RestitutionError as error:
            if failed is None:
                raise
            if failed(error):
                continue
            return
        yield Impact(load, state, collision, path)
