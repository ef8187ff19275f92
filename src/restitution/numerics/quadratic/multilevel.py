"""Minimisation within bounds from a guess on coarser grids, on a window of the finest grid.

The problem is that of `minimise` with the lower bound 0. The guess shows where the pressure is
nonzero, so the fine problem is solved on a window around this region. The optimality conditions are
then checked on all nodes; nodes outside the window that violate them widen it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeGuard, cast

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.box import Box, bounding_box, shape_of, union, widen
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.expressions import dot
from restitution.numerics.quadratic.fused_ops import Bound
from restitution.numerics.quadratic.grid_transfer import Fields, nested, prolonged
from restitution.numerics.quadratic.local_mean import damp_local_mean
from restitution.numerics.quadratic.minimise import (
    Array,
    BoundedQuadratic,
    Minimum,
    Operator,
    minimise_quadratic,
    violation,
)

Mask = NDArray[np.bool_]

# Function that builds the operator and its approximate inverse for a shape (nodes) and a level n.
# At level n the spacing is 2ⁿ times the spacing of the finest grid.
Operators = Callable[[tuple[int, int], int], tuple[Convolution, Operator]]

# The finest grid is solved from a guess on coarser grids if its shorter edge has at least this
# number of nodes. On smaller grids the guess costs more time than it saves.
MIN_NODES_FOR_GUESS = 120
# Tolerance on coarser grids, as a fraction of the largest b. A smaller tolerance gains nothing,
# because prolongation errors are larger.
_COARSE_ACCURACY = 1e-2
COARSE_ITERATIONS = 60  # largest number of iterations on a coarser grid
MARGIN = 3  # number of nodes that the window has on each side of the guessed contact

# Largest window, as a fraction of all nodes. The solve on a larger window and the check of all
# nodes together take longer than a solve on the whole grid.
_MAX_WINDOW_FRACTION = 0.7
_PLACES = 8  # number of local means along each axis (see the module `local_mean`)

# A contact counts as nearly fully plastic if at most the fraction _MAX_FREE_FRACTION of the contact
# nodes is strictly between the bounds. The contact edge of the guess is then corrected: each
# pressure changes by _GAP_FRACTION times −g/K₀₀. Here g is the gradient at the node and K₀₀ the
# diagonal of K. The full change −g/K₀₀ at one node alone would make g zero there. Any _GAP_FRACTION
# from 0.15 to 0.5 works nearly as well.
_MAX_FREE_FRACTION, _GAP_FRACTION = 0.05, 0.3
# The preconditioner multiplies the local means of the residual (see the module `local_mean`) by the
# factor _USUAL_STIFFNESS/q. Here q is an estimate of the Rayleigh quotient of K·M, where M is the
# approximate inverse of K. The vector of this quotient is constant on the free nodes (those
# strictly between the bounds) and zero elsewhere. If the factor is above _MAX_DAMPING_FACTOR, the
# local means are left unchanged, because damping would save no time.
_USUAL_STIFFNESS, _MAX_DAMPING_FACTOR = 3.5, 0.7


def solve_multilevel(
    operators: Operators,
    b: Array,
    upper: Bound,
    *,
    tolerance: float,
    max_iterations: int,
    periodic: bool = False,
) -> tuple[Minimum, int]:
    """Minimise ½ pᵀK p − pᵀb with 0 ≤ p ≤ `upper`; also return the products with K.

    `operators` builds K and its approximate inverse. `b` has shape (nx, ny); `upper` is a number or
    an array of this shape. `tolerance` limits the violation of the optimality conditions, in the
    units of `b`. With `periodic` operators, the fine problem is solved on the whole grid, only
    grids of even size are coarsened, and the approximate inverse, which is nearly exact, is used
    without damping. The count is of products on the finest grid. If the solve does not converge,
    `converged` of the result is False.
    """
    whole_grid: Box = (slice(0, b.shape[0]), slice(0, b.shape[1]))
    size = shape_of(whole_grid)
    p, Kp, products = np.zeros_like(b), None, 0
    # The operator of the whole grid is built first, because smaller windows reuse its coefficients.
    whole_K, whole_inverse = operators(size, 0)
    if min(size) >= MIN_NODES_FOR_GUESS:
        p = _first_guess(operators, b, upper, periodic)
    window = None if periodic else bounding_box(p > 0)
    if window is not None and _is_worth_its_check(window, size):
        # Coarse grids miss some contact. Therefore the window also includes the nodes where the
        # guess has no pressure but the bodies overlap.
        Kp = whole_K.single_precision(p)
        window = bounding_box((p > 0) | (Kp < b))
    window = whole_grid if window is None else widen(window, MARGIN, size)
    while True:
        if not _is_worth_its_check(window, size):
            window = whole_grid
        whole = window == whole_grid
        K, inverse = (whole_K, whole_inverse) if whole else operators(shape_of(window), 0)
        bound = upper[window] if _is_array(upper) else upper
        minimum = minimise_quadratic(
            BoundedQuadratic.of(K, b[window], 0.0, bound),
            start=p[window],
            precondition=_preconditioner(inverse, p[window], b[window], bound, periodic),
            tolerance=tolerance,
            max_iterations=max_iterations,
            K_start=None if Kp is None else Kp[window],
            # On a window, an estimated gradient is enough, because the later check of all nodes
            # computes the gradient in double precision.
            accept_estimated_gradient=not whole,
        )
        if whole:
            return minimum, products + whole_K.count
        products += K.count
        iterations, converged = minimum.iterations, minimum.converged
        del K, inverse, minimum  # free the arrays of the window before the check allocates more
        g = whole_K(p, out=Kp)
        residual = violation(p, g, b, 0.0, upper)
        if residual <= tolerance or not converged:
            return (
                Minimum(p, g, residual, iterations, residual <= tolerance),
                products + whole_K.count,
            )
        wider = union(window, bounding_box(g < -tolerance))
        Kp = np.add(g, b, out=g)
        # If the window would not grow, the violation is due to rounding errors. The problem is then
        # solved on the whole grid.
        window = whole_grid if wider is None or wider == window else widen(wider, MARGIN, size)


def mean_damped_preconditioner(inverse: Operator, p: Array, b: Array, upper: Bound) -> Operator:
    """Return an operator that damps the local means of its argument and then applies `inverse`.

    The inverse of a smoothing operator amplifies the short waves at the edge of a residual that is
    constant on the contact nodes (McLean and Steinbach 1999, Adv. Comput. Math. 11, 271–286), by a
    factor of up to 30 on rough contacts. The damping follows from the guess `p`, for which K p = b
    on the free nodes.
    """
    factor = mean_damping(inverse, p, b, upper)
    if factor == 1.0:
        return inverse

    def damped(r: Array, out: Array | None = None) -> Array:
        result = np.empty_like(r) if out is None else out
        damp_local_mean(r, 1.0 - factor, _PLACES, result)
        return inverse(result, out=result)

    return damped


def mean_damping(inverse: Operator, p: Array, b: Array, upper: Bound) -> float:
    """Factor of `mean_damped_preconditioner`, or 1 if no damping is needed."""
    free, free_nodes, contact_nodes = _between_the_bounds(p, upper)
    # Without an initial guess (p = 0), or if at least half of the contact nodes yield, nothing is
    # damped.
    if free_nodes <= 0.5 * contact_nodes:
        return 1.0
    constant: Any = free.astype(np.float32)
    image = inverse(constant, out=np.empty_like(constant))
    stiffness = dot(b, constant) / float(p.sum()) * (dot(image, constant) / contact_nodes)
    factor = _USUAL_STIFFNESS / max(stiffness, _USUAL_STIFFNESS)
    return factor if factor <= _MAX_DAMPING_FACTOR else 1.0


def _is_array(bound: Bound) -> TypeGuard[Array]:
    return np.ndim(bound) > 0


def _between_the_bounds(p: Array, upper: Bound) -> tuple[Mask, int, int]:
    """Mask of nodes with 0 < p < `upper`, their number, and the number with p > 0."""
    touching = p > 0
    free = touching & (p < upper)
    return free, int(np.count_nonzero(free)), int(np.count_nonzero(touching))


def _is_worth_its_check(window: Box, size: tuple[int, int]) -> bool:
    """Whether solving on `window` and then checking all nodes is faster than solving on all."""
    rows, columns = shape_of(window)
    return rows * columns <= _MAX_WINDOW_FRACTION * size[0] * size[1]


def _preconditioner(
    inverse: Operator, p: Array, b: Array, upper: Bound, periodic: bool
) -> Operator:
    return inverse if periodic else mean_damped_preconditioner(inverse, p, b, upper)


def _first_guess(operators: Operators, b: Array, upper: Bound, periodic: bool = False) -> Array:
    """Solution on the next coarser grid, prolonged; zero if the grid is not coarsened."""

    def refine(coarse: Fields, start: Array | None, fine: Fields, level: int) -> Array:
        b, upper = cast(tuple[Array, Bound], coarse)
        start = np.zeros_like(b) if start is None else start
        K, inverse = operators((b.shape[0], b.shape[1]), level)
        minimum = minimise_quadratic(
            BoundedQuadratic.of(K, b, 0.0, upper),
            start=start,
            precondition=_preconditioner(inverse, start, b, upper, periodic),
            tolerance=_COARSE_ACCURACY * max(float(np.max(fine[0])), 0.0),
            max_iterations=COARSE_ITERATIONS,
            accept_estimated_gradient=True,
        )
        return _on_finer_grid(minimum, K.diagonal, upper, *cast(tuple[Array, Bound], fine))

    guess = nested(refine, (b, upper), periodic=periodic)
    return np.zeros_like(b) if guess is None else guess


def _on_finer_grid(
    minimum: Minimum, diagonal: float, bound: Bound, b: Array, upper: Bound
) -> Array:
    """Prolong the point of `minimum` (bound `bound`) to the grid of `b`, within 0 and `upper`."""
    _, free_nodes, contact_nodes = _between_the_bounds(minimum.point, bound)
    if free_nodes > _MAX_FREE_FRACTION * contact_nodes:
        guess = prolonged(minimum.point, b)
        # A node can have a smaller bound than the nodes of the coarser grid around it.
        return np.minimum(guess, upper, out=guess) if _is_array(upper) else guess
    # In a nearly fully plastic contact, the pressure jumps from the upper bound at one node to zero
    # at the next. The gradient is minus the plastic displacement at the yielded node, and the gap
    # at the open node. These two lengths show how far the contact edge is from each node.
    guess = prolonged(minimum.point - _GAP_FRACTION / diagonal * minimum.gradient, b)
    return np.clip(guess, 0.0, upper, out=guess)
