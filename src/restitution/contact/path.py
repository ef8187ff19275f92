"""Loading and unloading paths: generators that yield states one by one and can be stopped."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from restitution.arguments import typed
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.interface import interface_of
from restitution.contact.loading import solve
from restitution.contact.models import RESTITUTION_ERROR
from restitution.contact.prescribed.force import solve_at_force
from restitution.contact.prescribed.velocity import solve_at_velocity
from restitution.contact.state import State
from restitution.errors import CaseError


@typed
def loading_path(
    contact: Contact,
    indentations: Iterable[float] | None = None,
    *,
    forces: Iterable[float] | None = None,
    velocities: Iterable[float] | None = None,
    residual: float = RESIDUAL,
) -> Iterator[State]:
    """Load the undeformed bodies to each of several indentations, forces or impact velocities.

    Give exactly one of `indentations`, `forces` and `velocities`. If the loading work has to be
    integrated numerically, each integral starts from the previous state.

    Args:
        contact: Contact to load.
        indentations: Approaches of the bodies (m).
        forces: Normal forces (N).
        velocities: Impact velocities (m/s).
        residual: Tolerance on the violation of the contact conditions (dimensionless), as in
            `solve`; used only for `indentations`.

    Yields:
        State at each given value, in the given order.

    Raises:
        CaseError: Not exactly one of the three sequences is given, a value is not positive, or
            velocities are given for bodies without density.
        NotConvergedError: A tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    ways = (
        (indentations, partial(solve, residual=residual)),
        (forces, solve_at_force),
        (velocities, solve_at_velocity),
    )
    given = [(values, load) for values, load in ways if values is not None]
    if len(given) != 1:
        raise CaseError("a loading path takes exactly one of indentations, forces and velocities")
    ((values, load),) = given
    state: State | None = None
    for value in values:
        state = load(contact, value, start=state)
        yield state


@typed
def unloading_path(
    state: State,
    *,
    steps: int = 16,
    tolerance: float = RESTITUTION_ERROR,
    residual: float = RESIDUAL,
    known: Sequence[State] = (),
) -> Iterator[State]:
    """Unload a contact step by step to separation.

    Without adhesion, the bodies separate at the indentation δ_s where the force returns to zero.
    After step k of n, the distance δ − δ_s to separation is (1 − k/n)² times its initial value. In
    a Hertzian unloading, the force is proportional to (δ − δ_s)^1.5 and thus a cubic function of k.

    Args:
        state: State to unload.
        steps: Number of steps of a contact without adhesion.
        tolerance: Error of the coefficient of restitution (dimensionless) that the steps may cause.
            It determines the number of steps with adhesion.
        residual: Tolerance on the violation of the contact conditions (dimensionless), as in
            `solve`; used only without adhesion.
        known: States of another unloading of the same contact, which began at a smaller
            indentation. With adhesion they save time. An elastic contact that unloads from a larger
            indentation passes through the same states, so they are not solved again.

    Yields:
        `state`, then the state after each step.

    Raises:
        NotConvergedError: A tolerance was not reached, or adhesive bodies did not separate.
        DomainError: The contact reaches the edge of the grid.
    """
    yield from interface_of(state.contact).unload(
        state, steps=steps, tolerance=tolerance, residual=residual, known=known
    )
