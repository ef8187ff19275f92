"""Solve for pressure and plastic displacement at a prescribed indentation.

All contacts except cohesive ones are solved here. Let K be the operator from pressure to elastic
displacement, δ the indentation, h the gap before the solve (initial gap plus earlier plastic
displacement) and p_y the pressure bound. The pressure p minimises

    ½ pᵀK p − pᵀ(δ − h),   lower ≤ p ≤ p_y.

The gradient g = K p + h − δ is the deformed gap. The gap is open (g ≥ 0) where p = 0 and closed
(g = 0) between the bounds. Where p = p_y the surface yields by u_p = −g.

Without adhesion the lower bound is zero. The contact then lies inside the set {h < δ}, because
K p > 0 under every positive pressure. So solving on the bounding box of this set is exact. With
adhesion the lower bound at the nodes held in contact is negative (a tension). The box then also
contains these nodes and a margin of two cells.

In a periodic contact, the mean of K p is zero, so K p < 0 somewhere. Nodes with h ≥ δ can therefore
come into contact, and the box is the whole grid. The mean of the gradient, mean(h) − δ, is the mean
of the deformed gap. At δ = mean(h) this mean is zero, so an elastic contact has no open gap left.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restitution.contact.contact import Contact, whole_grid
from restitution.contact.influence import half_space, inverse_half_space, periodic_half_space
from restitution.contact.jkr.detachment import Mask
from restitution.contact.state import Array, State
from restitution.errors import DomainError, NotConvergedError
from restitution.numerics.box import NOWHERE, Box, bounding_box, shape_of, widen
from restitution.numerics.convolution.device import current
from restitution.numerics.convolution.operators import Convolution, SpectralFilter
from restitution.numerics.quadratic.minimise import (
    BoundedQuadratic,
    Minimum,
    minimise_quadratic,
)
from restitution.numerics.quadratic.multilevel import Operators, solve_multilevel
from restitution.numerics.quadratic.near_guess import solve_near_guess
from restitution.numerics.read_only import freeze

# Default tolerance on the violation of the contact conditions, relative to the largest overlap of
# the undeformed surfaces.
RESIDUAL = 1e-8
MAX_ITERATIONS = 1000  # iterations after which a solve counts as not converged


@dataclass(frozen=True)
class HeldNodes:
    """Nodes that are held in contact and can carry tension.

    `mask` marks the nodes, `tension` (Pa) is the largest tension allowed, and `first_guess` (Pa;
    None means zero) is the initial pressure. `mask` and `first_guess` cover the box, that is, the
    rectangular part of the grid on which the contact is solved.
    """

    mask: Mask
    tension: float
    first_guess: Array | None = None


@dataclass(frozen=True)
class Solution:
    """Result of a solve on a box; the arrays have the shape of the box.

    `overlap` is the overlap (m) of the surfaces before elastic deformation (see `_overlap`), `gap`
    the gap (m) after deformation and `pressure` the pressure (Pa). `residual` is the residual that
    the solve reached (dimensionless), and `convolutions` the number of convolutions that it took.
    """

    overlap: Array
    pressure: Array
    gap: Array
    residual: float
    convolutions: int


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
    """Solve for a pressure of at most `limit`, with the plastic displacement of `history`.

    `limit` (Pa) is a number or an array of the shape of the grid. `held` are the nodes that
    adhesion holds in contact; None without adhesion. The lower bound of the pressure is
    −`held.tension` at these nodes, and 0 at all others. `box`, the part of the grid that is solved,
    must contain the `candidate_box` and all held nodes.

    `residual` is the tolerance on the violation of the contact conditions. Without adhesion it is
    relative to the largest overlap before deformation, with adhesion to `Contact.residual_length`.
    Contact at the grid edge is not checked here. Raises `NotConvergedError`. Raises `DomainError`
    if a periodic contact of elastic bodies is complete (has no gap left) at `indentation`.
    """
    device, shape = current(), shape_of(box)
    b = _overlap(contact, indentation, box, history)
    if contact.periodic and limit == math.inf and b.mean() >= 0:
        raise DomainError(
            f"indentation: the contact is complete at {1e9 * (indentation - b.mean()):.6g} nm and "
            "at larger indentations (no gap is left); use a smaller indentation, or prescribe the "
            "pressure"
        )
    scale = _scale_of(contact, indentation, b)
    operators = operators_of(contact)
    upper = device.put(np.ascontiguousarray(limit[box])) if isinstance(limit, np.ndarray) else limit
    if held is None:
        found, convolutions = solve_multilevel(
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
        found = minimise_quadratic(
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
            accept_estimated_gradient=contact.detachment == "crack-closure",
        )
        convolutions = K.count
    require_converged(
        found,
        f"the solve at an indentation of {1e9 * indentation:.6g} nm",
        residual,
        found.residual / scale,
    )
    solution = Solution(
        b,
        device.get(found.point),
        device.get(found.gradient),
        found.residual / scale,
        convolutions,
    )
    return build_state(contact, indentation, box, solution, limit=limit, history=history)


def require_converged(found: Minimum, solve: str, residual: float, reached: float) -> None:
    """Raise `NotConvergedError` if the solve that returned `found` did not converge.

    For the message, `solve` names this solve, `residual` is its tolerance, and `reached` is its
    last residual.
    """
    if not found.converged:
        raise NotConvergedError(
            f"{solve} stopped at a residual of {reached:.1e} (tolerance: {residual:.0e}) "
            f"after {found.iterations} iterations; use another grid spacing or a smoother surface "
            "(in Python, the argument residual sets the tolerance)"
        )


def elastic_pressure(
    contact: Contact, indentation: float, residual: float
) -> tuple[Array, Box, int]:
    """Estimate the pressure (Pa) between elastic bodies without adhesion.

    `residual` bounds the root mean square of the violation of the contact conditions, relative to
    the largest overlap. The pressure is given on a box and is zero outside. Isolated contact
    patches of a few nodes can be missing, because `solve_near_guess` does not check all nodes.
    Returns the pressure, the box and the number of convolutions. Raises `NotConvergedError`.
    """
    box = candidate_box(contact, indentation)
    if box is None:
        return np.zeros((0, 0)), NOWHERE, 0
    device = current()
    b = _overlap(contact, indentation, box)
    scale = _scale_of(contact, indentation, b)
    found, window, convolutions = solve_near_guess(
        operators_of(contact),
        device.put(b),
        tolerance=residual * scale,
        max_iterations=MAX_ITERATIONS,
    )
    require_converged(
        found,
        f"the solve at an indentation of {1e9 * indentation:.6g} nm",
        residual,
        found.residual / scale,
    )
    rows, columns = (
        slice(side.start + part.start, side.start + part.stop)
        for side, part in zip(box, window, strict=True)
    )
    return device.get(found.point), (rows, columns), convolutions


def _overlap(contact: Contact, indentation: float, box: Box, history: State | None = None) -> Array:
    """Overlap (m) of the surfaces on `box` before elastic deformation: indentation minus gap.

    If `history` is given, its plastic displacement is subtracted, too.
    """
    b: Array = indentation - contact.gap[box]
    if history is not None:
        b -= history.plastic_displacement[box]
    return b


def _scale_of(contact: Contact, indentation: float, b: Array) -> float:
    """Length (m) by which residuals are divided; `b` is the overlap before deformation."""
    return contact.residual_length(indentation) if contact.adhesive else float(b.max())


def operators_of(contact: Contact, make: Callable[..., Convolution] | None = None) -> Operators:
    """Return a function that makes two operators for a grid level: K and its approximate inverse.

    The elastic operator K gives the displacement due to a pressure. `make` makes K, by default for
    the free or periodic half-space.
    """
    E_star, (hx, hy) = contact.pair.contact_modulus, contact.grid.spacing
    make = make or (periodic_half_space if contact.periodic else half_space)

    def operators(shape: tuple[int, int], level: int) -> tuple[Convolution, SpectralFilter]:
        cells = 2**level * hx, 2**level * hy
        return make(shape, cells, E_star), inverse_half_space(shape, cells, E_star)

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
    """Build the state of a `solution` on `box`.

    Where the pressure is at the limit, a negative deformed gap becomes plastic displacement. The
    elastic displacement overwrites `solution.gap`. If `limit` is a number, the plastic work of this
    step is added to that of `history`. If `limit` is an array, the module `loading` adds it later.
    """
    pressure, gap = solution.pressure, solution.gap
    plastic, work, adhesive_work, work_error = _past(contact, history)
    upper = limit[box] if isinstance(limit, np.ndarray) else limit
    yielding = (pressure >= upper) & (gap < 0)
    if yielding.any():
        if history is not None:
            plastic = plastic.copy()
        lowered = plastic[box]
        np.subtract(lowered, gap, out=lowered, where=yielding)
        if not isinstance(limit, np.ndarray):
            work -= limit * float(np.sum(gap, where=yielding)) * contact.grid.cell_area
    displacement = np.add(gap, solution.overlap, out=gap)
    return State(
        contact,
        indentation,
        box,
        freeze(pressure),
        freeze(displacement),
        freeze(plastic),
        limit,
        work,
        adhesive_work,
        work_error,
        solution.residual,
        solution.convolutions,
    )


def candidate_box(contact: Contact, indentation: float, history: State | None = None) -> Box | None:
    """Return the bounding box of the nodes with a gap below `indentation`; None without such nodes.

    Without adhesion, the box contains all nodes that can come into contact. For a periodic contact,
    it is the whole grid.
    """
    whole = region = whole_grid(contact)
    gap = contact.gap
    if history is not None:
        if indentation <= history.indentation and not contact.periodic:
            # On unloading, no new contact arises outside the box of `history`.
            region = widen(history.box, 2, contact.grid.nodes)
        gap = gap[region] + history.plastic_displacement[region]
    below = gap < indentation
    if contact.periodic:
        return whole if below.any() else None
    return bounding_box(below, region)


def separated_state(contact: Contact, indentation: float, history: State | None = None) -> State:
    """Build the state of bodies out of contact."""
    nothing = np.zeros((0, 0))
    plastic, work, adhesive_work, work_error = _past(contact, history)
    bound = contact.first_yield_pressure if history is None else history.bound
    return State(
        contact,
        indentation,
        NOWHERE,
        nothing,
        nothing,
        freeze(plastic),
        bound,
        work,
        adhesive_work,
        work_error,
        residual=0.0,
        convolutions=0,
    )


def _past(contact: Contact, history: State | None) -> tuple[Array, float, float, float]:
    """Plastic displacement, plastic work, adhesive work and work error of `history`, or zeros."""
    if history is None:
        return np.zeros(contact.grid.nodes), 0.0, 0.0, 0.0
    return (
        history.plastic_displacement,
        history.plastic_work,
        history.adhesive_work,
        history.work_error,
    )
