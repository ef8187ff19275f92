"""Contact area of adhesive contacts: which nodes attach or are released at one indentation.

On a grid, the contact edge moves by whole nodes, so force and indentation scatter about their
values in the continuum. The *balance* of a contact area removes this scatter: it is the indentation
and the force at which the energy release rate G, averaged along the edge of this area, equals the
work of adhesion w.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, cast

import numpy as np

from restitution.contact.checks.resolution import radius_of_asperities
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import (
    HeldNodes,
    Mask,
    candidate_box,
    separated_state,
    solve_pressure,
)
from restitution.contact.jkr.detachment import Edge, tension_limit
from restitution.contact.state import Array, State
from restitution.numerics.box import Box, bounding_box, reframe, union, widen
from restitution.theory import Kendall

if TYPE_CHECKING:
    from restitution.contact.jkr.limit import JKRLimit

# At the balance, the mean energy release rate G along the edge equals the work of adhesion (see the
# top of this file). It is found by interpolation between the state before a retraction (position 0)
# and the state after it (position 1), linear in sqrt(G). The balance can also lie before the first
# state, down to the position _EARLIEST. The mean includes only edge nodes at which G exceeds the
# fraction _ACTIVE of the work of adhesion in one of the states.
_ACTIVE, _EARLIEST = 0.8, -0.5
# Balances are used only if the contact radius at which an asperity pulls off is at least this
# number of cells. On coarser grids, most nodes leave the contact because the bodies separate, not
# because G reaches the work of adhesion.
_RESOLVED = 2.0
# To find the balance of a loaded contact, the bodies are retracted. The distance is _RETREAT times
# the pull-off displacement of a flat punch with the same contact area. The retracted contact is
# solved with the tolerance _BALANCE_RESIDUAL.
_RETREAT, _BALANCE_RESIDUAL = 0.05, 1e-5
# A contact grows by rings of nodes around it. If less than this fraction of the nodes of a ring is
# released again, the next ring is twice as wide.
_FEW = 0.1


def jkr_of(contact: Contact) -> JKRLimit:
    return cast("JKRLimit", contact.adhesion)


def release_nodes(
    contact: Contact,
    indentation: float,
    box: Box,
    held: Mask,
    *,
    limit: Array | float,
    history: State | None = None,
    first_guess: Array | None = None,
    residual: float,
) -> tuple[State, State]:
    """Hold nodes in contact, then release nodes as long as some meet the detachment criterion.

    `held` marks the nodes that are held at first, and `first_guess` is a pressure (Pa); both are
    arrays on `box`. `residual` is the tolerance of the last solve. Returns the state before the
    first release and the state after the last one.
    """
    model = jkr_of(contact)
    grid, pair = contact.grid, contact.pair
    around = union(candidate_box(contact, indentation, history), bounding_box(held, box))
    if around is None:
        state = separated_state(contact, indentation, history)
        return state, state
    around = widen(around, 2, grid.nodes)
    held = reframe(held, box, around).copy()
    if first_guess is not None:
        first_guess = reframe(first_guess, box, around)
    gap = contact.gap[around]
    if history is not None:
        gap = gap + history.plastic_displacement[around]
    w = model.work_of_adhesion
    tension = tension_limit(pair.contact_modulus, w, grid.spacing)
    before_release: State | None = None
    convolutions = 0
    # A coarse tolerance is enough to decide which nodes are released. Only the last solve needs the
    # requested tolerance.
    accuracy = model.detachment.accuracy(model.relative_opening(contact, indentation), residual)
    while True:
        # In the solve, the tension of a node is limited to `2 * tension`, because the solver is
        # faster with a limit than without one. Nodes under such a tension are released anyway, so
        # the limit does not affect the result.
        state = solve_pressure(
            contact,
            indentation,
            around,
            limit=limit,
            history=history,
            held=HeldNodes(held, 2 * tension, first_guess, model.detachment.by_energy),
            residual=accuracy,
        )
        convolutions += state.convolutions
        state = replace(state, convolutions=convolutions)
        before_release = before_release or state
        pressure = state.box_pressure
        # From now on, nodes that have come into compression are also held.
        held |= pressure > 0
        released = model.detachment.released(state, gap, held, w, tension)
        if not released.any():
            if accuracy == residual:
                return before_release, state
            accuracy = residual
            if before_release is state:
                before_release = None
        held &= ~released
        first_guess = np.where(released, 0.0, pressure)


def grow_contact(
    contact: Contact,
    indentation: float,
    box: Box,
    held: Mask,
    *,
    limit: Array | float,
    first_guess: Array | None = None,
    residual: float,
) -> State:
    """Let the contact grow outwards from the nodes `held`, ring by ring, and return its state.

    The bodies have not yielded before. The contact stops growing when a further ring of one cell no
    longer lowers the energy or, with a criterion that is not `by_energy`, adds no contact nodes.
    """
    by_energy = jkr_of(contact).detachment.by_energy

    def release(box: Box, held: Mask, first_guess: Array | None) -> State:
        return release_nodes(
            contact, indentation, box, held, limit=limit, first_guess=first_guess, residual=residual
        )[1]

    state = release(box, held, first_guess)
    convolutions = state.convolutions
    # At first touch no node carries pressure yet, but the neighbours of the held nodes may attach.
    # The first ring is then placed around the held nodes.
    touching = state.box_pressure != 0 if state.contact_nodes else reframe(held, box, state.box)
    tried = by_energy and state.contact_nodes > 0
    cells = 1
    while True:
        around = widen(state.box, cells, contact.grid.nodes)
        grown = _surrounded(reframe(touching, state.box, around), cells)
        if cells == 1 and tried and not (grown & ~reframe(held, box, around)).any():
            break  # all nodes of this ring were held before and have been released
        wider = release(around, grown, reframe(state.box_pressure, state.box, around))
        convolutions += wider.convolutions
        if not _is_better(wider, state):
            if cells == 1:
                break
            cells = 1
            continue
        ring = np.count_nonzero(grown) - state.contact_nodes
        lost = np.count_nonzero(grown) - wider.contact_nodes
        cells = 2 * cells if by_energy and lost < _FEW * ring else 1
        state, touching, held, box = wider, wider.box_pressure != 0, grown, around
        tried = by_energy
    return replace(state, convolutions=convolutions)


def _surrounded(touching: Mask, cells: int) -> Mask:
    """The nodes `touching` with a ring of nodes of width `cells`."""
    from scipy.ndimage import distance_transform_edt

    return np.asarray(distance_transform_edt(~touching) < cells + 0.5)


def _is_better(wider: State, state: State) -> bool:
    model = jkr_of(state.contact)
    if not model.detachment.by_energy or not state.contact_nodes:
        return wider.contact_nodes > state.contact_nodes
    gained = wider.contact_area - state.contact_area
    return wider.stored_energy - state.stored_energy < model.work_of_adhesion * gained


def unload_adhesive(
    state: State, indentation: float, *, first_guess: Array | None = None, residual: float
) -> State:
    """Move an adhesive contact to a smaller `indentation` and release nodes there.

    `first_guess` (Pa) is an array on the box of `state`. Up to the first release, the contact area
    is fixed and the force is linear in the indentation, so the trapezoidal rule gives the work
    exactly.
    """
    before_release, new = release_nodes(
        state.contact,
        indentation,
        state.box,
        state.box_pressure != 0,
        limit=state.bound,
        history=state,
        first_guess=state.box_pressure if first_guess is None else first_guess,
        residual=residual,
    )
    lost = before_release.stored_energy - new.stored_energy
    balance = None
    if (
        jkr_of(state.contact).detachment.by_energy
        and 0 < before_release.contact_nodes != new.contact_nodes
    ):
        balance = _balance(state, before_release)
    return replace(
        new,
        adhesive_work=state.adhesive_work - lost,
        force_before_release=before_release.force,
        balance=balance,
        is_first_loading=False,
    )


def pull_off_of_punch(state: State) -> tuple[float, float]:
    """Pull-off displacement (m) and force (N) of a flat punch with the contact area of `state`."""
    contact = state.contact
    punch = Kendall(contact.pair.contact_modulus, jkr_of(contact).work_of_adhesion)
    a = math.sqrt(state.contact_area / math.pi)
    return float(punch.pull_off_displacement(a)), float(punch.pull_off_force(a))


def balances_are_reliable(state: State) -> bool:
    """Whether the result of `balance_of` can be used for `state`."""
    contact = state.contact
    model = jkr_of(contact)
    if not model.detachment.by_energy:
        return False
    radius = model.pull_off_radius(contact.pair, radius_of_asperities(state))
    return radius / max(contact.grid.spacing) >= _RESOLVED


def balance_of(state: State) -> tuple[float, float]:
    """Balance of the contact area of a loaded `state`: indentation (m) and force (N).

    The contact is solved once more with the same area at a smaller indentation. If no balance
    exists, the values of `state` are returned.
    """
    contact = state.contact
    if state.contact_nodes == 0:
        return state.indentation, state.force
    retreat, _ = pull_off_of_punch(state)
    retracted = solve_pressure(
        contact,
        state.indentation - _RETREAT * retreat,
        state.box,
        limit=state.bound,
        history=state,
        held=HeldNodes(state.box_pressure != 0, math.inf, state.box_pressure),
        residual=_BALANCE_RESIDUAL,
    )
    return _balance(state, retracted) or (state.indentation, state.force)


def _balance(state: State, retracted: State) -> tuple[float, float] | None:
    """Balance of the contact area of `state`: indentation (m) and force (N), or None.

    `retracted` has the same contact area at a smaller indentation. While the area is fixed, sqrt(G)
    and the force are linear in the indentation.
    """
    contact, w = state.contact, jkr_of(state.contact).work_of_adhesion
    touching = state.box_pressure != 0
    rates = []
    for solved in (state, retracted):
        gap = contact.gap[solved.box] + state.plastic_displacement[solved.box]
        mask = reframe(touching, state.box, solved.box)
        rates.append(Edge.of(solved.box_pressure, solved.box_displacement, gap, mask).G)
    active = np.maximum(*rates) > _ACTIVE * w
    if not active.any():
        return None
    first, last = (math.sqrt(max(float(G[active].mean()), 0.0)) for G in rates)
    if last <= first:
        return None
    at_balance = (math.sqrt(w) - first) / (last - first)
    part = min(max(at_balance, _EARLIEST), 1.0)
    return (
        state.indentation + part * (retracted.indentation - state.indentation),
        state.force + part * (retracted.force - state.force),
    )
