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
from restitution.contact.state import State
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.convolution import FreeConvolution, SpectralFilter
from restitution.numerics.device import current
from restitution.numerics.minimise import minimise_quadratic
from restitution.numerics.nesting import System, minimise_nested
from restitution.numerics.window import NOWHERE, Box, bounding_box, shape_of, widen

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RESIDUAL = 1e-8  # default tolerance: violation of the contact conditions over the overlap
MAX_ITERATIONS = 1000


def equilibrate(
    contact: Contact,
    indentation: float,
    box: Box,
    *,
    limit: Array | float,
    history: State | None = None,
    held: Mask | None = None,
    tension: float = 0.0,
    first_guess: Array | None = None,
    residual: float = RESIDUAL,
) -> State:
    """Solve for p ≤ `limit` on the surface `history` left; p ≥ 0, or ≥ −`tension` where `held`.

    `limit` is a number, or an array of the shape of the grid.

    `box` has to hold the `reach` and all nodes that are held; `held` and `first_guess`, where to
    begin with nodes held, are arrays on it. The violation of the contact conditions is measured
    against the overlap δ − min h, with adhesion against the indentation or the length scale of
    adhesion. Raises `NotConvergedError`. Contact at the rim is let pass.
    """
    device, shape = current(), shape_of(box)
    b = _overlap(contact, indentation, box, history)
    scale = _scale_of(contact, indentation, b)
    system = _system_of(contact)
    upper = limit
    if isinstance(limit, np.ndarray):
        upper = device.put(np.ascontiguousarray(limit[box]))
    if held is None:
        found, convolutions = minimise_nested(
            system, device.put(b), upper, tolerance=residual * scale, max_iterations=MAX_ITERATIONS
        )
    else:
        K, inverse = system(shape, 0)
        found = minimise_quadratic(
            K,
            device.put(b),
            lower=device.put(np.where(held, -tension, 0.0)),
            upper=upper,
            start=device.put(np.zeros(shape) if first_guess is None else first_guess.copy()),
            precondition=inverse,
            quick=K.quick,
            tolerance=residual * scale,
            max_iterations=MAX_ITERATIONS,
        )
        convolutions = K.count
    reached = found.residual / scale
    if not found.converged:
        raise NotConvergedError(
            f"the solve at an indentation of {1e9 * indentation:.6g} nm stopped at a residual of "
            f"{reached:.1e} (asked: {residual:.0e}) after {found.iterations} iterations; ask for a "
            "larger residual, or smooth or refine the surface"
        )
    return settled(contact, indentation, box, b, device.get(found.point),
                   device.get(found.gradient), limit=limit, history=history, residual=reached,
                   convolutions=convolutions)  # fmt: skip


def _overlap(contact: Contact, indentation: float, box: Box, history: State | None = None) -> Array:
    """δ − h on `box`: how far the bodies would go into each other there, m."""
    b: Array = indentation - contact.gap[box]
    if history is not None:
        b -= history.plastic_displacement[box]
    return b


def _scale_of(contact: Contact, indentation: float, b: Array) -> float:
    """What residuals are measured against: how far the surfaces overlap, or adhesion's length."""
    return contact.length_at(indentation) if contact.adhesive else float(b.max())


def _system_of(contact: Contact) -> System:
    """The half-space of a contact and its approximate inverse."""
    E_star, (hx, hy) = contact.pair.contact_modulus, contact.grid.spacing

    def system(shape: tuple[int, int], level: int) -> tuple[FreeConvolution, SpectralFilter]:
        cells = 2**level * hx, 2**level * hy
        return half_space(shape, cells, E_star), inverse_half_space(shape, cells, E_star)

    return system


def settled(
    contact: Contact,
    indentation: float,
    box: Box,
    b: Array,
    pressure: Array,
    gradient: Array,
    *,
    limit: Array | float,
    history: State | None,
    residual: float,
    convolutions: int,
) -> State:
    """The state with that overlap `b`, pressure and deformed gap: what yields has given way.

    The displacement takes the place of the `gradient`. Under a limit for each node the plastic work
    stays that of `history`: `loading` integrates it.
    """
    plastic, work, adhesive_work, work_error = _past(contact, history)
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    yielding = (pressure >= upper) & (gradient < 0)
    if yielding.any():
        if history is not None:
            plastic = plastic.copy()
        lowered = plastic[box]
        np.subtract(lowered, gradient, out=lowered, where=yielding)
        if not isinstance(limit, np.ndarray):
            work -= limit * float(np.sum(gradient, where=yielding)) * contact.grid.cell_area
    displacement = np.add(gradient, b, out=gradient)
    return State(contact, indentation, box, pressure, displacement, plastic, limit,
                 work, adhesive_work, work_error, residual, convolutions)  # fmt: skip


def reach(contact: Contact, indentation: float, history: State | None = None) -> Box | None:
    """The box of the nodes that bodies without adhesion could touch: gap below `indentation`."""
    nodes = contact.grid.nodes
    if history is None:
        return bounding_box(contact.gap < indentation)
    if indentation <= history.indentation:  # no contact where there was none
        region = widen(history.box, 2, nodes)
    else:
        region = (slice(0, nodes[0]), slice(0, nodes[1]))
    gap = contact.gap[region] + history.plastic_displacement[region]
    return bounding_box(gap < indentation, region)


def parted(contact: Contact, indentation: float, history: State | None = None) -> State:
    """The state without any contact."""
    nothing = np.zeros((0, 0))
    plastic, work, adhesive_work, work_error = _past(contact, history)
    bound = contact.first_yield_pressure if history is None else history.bound
    return State(contact, indentation, NOWHERE, nothing, nothing, plastic, bound,
                 work, adhesive_work, work_error, residual=0.0, convolutions=0)  # fmt: skip


def _past(contact: Contact, history: State | None) -> tuple[Array, float, float, float]:
    """Plastic displacement, plastic and adhesive work, and the error of the works."""
    if history is None:
        return np.zeros(contact.grid.nodes), 0.0, 0.0, 0.0
    return (history.plastic_displacement, history.plastic_work,
            history.adhesive_work, history.work_error)  # fmt: skip


def refuse_edge(state: State) -> None:
    """Raise `DomainError` when a node on the rim of the grid is in contact."""
    p, grid = state.box_pressure, state.contact.grid
    (top, left), (bottom, right) = ((part.start for part in state.box),
                                    (part.stop for part in state.box))  # fmt: skip
    nx, ny = grid.nodes
    reached = (
        (top == 0 and p[:1].any()) or (bottom == nx and p[-1:].any())
        or (left == 0 and p[:, :1].any()) or (right == ny and p[:, -1:].any())
    )  # fmt: skip
    if not reached:
        return
    wide, long = (1e6 * edge for edge in grid.size)
    raise DomainError(
        f"the contact reaches the edge of the {wide:.4g} um x {long:.4g} um grid at an indentation "
        f"of {1e9 * state.indentation:.4g} nm; {edge_advice(state.contact, state.indentation)}"
    )
