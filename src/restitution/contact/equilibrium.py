"""Pressure and yield at a prescribed indentation: the one solve behind everything.

With the gap h before the solve (initial gap plus earlier plastic displacement) the pressure is the
minimiser of

    ½ pᵀK p − pᵀ(δ − h),   lower ≤ p ≤ p_y,

whose gradient g = K p + h − δ is the deformed gap: open (g ≥ 0) where p = 0, closed (g = 0) between
the bounds, and where p = p_y the surface gives way plastically by u_p = −g. Without adhesion the
lower bound is zero, and contact lies inside {h < δ}, because K p > 0 wherever there is pressure:
solving on that box alone is exact. With adhesion the lower bound is a tension on the nodes that are
held in contact; the box holds them, too, and two cells around.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.edge import edge_advice
from restitution.contact.influence import half_space, inverse_half_space
from restitution.contact.state import Box, State
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.minimise import minimise_quadratic

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RESIDUAL = 1e-8  # default tolerance: violation of the contact conditions over the overlap
_MAX_ITERATIONS = 1000


def equilibrate(
    contact: Contact,
    indentation: float,
    *,
    limit: float,
    history: State | None = None,
    held: Mask | None = None,
    tension: float = 0.0,
    first_guess: Array | None = None,
    residual: float = RESIDUAL,
) -> State:
    """Solve for p ≤ `limit` on the surface `history` left; p ≥ 0, or ≥ −`tension` where `held`.

    The violation of the contact conditions is measured against the overlap δ − min h, with adhesion
    against the indentation or the length scale of adhesion. Raises `NotConvergedError`. Contact at
    the rim is let pass.
    """
    pressure = np.zeros(contact.grid.nodes)
    region: Box = slice(None), slice(None)
    if history is None:
        plastic, work, adhesive_work, work_error = np.zeros_like(pressure), 0.0, 0.0, 0.0
    else:
        plastic, work = history.plastic_displacement, history.plastic_work
        adhesive_work, work_error = history.adhesive_work, history.work_error
        if indentation <= history.indentation:  # no contact where there was none
            region = _widen(history.box, 2, contact.grid.nodes)
    gap = contact.gap[region] + plastic[region]
    box = bounding_box(gap < indentation if held is None else (gap < indentation) | held[region])
    if box is None:
        nowhere = slice(0, 0), slice(0, 0)
        return State(contact, indentation, pressure, plastic, nowhere, pressure[nowhere],
                     work, adhesive_work, work_error, residual=0.0, convolutions=0)  # fmt: skip
    box = _shift(box, region)
    if held is not None:
        box = _widen(box, 2, contact.grid.nodes)

    b = indentation - contact.gap[box] - plastic[box]
    shape = (b.shape[0], b.shape[1])
    K = half_space(shape, contact.grid.spacing, contact.pair.contact_modulus)
    # How far the surfaces overlap: δ itself when nothing has yielded.
    scale = contact.length_at(indentation) if contact.adhesive else float(b.max())
    found = minimise_quadratic(
        K,
        b,
        lower=np.zeros(shape) if held is None else np.where(held[box], -tension, 0.0),
        upper=np.full(shape, limit),
        start=np.zeros(shape) if first_guess is None else first_guess[box],
        precondition=inverse_half_space(shape, contact.grid.spacing, contact.pair.contact_modulus),
        tolerance=residual * scale,
        max_iterations=_MAX_ITERATIONS,
    )
    reached = found.residual / scale
    if not found.converged:
        raise NotConvergedError(
            f"the solve at an indentation of {1e9 * indentation:.6g} nm stopped at a residual of "
            f"{reached:.1e} (asked: {residual:.0e}) after {found.iterations} iterations; "
            "ask for a larger residual, or smooth or refine the surface"
        )
    pressure[box] = found.point
    yielding = np.where(found.point >= limit, np.maximum(-found.gradient, 0.0), 0.0)
    if yielding.any():
        plastic = plastic.copy()
        plastic[box] += yielding
        work += limit * float(yielding.sum()) * contact.grid.cell_area
    return State(contact, indentation, pressure, plastic, box, found.gradient + b,
                 work, adhesive_work, work_error, reached, K.count)  # fmt: skip


def refuse_edge(state: State) -> None:
    """Raise `DomainError` when a node on the rim of the grid is in contact."""
    p, grid = state.pressure, state.contact.grid
    if not (p[0].any() or p[-1].any() or p[:, 0].any() or p[:, -1].any()):
        return
    wide, long = (1e6 * edge for edge in grid.size)
    raise DomainError(
        f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an indentation "
        f"of {1e9 * state.indentation:.4g} nm; {edge_advice(state.contact, state.indentation)}"
    )


def bounding_box(mask: Mask) -> Box | None:
    """The smallest block of indices that holds every true node; None when there is none."""
    rows = np.flatnonzero(mask.any(axis=1))
    if rows.size == 0:
        return None
    columns = np.flatnonzero(mask[rows[0] : rows[-1] + 1].any(axis=0))
    return slice(rows[0], rows[-1] + 1), slice(columns[0], columns[-1] + 1)


def _shift(box: Box, region: Box) -> Box:
    """The box in the indices of the grid, when it was found in those of `region`."""
    rows, columns = (
        slice(part.start + (within.start or 0), part.stop + (within.start or 0))
        for part, within in zip(box, region, strict=True)
    )
    return rows, columns


def _widen(box: Box, cells: int, nodes: tuple[int, int]) -> Box:
    rows, columns = (
        slice(max(part.start - cells, 0), min(part.stop + cells, n))
        for part, n in zip(box, nodes, strict=True)
    )
    return rows, columns
