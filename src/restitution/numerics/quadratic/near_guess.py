"""Approximate minimisation without upper bound, on a window around a guess from coarser grids.

Means over 2 × 2 nodes hide the roughness between the nodes, so far too many nodes of a coarser grid
are in contact, but the mean pressure is nearly right. The guess gets short waves and keeps its
local means; the preconditioner then keeps them nearly constant, which on separate patches the
approximate inverse alone would not. So an inverse for short waves is enough.
"""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np

from restitution.numerics.box import Box, bounding_box, shape_of, widen
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.quadratic.fused_ops import as_rows, projected_gradient
from restitution.numerics.quadratic.grid_transfer import Fields, nested, prolonged
from restitution.numerics.quadratic.local_mean import (
    damp_local_mean,
    local_sums,
    subtract_local_mean,
)
from restitution.numerics.quadratic.minimise import (
    Array,
    BoundedQuadratic,
    Minimum,
    Operator,
    minimise_quadratic,
)
from restitution.numerics.quadratic.multilevel import (
    COARSE_ITERATIONS,
    MARGIN,
    MIN_NODES_FOR_GUESS,
    Operators,
    mean_damping,
)

Guess = tuple[Array, Array]  # p and K p

_COARSE_ACCURACY = 1e-3  # tolerance on coarser grids, as a fraction of the largest b
_SINGLE = 1e-5  # smallest tolerance, as a fraction of the largest b, for single precision
_PLACES = 12  # number of local means along each axis (see the module `local_mean`)
_PASSES = 3  # Newton steps that restore the local means of the guess
# Length of the last step, as a multiple of the preconditioned gradient. Any length from 0.3 to 0.8
# halves the error of the result, as another iteration would, but without a product with K.
_LAST_STEP = 0.6


def solve_near_guess(
    operators: Operators,
    near: Operators,
    b: Array,
    *,
    tolerance: float,
    max_iterations: int,
) -> tuple[Minimum, Box, int]:
    """Minimise ½ pᵀK p − pᵀb with 0 ≤ p approximately, on a window around a guess.

    The arguments are those of `solve_multilevel`, but the inverse of `near`, which is used from a
    guess, needs to be good only for short waves, and `tolerance` limits the root mean square of
    the violation: the largest violation often occurs at a few nodes that hardly affect the result.
    Nodes outside the window are neither solved nor checked; it includes all nodes where the guess
    has pressure or leaves an overlap. A last step without a product with K makes the point more
    accurate than `gradient` and `residual` say. Return the result on the window, the window, and
    the number of products with K on the window.
    """
    if tolerance >= _SINGLE * float(b.max()):
        b = b.astype(np.float32)
    guess = _guess(operators, near, b) if min(b.shape) >= MIN_NODES_FOR_GUESS else None
    to = operators if guess is None else near
    return _solve_around(guess, to, b, 0, tolerance=tolerance, max_iterations=max_iterations)


def _guess(operators: Operators, near: Operators, b: Array) -> Guess | None:
    """Return p and K p of the next coarser grid, prolonged."""

    def refine(coarse: Fields, start: Guess | None, fine: Fields, level: int) -> Guess:
        (b,), (finer,) = cast(tuple[Array], coarse), cast(tuple[Array], fine)
        minimum, window, _ = _solve_around(
            start,
            operators if start is None else near,
            b,
            level,
            tolerance=_COARSE_ACCURACY * max(float(finer.max()), 0.0),
            max_iterations=COARSE_ITERATIONS,
        )
        p, displacement = start or np.empty_like(b, shape=(2, *b.shape))
        p[window] = minimum.point
        np.add(minimum.gradient, b[window], out=displacement[window])
        return prolonged(p, finer), prolonged(displacement, finer)

    return nested(refine, (b,))


def _solve_around(
    guess: Guess | None,
    operators: Operators,
    b: Array,
    level: int,
    *,
    tolerance: float,
    max_iterations: int,
) -> tuple[Minimum, Box, int]:
    """Solve on the window of the `guess`, p and K p from the coarser grid."""
    size = b.shape[0], b.shape[1]
    window: Box = (slice(0, size[0]), slice(0, size[1]))
    start = None
    if guess is not None:
        p, displacement = guess
        inside = bounding_box((p > 0) | (displacement < b))
        window = window if inside is None else widen(inside, MARGIN, size)
        start = p[window], displacement[window].copy()
    K, inverse = operators(shape_of(window), level)
    minimum = _solve_from(
        start, (K, inverse), b[window], tolerance=tolerance, max_iterations=max_iterations
    )
    return minimum, window, K.count


def _solve_from(
    guess: Guess | None,
    operators: tuple[Convolution, Operator],
    b: Array,
    *,
    tolerance: float,
    max_iterations: int,
) -> Minimum:
    """Minimise from the `guess` of p and K p, both from the coarser grid."""
    K, inverse = operators
    start = np.zeros_like(b) if guess is None else add_short_waves(*guess, inverse, b)
    precondition = balanced_preconditioner(inverse, start, b)
    balanced = precondition is not inverse
    minimum = minimise_quadratic(
        BoundedQuadratic(K, b, 0.0, math.inf, K.without_mean if balanced else K.single_precision),
        start=start,
        K_start=K.single_precision(start, out=np.empty_like(start)) if balanced else None,
        precondition=precondition,
        tolerance=tolerance,
        max_iterations=max_iterations,
        accept_estimated_gradient=True,
        mean_violation=True,
    )
    p, g = minimum.point, minimum.gradient
    r: Any = np.empty_like(p, dtype=np.float32)
    bounds: Any = as_rows(0.0, math.inf, p)
    projected_gradient(p, g, bounds[0], bounds, r)  # subtracts 0
    step = precondition(r, out=np.empty_like(r))
    step *= r != 0
    step *= -_LAST_STEP
    np.maximum(np.add(p, step, out=p), 0.0, out=p)
    return minimum


def add_short_waves(guess: Array, displacement: Array, inverse: Operator, b: Array) -> Array:
    """Add −`inverse` r to the guess, with the projected gradient r; keep its local means nearly.

    The result has no negative pressure and is zero where r = 0. `displacement` is K p from the
    coarser grid, so it lacks only short waves. It is overwritten.
    """
    if not guess.any():
        return guess
    p: Any = guess.astype(np.float32)
    free, change = np.empty_like(p), np.empty_like(p)
    projected_gradient(guess, displacement, b, as_rows(0.0, math.inf, guess), free)
    target, sums, nodes = np.empty_like(b, dtype=np.float64, shape=(3, _PLACES, _PLACES))
    local_sums(p, p, target, nodes)
    p -= inverse(free, out=change)
    p *= free != 0
    for _ in range(_PASSES):
        np.maximum(p, 0.0, out=p)
        local_sums(p, p, sums, nodes)
        subtract_local_mean(p, p, 1.0, sums - target, nodes, p)
    return np.maximum(p, 0.0, dtype=guess.dtype)  # type: ignore[no-any-return]


def balanced_preconditioner(inverse: Operator, p: Array, b: Array) -> Operator:
    """Return an operator that damps local means before and after it applies `inverse`.

    Both together damp by the factor of `multilevel.mean_damped_preconditioner`.
    """
    share = 1.0 - math.sqrt(mean_damping(inverse, p, b, math.inf))
    if share == 0.0:
        return inverse

    damped: Any = np.empty_like(p, dtype=np.float32)

    def balanced(r: Array, out: Array | None = None) -> Array:
        result = np.empty_like(r) if out is None else out
        damp_local_mean(r, share, _PLACES, damped)
        inverse(damped, out=result)
        damp_local_mean(result, share, _PLACES, result, mask=r)
        return result

    return balanced
