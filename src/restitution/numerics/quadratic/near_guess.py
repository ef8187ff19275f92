"""Approximate minimisation without upper bound, on a window around a guess from coarser grids.

This module solves the problem of `multilevel` for elastic contacts, which have no upper bound. The
coarser grid uses means over 2 × 2 nodes, and these means hide the roughness between the nodes. So
on a rough surface, far too many nodes of the coarser grid are in contact. But the mean pressure on
the coarser grid is nearly right. Therefore the guess from the coarser grid is corrected in three
steps. Short waves of the pressure are added. Negative pressures are set to zero. The positive
pressures are lowered until their local means are nearly the same as on the coarser grid.

During the iterations, the preconditioner keeps the local means nearly constant. It is based on an
approximate inverse of K. On separate contact patches, this inverse alone would convert short waves
of the residual to a change of the mean pressure. Later iterations would have to undo this change.
So the local means are damped twice: before the approximate inverse is applied (see
`multilevel.mean_damped_preconditioner`) and after it.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from restitution.numerics.box import Box, bounding_box, shape_of, widen
from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.quadratic.fused_ops import as_rows, projected_gradient
from restitution.numerics.quadratic.grid_transfer import prolong
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
    coarsened,
    may_coarsen,
    mean_damping,
)

_COARSE_ACCURACY = 1e-3  # tolerance on coarser grids, as a fraction of the largest b
_PLACES = 12  # number of local means along each axis (see the module `local_mean`)
_PASSES = 4  # Newton steps that restore the local means of the guess


def solve_near_guess(
    operators: Operators, b: Array, *, tolerance: float, max_iterations: int
) -> tuple[Minimum, Box, int]:
    """Minimise ½ pᵀK p − pᵀb with 0 ≤ p approximately, on a window around a guess.

    The arguments are those of `solve_multilevel`, but `tolerance` limits the root mean square of
    the violation. The largest violation often occurs at a few nodes that hardly affect the result.

    The window includes all nodes where the guess has pressure. It also includes all nodes where the
    bodies overlap after the displacement K p of the guess. Nodes outside the window are neither
    solved nor checked. Return the result on the window, the window, and the number of products with
    K on the window.
    """
    size = b.shape[0], b.shape[1]
    p, displacement, window = np.zeros_like(b), np.zeros_like(b), None
    if min(size) >= MIN_NODES_FOR_GUESS:
        p, displacement = _guess(operators, b, 1)
        window = bounding_box((p > 0) | (displacement < b))
    whole_grid = slice(0, size[0]), slice(0, size[1])
    window = whole_grid if window is None else widen(window, MARGIN, size)
    K, inverse = operators(shape_of(window), 0)
    found = _solve_from(
        p[window],
        displacement[window],
        (K, inverse),
        b[window],
        tolerance=tolerance,
        max_iterations=max_iterations,
    )
    return found, window, K.count


def _guess(operators: Operators, b: Array, level: int) -> tuple[Array, Array]:
    """Solve on the grid of `level`; return p and K p prolonged to the next finer grid."""
    if not may_coarsen(b.shape, periodic=False):
        return np.zeros_like(b), np.zeros_like(b)
    coarse = coarsened(b)
    found = _solve_from(
        *_guess(operators, coarse, level + 1),
        operators((coarse.shape[0], coarse.shape[1]), level),
        coarse,
        tolerance=_COARSE_ACCURACY * max(float(b.max()), 0.0),
        max_iterations=COARSE_ITERATIONS,
    )
    p, displacement = np.empty_like(b, order="C"), np.empty_like(b, order="C")
    prolong(found.point, p)
    prolong(np.add(found.gradient, coarse, out=coarse), displacement)
    return p, displacement


def _solve_from(
    guess: Array,
    displacement: Array,
    operators: tuple[Convolution, Operator],
    b: Array,
    *,
    tolerance: float,
    max_iterations: int,
) -> Minimum:
    """Minimise from the `guess` of p and its `displacement` K p, both from the coarser grid."""
    K, inverse = operators
    start = add_short_waves(guess, displacement, inverse, b) if guess.any() else guess
    return minimise_quadratic(
        BoundedQuadratic(K, b, 0.0, math.inf, K.single_precision),
        start=start,
        precondition=balanced_preconditioner(inverse, start, b),
        tolerance=tolerance,
        max_iterations=max_iterations,
        accept_estimated_gradient=True,
        mean_violation=True,
    )


def add_short_waves(guess: Array, displacement: Array, inverse: Operator, b: Array) -> Array:
    """Add the pressure −`inverse` r to the guess p, where r is the projected gradient.

    r is K p − b on free nodes and zero elsewhere. The result has no negative pressure, is zero
    where r = 0, and has nearly the same local means as the guess. `displacement` is K p from the
    coarser grid, so it lacks only short waves. It is overwritten.
    """
    p: Any = guess.astype(np.float32)
    free, change = np.empty_like(p), np.empty_like(p)
    projected_gradient(guess, displacement, b, as_rows(0.0, math.inf, guess), free)
    wanted, sums, nodes = np.empty_like(b, shape=(3, _PLACES, _PLACES))
    local_sums(p, wanted, nodes)
    p -= inverse(free, out=change)
    p *= free != 0
    for _ in range(_PASSES):
        np.maximum(p, 0.0, out=p)
        local_sums(p, sums, nodes)
        subtract_local_mean(p, 1.0, sums - wanted, nodes, p)
    return np.maximum(p, 0.0, dtype=np.float64)  # type: ignore[no-any-return]


def balanced_preconditioner(inverse: Operator, p: Array, b: Array) -> Operator:
    """Return an operator that damps local means, applies `inverse`, and damps local means again.

    Each damping multiplies the local means by the square root of the factor of
    `multilevel.mean_damped_preconditioner`. So both together damp by the whole factor.
    """
    share = 1.0 - math.sqrt(mean_damping(inverse, p, b, math.inf))
    if share == 0.0:
        return inverse

    def balanced(r: Array, out: Array | None = None) -> Array:
        result = np.empty_like(r) if out is None else out
        damp_local_mean(r, share, _PLACES, result)
        inverse(result, out=result)
        result *= r != 0
        damp_local_mean(result, share, _PLACES, result)
        return result

    return balanced
