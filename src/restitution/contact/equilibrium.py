"""Pressure and yield at a prescribed indentation.

With the gap h before the solve (initial gap plus earlier plastic displacement) the pressure is the
minimiser of

    ½ pᵀK p − pᵀ(δ − h),   0 ≤ p ≤ p_y,

whose gradient g = K p + h − δ is the deformed gap: open (g ≥ 0) where p = 0, closed (g = 0) between
the bounds, and where p = p_y the surface gives way plastically by u_p = −g. Contact lies inside
{h < δ}, because K p > 0 wherever there is pressure: solving on that box alone is exact.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.edge import edge_advice
from restitution.contact.influence import half_space, inverse_half_space
from restitution.contact.state import Box, State
from restitution.errors import CaseError, DomainError, NotConvergedError
from restitution.numerics.minimise import minimise_quadratic
from restitution.numerics.quadrature import integrate_adaptively

Array = NDArray[np.float64]

RESIDUAL = 1e-8  # default tolerance: violation of the contact conditions over the indentation
_MAX_ITERATIONS = 1000
_WORK_TOLERANCE = 1e-5  # of the loading work, where it needs quadrature ("truncated")
_WORK_RESIDUAL = 1e-6  # of the solves in between, whose force errors stay well below that


def solve(
    contact: Contact, indentation: float, *, start: State | None = None, residual: float = RESIDUAL
) -> State:
    """Load the undeformed bodies to `indentation` (m) in one solve and return the state there.

    Under the yield bound the state does not depend on the path of a monotonic loading, so no
    stepping is needed and W = E_el + p_y V_p. With `plasticity = "truncated"` there is no such
    identity: its work is integrated from `start` (a shallower state of the same contact; else from
    first touch). `start` also serves as first guess. Raises `CaseError` for an indentation that is
    not positive, `NotConvergedError` when `residual` is not reached, and `DomainError` when the
    contact reaches the edge of the grid.
    """
    if not 0 < indentation < math.inf:
        raise CaseError(f"indentation: {indentation} m is not a positive depth")
    state = solve_uncut(contact, indentation, start=start, residual=residual)
    if contact.plasticity == "truncated" and math.isfinite(contact.yield_pressure):
        state = _truncate(state, start)
    refuse_edge(state)
    return state


def solve_uncut(
    contact: Contact, indentation: float, *, start: State | None, residual: float
) -> State:
    """The one solve behind `solve`: of a `truncated` contact, the elastic state before the cut.

    Its pressure never exceeds what the grid can carry, but contact at the edge is let pass.
    """
    limit = contact.yield_pressure if contact.plasticity == "equilibrium" else math.inf
    guess = start.pressure if start is not None else None
    return _equilibrate(contact, indentation, limit, None, guess, residual)


def step(state: State, indentation: float, *, residual: float = RESIDUAL) -> State:
    """Move a deformed contact to another `indentation` (m), deeper or shallower.

    What has yielded stays yielded. Raises as `solve`, and `CaseError` for deeper loading of a
    `truncated` contact, which has no law for loading a deformed surface.
    """
    if state.contact.plasticity == "truncated" and indentation > state.indentation:
        raise CaseError("a truncated contact can only be unloaded; use solve for a deeper one")
    limit = state.contact.yield_pressure
    new = _equilibrate(state.contact, indentation, limit, state, state.pressure, residual)
    refuse_edge(new)
    return new


def refuse_edge(state: State) -> None:
    """Raise `DomainError` when a node on the rim of the grid carries pressure."""
    p, grid = state.pressure, state.contact.grid
    if not max(p[0].max(), p[-1].max(), p[:, 0].max(), p[:, -1].max()) > 0:
        return
    wide, long = (1e6 * edge for edge in grid.size)
    raise DomainError(
        f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an indentation "
        f"of {1e9 * state.indentation:.4g} nm; {edge_advice(state.contact, state.indentation)}"
    )


def bounding_box(mask: NDArray[np.bool_]) -> Box | None:
    """The smallest block of indices that holds every true node; None when there is none."""
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        return None
    columns = np.flatnonzero(mask[rows[0] : rows[-1] + 1].any(axis=0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _equilibrate(
    contact: Contact,
    indentation: float,
    limit: float,
    history: State | None,
    first_guess: Array | None,
    tolerance: float,
) -> State:
    """Solve for 0 ≤ p ≤ `limit` on the surface that `history` left."""
    pressure = np.zeros(contact.grid.nodes)
    if history is None:
        gap, plastic, work, work_error = contact.gap, np.zeros_like(pressure), 0.0, 0.0
    else:
        gap = contact.gap + history.plastic_displacement
        plastic, work = history.plastic_displacement, history.plastic_work
        work_error = history.plastic_work_error
    box = bounding_box(gap < indentation)
    if box is None:
        nowhere = slice(0, 0), slice(0, 0)
        return State(
            contact,
            indentation,
            pressure,
            plastic,
            nowhere,
            pressure[nowhere],
            work,
            work_error,
            residual=0.0,
            convolutions=0,
        )

    b = indentation - gap[box]
    shape = (b.shape[0], b.shape[1])
    K = half_space(shape, contact.grid.spacing, contact.pair.contact_modulus)
    before = K.count
    found = minimise_quadratic(
        K,
        b,
        lower=np.zeros(shape),
        upper=np.full(shape, limit),
        start=np.zeros(shape) if first_guess is None else first_guess[box],
        precondition=inverse_half_space(shape, contact.grid.spacing, contact.pair.contact_modulus),
        tolerance=tolerance * abs(indentation),
        max_iterations=_MAX_ITERATIONS,
    )
    residual = found.residual / abs(indentation)
    if not found.converged:
        raise NotConvergedError(
            f"the solve at an indentation of {1e9 * indentation:.6g} nm stopped at a residual of "
            f"{residual:.1e} (asked: {tolerance:.0e}) after {found.iterations} iterations; "
            "ask for a larger residual, or smooth or refine the surface"
        )
    pressure[box] = found.point
    yielding = np.where(found.point >= limit, np.maximum(-found.gradient, 0.0), 0.0)
    if yielding.any():
        plastic = plastic.copy()
        plastic[box] += yielding
        work += limit * float(yielding.sum()) * contact.grid.cell_area
    return State(
        contact,
        indentation,
        pressure,
        plastic,
        box,
        found.gradient + b,
        work,
        work_error,
        residual,
        K.count - before,
    )


def _truncate(elastic: State, start: State | None) -> State:
    """Cut the elastic pressure at p_y; the rest of the contact does not take up what is cut.

    Force and area are then those of Thornton and Ning (1998). The plastic displacement is what the
    cut pressure leaves of the interference (next to the contact too), so that unloading starts from
    the cut pressure. The work has no closed form and is integrated from `start`, or from touch.
    """
    contact, indentation, box = elastic.contact, elastic.indentation, elastic.box
    p_y, area = contact.yield_pressure, contact.grid.cell_area
    pressure = np.minimum(elastic.pressure, p_y)
    shape = elastic.box_displacement.shape
    K = half_space((shape[0], shape[1]), contact.grid.spacing, contact.pair.contact_modulus)
    displacement = K(pressure[box])
    plastic = np.zeros_like(pressure)
    plastic[box] = np.maximum(indentation - contact.gap[box] - displacement, 0.0)
    force = float(pressure[box].sum()) * area
    stored = 0.5 * float(np.vdot(pressure[box], displacement)) * area

    guess = start if start is not None and start.indentation < indentation else None
    first, first_force, work, work_error = (
        (guess.indentation, guess.force, guess.loading_work, guess.plastic_work_error)
        if guess is not None
        else (0.0, 0.0, 0.0, 0.0)
    )
    convolutions = elastic.convolutions + 1

    def cut_force(depth: float) -> float:
        nonlocal guess, convolutions
        guess = solve_uncut(contact, depth, start=guess, residual=_WORK_RESIDUAL)
        convolutions += guess.convolutions
        return float(np.minimum(guess.pressure[guess.box], p_y).sum()) * area

    scale = work + 0.5 * (first_force + force) * (indentation - first)
    increment, error = integrate_adaptively(
        cut_force, first, indentation, first_force, force, _WORK_TOLERANCE * scale
    )
    return State(
        contact,
        indentation,
        pressure,
        plastic,
        box,
        displacement,
        work + increment - stored,
        work_error + error,
        elastic.residual,
        convolutions,
    )
