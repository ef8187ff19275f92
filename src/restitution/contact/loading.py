"""Load the undeformed bodies to one indentation, or move deformed bodies to another one.

The state of monotonic loading under a pressure bound does not depend on the path, so one solve from
the undeformed bodies is enough. (A contact with an attraction of finite range follows the path.)
"""

from __future__ import annotations

import math
from dataclasses import replace

from restitution.arguments import typed
from restitution.contact.checks.edge import require_inside_grid
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.interface import interface_of
from restitution.contact.state import State
from restitution.errors import CaseError


@typed
def solve(
    contact: Contact, indentation: float, *, start: State | None = None, residual: float = RESIDUAL
) -> State:
    """Load the undeformed bodies to `indentation` in one solve.

    Args:
        contact: Contact to load.
        indentation: Approach of the bodies (m), positive.
        start: Shallower state of the same contact, from which an integral of the loading work
            starts instead of first touch. With adhesion it is also the first guess.
        residual: Tolerance on the violation of the contact conditions (dimensionless), relative to
            the largest overlap of the undeformed surfaces or, with adhesion, to
            `Adhesion.residual_length`.

    Returns:
        State at `indentation`.

    Raises:
        CaseError: The indentation is not positive, or `start` is on another grid.
        NotConvergedError: The tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    if not 0 < indentation < math.inf:
        raise CaseError(f"indentation: {indentation} m is not a positive depth")
    if start is not None and start.contact.grid != contact.grid:
        raise CaseError("start: is on another grid; give a state on the grid of this contact")
    interface = interface_of(contact)
    state = interface.load(contact, indentation, start=start, residual=residual)
    state = with_work(state, start)
    require_inside_grid(state)
    return state


def with_work(state: State, start: State | None) -> State:
    """Add the loading work to a state from `Adhesion.load`.

    If the work has to be integrated, the integral begins at `start` or, if None, at first touch.
    """
    if start is not None and not (start.is_first_loading and start.indentation < state.indentation):
        start = None
    return interface_of(state.contact).with_work(state, start)


@typed
def step(state: State, indentation: float, *, residual: float = RESIDUAL) -> State:
    """Move a deformed contact to another indentation, deeper or shallower.

    Plastic displacement is permanent, and adhering nodes stay in contact until the detachment
    criterion releases them.

    Args:
        state: State to start from.
        indentation: New approach of the bodies (m).
        residual: Tolerance on the violation of the contact conditions (dimensionless), as in
            `solve`.

    Returns:
        State at `indentation`.

    Raises:
        CaseError: The indentation is not finite, or the contact is `Truncated` and would be loaded
            deeper.
        NotConvergedError: The tolerance was not reached.
        DomainError: The contact reaches the edge of the grid.
    """
    if not math.isfinite(indentation):
        raise CaseError(f"indentation: {indentation} m is not a finite depth")
    state.contact.plasticity.require_step(state, indentation)
    new = interface_of(state.contact).step(state, indentation, residual)
    require_inside_grid(new)
    return replace(new, is_first_loading=False)
