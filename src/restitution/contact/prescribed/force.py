"""Contact under a prescribed force: search for the indentation at which the force is reached."""

from __future__ import annotations

import math
from dataclasses import replace

from restitution.arguments import typed
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import RESIDUAL
from restitution.contact.interface import interface_of
from restitution.contact.loading import solve
from restitution.contact.prescribed.pressure import solve_at_pressure
from restitution.contact.state import State
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.theory import Hertz

FORCE_TOLERANCE = 1e-8
_SIZED_TOLERANCE = 1e-4  # with a size effect, whose bound is as accurate as its elastic pressure
_SOLVE_RESIDUAL = 1e-10  # keeps the error of a solve well below the force tolerance


@typed
def solve_at_force(contact: Contact, force: float, *, start: State | None = None) -> State:
    """Load the undeformed bodies to `force`, within a relative error of 1e-8.

    With a size effect it is 1e-4 where the bound jumps.

    A periodic contact is solved by `solve_at_pressure`, under the force divided by the area of the
    grid.

    Args:
        contact: Contact to load.
        force: Normal force (N), positive.
        start: State of the same contact under a smaller force, used as in `solve`.

    Returns:
        State under `force`.

    Raises:
        CaseError: The force is not positive.
        DomainError: The contact cannot carry the force, even with the yield pressure at all nodes
            of the grid, or the contact reaches the edge of the grid.
        NotConvergedError: The force jumps from below to above `force`, or a solve did not converge.
    """
    from scipy.optimize import brentq

    if not 0 < force < math.inf:
        raise CaseError(f"force: {force} N is not positive")
    nx, ny = contact.grid.nodes
    if contact.periodic:
        return solve_at_pressure(contact, force / (contact.grid.cell_area * nx * ny))
    capacity = contact.hardness * contact.grid.cell_area * nx * ny
    if force >= capacity and not contact.plasticity.size_effect:
        raise DomainError(
            f"{force:.4g} N is more than the whole grid carries at the yield pressure "
            f"({capacity:.4g} N); use a larger grid or a smaller force",
            argument="force",
        )
    interface = interface_of(contact)
    hertz = float(Hertz(contact.pair.radius, contact.pair.contact_modulus).indentation(force))
    low, high = 0.0, max(hertz, start.indentation if start is not None else 0.0)

    def ahead(state: State, stiffness: float) -> float:
        return (force - state.force) / stiffness if stiffness > 0 else math.inf

    path = interface.enclose(
        contact,
        lambda state: state.force >= force,
        ahead,
        start=start,
        scale=0.0,
        residual=RESIDUAL,
    )
    if path is not None:
        start, (low, high) = path[0], (state.indentation for state in path)
    state = start
    convolutions = 0

    def excess(indentation: float) -> float:
        nonlocal state, convolutions
        if indentation == 0:
            return -1.0
        shallower = state if path is None else start
        state = interface.load(contact, indentation, start=shallower, residual=_SOLVE_RESIDUAL)
        convolutions += state.convolutions
        return state.force / force - 1

    while excess(high) < 0:
        low, high = high, 1.5 * high
    indentation = brentq(excess, low, high, xtol=1e-12 * high, rtol=1e-12)
    state = solve(contact, indentation, start=start, residual=_SOLVE_RESIDUAL)
    tolerance = _SIZED_TOLERANCE if contact.plasticity.size_effect else FORCE_TOLERANCE
    if abs(state.force / force - 1) > tolerance:
        raise NotConvergedError(
            f"{force:.6g} N could be reached only to a relative error of "
            f"{abs(state.force / force - 1):.1e}, at an indentation of {1e9 * indentation:.6g} nm, "
            "because the force jumps there (too few nodes in contact); refine the grid or change "
            "the force",
            argument="force",
        )
    return replace(state, convolutions=state.convolutions + convolutions)
