"""Contact sets of adhesive contacts: nodes let go (peel) or come in (attach) at one indentation."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.detachment import Mask, criterion, tension_limit
from restitution.contact.equilibrium import equilibrate
from restitution.contact.state import State

Array = NDArray[np.float64]

# While nodes are let go the contact is solved this well, in parts of the opening at its edge.
_RELEASING = 0.05


def peel(
    contact: Contact,
    indentation: float,
    held: Mask,
    *,
    limit: float,
    history: State | None = None,
    first_guess: Array | None = None,
    residual: float,
) -> tuple[State, State]:
    """Hold the nodes `held` in contact, then release until none has to let go.

    Returns the state before the first release and the one after the last.
    """
    grid, pair = contact.grid, contact.pair
    rule = criterion(
        contact.detachment, pair.contact_modulus, contact.work_of_adhesion, grid.spacing
    )
    # No node keeps more than the tension limit, so twice that is as good as no bound, and easier.
    tension = 2 * tension_limit(pair.contact_modulus, contact.work_of_adhesion, grid.spacing)
    rough = max(residual, _RELEASING * contact.opening / contact.length_at(indentation))
    held = held.copy()
    accuracy = residual
    pulled: State | None = None
    convolutions = 0
    while True:
        state = equilibrate(
            contact,
            indentation,
            limit=limit,
            history=history,
            held=held,
            tension=tension,
            first_guess=first_guess,
            residual=accuracy,
        )
        convolutions += state.convolutions
        state = replace(state, convolutions=convolutions)
        pulled = state if pulled is None else pulled
        if not state.contact_nodes:
            return pulled, state
        box = state.box
        # Nodes that were pushed into contact are held from now on.
        held[box] |= state.pressure[box] > 0
        gap = contact.gap[box] + state.plastic_displacement[box]
        released = rule.releases(state.pressure[box], state.box_displacement, gap, held[box])
        if not released.any():
            if accuracy == residual:
                return pulled, state
            accuracy, first_guess = residual, state.pressure
            continue
        accuracy = rough
        held[box] &= ~released
        first_guess = np.zeros_like(state.pressure)
        first_guess[box] = np.where(released, 0.0, state.pressure[box])


def attach(
    contact: Contact,
    indentation: float,
    held: Mask,
    *,
    limit: float,
    first_guess: Array | None = None,
    residual: float,
) -> State:
    """Grow the contact of the undeformed bodies from `held`, ring by ring, while it holds."""
    from scipy.ndimage import binary_dilation

    ring = np.ones((3, 3), dtype=bool)
    _, state = peel(
        contact, indentation, held, limit=limit, first_guess=first_guess, residual=residual
    )
    convolutions = state.convolutions
    # At first touch the node that touches carries nothing yet; what grows from it may.
    touching = state.pressure != 0 if state.contact_nodes else held
    while True:
        _, wider = peel(
            contact,
            indentation,
            binary_dilation(touching, structure=ring),
            limit=limit,
            first_guess=state.pressure,
            residual=residual,
        )
        convolutions += wider.convolutions
        if wider.contact_nodes <= state.contact_nodes:
            return replace(state, convolutions=convolutions)
        state, touching = wider, wider.pressure != 0


def pull(state: State, indentation: float, *, first_guess: Array | None = None,
         residual: float) -> State:  # fmt: skip
    """Move an adhesive contact to a smaller `indentation` and let nodes go there.

    The state remembers the force just before the first release: with the contact held the force is
    linear in the indentation, so the work up to there is exact by the trapezium.
    """
    pulled, settled = peel(
        state.contact,
        indentation,
        state.pressure != 0,
        limit=state.contact.yield_pressure,
        history=state,
        first_guess=state.pressure if first_guess is None else first_guess,
        residual=residual,
    )
    lost = pulled.stored_energy - settled.stored_energy
    return replace(
        settled, adhesive_work=state.adhesive_work - lost, pulled_force=pulled.force, virgin=False
    )


def limit_of(contact: Contact) -> float:
    """The pressure bound of the solve: p_y, or none when the pressure is cut afterwards."""
    return math.inf if contact.plasticity == "truncated" else contact.yield_pressure
