"""Solve for pressure and plastic displacement at a prescribed indentation.

All contacts except cohesive ones are solved here. Let K be the operator from pressure to elastic
displacement, δ the indentation, h the gap before the solve (initial gap plus earlier plastic
displacement) and p_y the pressure bound. The pressure p minimises

    ½ pᵀK p − pᵀ(δ − h),   lower ≤ p ≤ p_y.

The gradient g = K p + h − δ is the deformed gap. The gap is open (g ≥ 0) where p = 0 and closed
(g = 0) between the bounds. Where p = p_y the surface yields by u_p = −g.

Without adhesion the lower bound is zero, and the contact lies inside the set {h < δ}, because
K p > 0 under every positive pressure. So solving on the bounding box of this set is exact. In a
periodic contact, the mean of K p is zero, and the box is the whole grid.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact, whole_grid
from restitution.contact.influence import (
    approximate_half_space,
    half_space,
    inverse_half_space,
    periodic_half_space,
    short_inverse_half_space,
)
from restitution.contact.state import Array, State
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.box import NOWHERE, Box, bounding_box, shape_of, widen
from restitution.numerics.convolution.device import current
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.quadratic.minimise import (
    BoundedQuadratic,
    Minimum,
    Operator,
    minimise_quadratic,
)
from restitution.numerics.quadratic.multilevel import Operators, solve_multilevel
from restitution.numerics.quadratic.near_guess import solve_near_guess
from restitution.numerics.read_only import freeze

# Default tolerance on the violation of the contact conditions, relative to the largest overlap of
# the undeformed surfaces.
RESIDUAL = 1e-8
_ROUGH = 1e-4  # smallest residual of an estimate for which approximate operators are good enough
MAX_ITERATIONS = 1000  # iterations after which a solve counts as not converged


Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class HeldNodes:
    """Nodes of the box that are held in contact and can carry tension.

    `tension` (Pa) is the largest tension allowed, and `first_guess` the initial pressure (Pa; None
    means zero). `estimate` accepts a gradient that the minimiser has only estimated.
    """

    mask: Mask
    tension: float
    first_guess: Array | None = None
    estimate: bool = True


@dataclass(frozen=True)
class Solution:
    """Result of a solve; the arrays have the shape of the box.

    `overlap` is the overlap (m) of the surfaces before elastic deformation, `gap` the gap (m) after
    deformation and `pressure` the pressure (Pa).
    """

    overlap: Array
    pressure: Array
    gap: Array
    residual: float
    convolutions: int


def solve_nonadhesive(
    contact: Contact,
    indentation: float,
    limit: Array | float,
    residual: float,
    history: State | None = None,
) -> State:
    """Solve the contact without adhesion.

    The first guess is the solution on coarser grids. It is nearer to the result than the pressure
    of an earlier state would be.
    """
    box = candidate_box(contact, indentation, history)
    if box is None:
        return separated_state(contact, indentation, history)
    return solve_pressure(
        contact, indentation, box, limit=limit, history=history, residual=residual
    )


def solve_pressure(
    contact: Contact,
    indentation: float,
    box: Box,
    *,
    limit: Array | float,
    history: State | None = None,
    held: HeldNodes | None = None,
    residual: float = RESIDUAL,
) -> State:
    """Solve for a pressure of at most `limit` (Pa), with the plastic displacement of `history`.

    The lower bound of the pressure is −`held.tension` at the held nodes, and 0 at all others. `box`
    must contain the `candidate_box` and all held nodes. Contact at the grid edge is not checked
    here. Raises `NotConvergedError`, and `DomainError` if a periodic contact of elastic bodies is
    complete (has no gap left).
    """
    device, shape = current(), shape_of(box)
    b = _overlap(contact, indentation, box, history)
    if contact.periodic and np.ndim(limit) == 0 and limit == math.inf and b.mean() >= 0:
        raise DomainError(
            f"indentation: the contact is complete at {1e9 * (indentation - b.mean()):.6g} nm and "
            "at larger indentations (no gap is left); use a smaller indentation, or prescribe the "
            "pressure"
        )
    scale = _scale_of(contact, indentation, b)
    operators = operators_of(contact)
    upper = device.put(np.ascontiguousarray(limit[box])) if isinstance(limit, np.ndarray) else limit
    if held is None:
        minimum, convolutions = solve_multilevel(
            operators,
            device.put(b),
            upper,
            tolerance=residual * scale,
            max_iterations=MAX_ITERATIONS,
            periodic=contact.periodic,
        )
    else:
        K, inverse = operators(shape, 0)
        guess = held.first_guess
        # Without lags: after loose solves, the pull-off force depends on the steps.
        minimum = minimise_quadratic(
            BoundedQuadratic(
                K,
                device.put(b),
                lower=device.put(np.where(held.mask, -held.tension, 0.0)),
                upper=upper,
                K_single=K.single_precision,
            ),
            start=device.put(np.zeros(shape) if guess is None else guess.copy()),
            precondition=inverse,
            tolerance=residual * scale,
            max_iterations=MAX_ITERATIONS,
            accept_estimated_gradient=held.estimate,
        )
        convolutions = K.count
    reached = minimum.residual / scale
    require_converged(minimum, _solve_at(indentation), residual, reached)
    solution = Solution(
        overlap=b,
        pressure=device.get(minimum.point),
        gap=device.get(minimum.gradient),
        residual=reached,
        convolutions=convolutions,
    )
    return build_state(contact, indentation, box, solution, limit=limit, history=history)


def _solve_at(indentation: float) -> str:
    return f"the solve at an indentation of {1e9 * indentation:.6g} nm"


def require_converged(minimum: Minimum, solve: str, residual: float, reached: float) -> None:
    if not minimum.converged:
        raise NotConvergedError(
            f"{solve} stopped at a residual of {reached:.1e} (tolerance: {residual:.0e}) "
            f"after {minimum.iterations} iterations; use another grid spacing or a smoother "
            "surface (in Python, the argument residual sets the tolerance)"
        )


def elastic_pressure(
    contact: Contact, indentation: float, residual: float
) -> tuple[Array, Box, int]:
    """Estimate the pressure (Pa) between elastic bodies without adhesion, on a box.

    `residual` bounds the root mean square of the violation of the contact conditions, relative to
    the largest overlap. Isolated contact patches of a few nodes can be missing, because
    `solve_near_guess` does not check all nodes. Returns the pressure, the box and the number of
    convolutions. Raises `NotConvergedError`.
    """
    box = candidate_box(contact, indentation)
    if box is None:
        return np.zeros((0, 0)), NOWHERE, 0
    device = current()
    b = _overlap(contact, indentation, box)
    scale = _scale_of(contact, indentation, b)
    make = approximate_half_space if residual >= _ROUGH else None
    minimum, window, convolutions = solve_near_guess(
        operators_of(contact, make),
        operators_of(contact, make, short_inverse_half_space),
        device.put(b),
        tolerance=residual * scale,
        max_iterations=MAX_ITERATIONS,
    )
    require_converged(minimum, _solve_at(indentation), residual, minimum.residual / scale)
    rows, columns = (
        slice(side.start + part.start, side.start + part.stop)
        for side, part in zip(box, window, strict=True)
    )
    return device.get(minimum.point), (rows, columns), convolutions


def _overlap(contact: Contact, indentation: float, box: Box, history: State | None = None) -> Array:
    b: Array = indentation - contact.gap[box]
    if history is not None:
        b -= history.plastic_displacement[box]
    return b


def _scale_of(contact: Contact, indentation: float, b: Array) -> float:
    """Length (m) by which residuals are divided; `b` is the overlap before deformation."""
    if contact.adhesion is None:
        return float(b.max())
    return contact.adhesion.residual_length(contact.pair, indentation)


def operators_of(
    contact: Contact,
    make: Callable[..., Convolution] | None = None,
    invert: Callable[..., Operator] = inverse_half_space,
) -> Operators:
    """Return a function that makes two operators for a grid level: K and its approximate inverse.

    The elastic operator K gives the displacement due to a pressure. `make` makes K, by default for
    the free or periodic half-space, and `invert` its inverse.
    """
    E_star, (hx, hy) = contact.pair.contact_modulus, contact.grid.spacing
    make = make or (periodic_half_space if contact.periodic else half_space)

    def operators(shape: tuple[int, int], level: int) -> tuple[Convolution, Operator]:
        cells = 2**level * hx, 2**level * hy
        return make(shape, cells, E_star), invert(shape, cells, E_star)

    return operators


def build_state(
    contact: Contact,
    indentation: float,
    box: Box,
    solution: Solution,
    *,
    limit: Array | float,
    history: State | None,
) -> State:
    """Build the state of a `solution`, whose gap is overwritten.

    Where the pressure is at the limit, a negative deformed gap becomes plastic displacement. Under
    a bound that grows, `Plasticity.work` adds the plastic work later.
    """
    pressure, gap = solution.pressure, solution.gap
    plastic, work = _plastic(contact, history)
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    yielding = (pressure >= upper) & (gap < 0)
    if yielding.any():
        if history is not None:
            plastic = plastic.copy()
        lowered = plastic[box]
        np.subtract(lowered, gap, out=lowered, where=yielding)
        if not contact.plasticity.grows:
            if isinstance(upper, np.ndarray):
                dissipated = float(np.sum(upper * gap, where=yielding))
            else:
                dissipated = upper * float(np.sum(gap, where=yielding))
            work -= dissipated * contact.grid.cell_area
    return State(
        contact=contact,
        indentation=indentation,
        box=box,
        box_pressure=freeze(pressure),
        box_displacement=freeze(np.add(gap, solution.overlap, out=gap)),
        plastic_displacement=freeze(plastic),
        bound=limit,
        plastic_work=work,
        adhesive_work=0.0 if history is None else history.adhesive_work,
        work_error=0.0 if history is None else history.work_error,
        residual=solution.residual,
        convolutions=solution.convolutions,
    )


def candidate_box(contact: Contact, indentation: float, history: State | None = None) -> Box | None:
    """Box of all nodes with a gap below `indentation`, or the whole period; None without any.

    Without adhesion, no other node can come into contact.
    """
    if history is None and not contact.periodic:
        below = [np.flatnonzero(smallest < indentation) for smallest in contact.smallest_gaps]
        if not all(part.size for part in below):
            return None
        rows, columns = (slice(int(part[0]), int(part[-1]) + 1) for part in below)
        return rows, columns
    whole = region = whole_grid(contact)
    gap = contact.gap
    if history is not None:
        if indentation <= history.indentation and not contact.periodic:
            # On unloading, no new contact arises outside the box of `history`.
            region = widen(history.box, 2, contact.grid.nodes)
        gap = gap[region] + history.plastic_displacement[region]
    touching = gap < indentation
    if contact.periodic:
        return whole if touching.any() else None
    return bounding_box(touching, region)


def separated_state(contact: Contact, indentation: float, history: State | None = None) -> State:
    nothing = np.zeros((0, 0))
    plastic, work = _plastic(contact, history)
    return State(
        contact=contact,
        indentation=indentation,
        box=NOWHERE,
        box_pressure=nothing,
        box_displacement=nothing,
        plastic_displacement=freeze(plastic),
        bound=contact.first_yield_pressure if history is None else history.bound,
        plastic_work=work,
        adhesive_work=0.0 if history is None else history.adhesive_work,
        work_error=0.0 if history is None else history.work_error,
        residual=0.0,
        convolutions=0,
    )


def _plastic(contact: Contact, history: State | None) -> tuple[Array, float]:
    if history is None:
        return np.zeros(contact.grid.nodes), 0.0
    return history.plastic_displacement, history.plastic_work
