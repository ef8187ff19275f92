"""Minimising from nothing: a first guess from coarser grids, then a window around it.

The problem is that of `minimise` with lower = 0 on a uniform grid. Averaged over 2 × 2 nodes it is
the same problem on half as many nodes each way, whose solution is a first guess for all but the
shortest waves (nested iteration; Venner and Lubrecht 2000, *Multilevel Methods in Lubrication*).
The guess also shows where the pressure is and where it is missing: the fine problem is solved on
that window, and the conditions are checked on all nodes, where they may widen it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeGuard

import numpy as np
from numpy.typing import NDArray

from restitution.numerics import passes
from restitution.numerics.convolution import FreeConvolution, SpectralFilter
from restitution.numerics.minimise import Minimum, Operator, minimise_quadratic, violation
from restitution.numerics.passes import Bound
from restitution.numerics.window import Box, bounding_box, shape_of, union, widen

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

# The operator and its approximate inverse on a block of so many nodes 2ⁿ as wide as the finest.
System = Callable[[tuple[int, int], int], tuple[FreeConvolution, SpectralFilter]]

# Nodes along the shorter edge below which a guess costs more than it saves, and one for a guess.
_WORTH_A_GUESS, _COARSEST = 120, 80
_COARSE_ACCURACY = 1e-2  # of the largest b; finer is lost in going to the finer grid
_COARSE_ITERATIONS = 60
_MARGIN = 3  # nodes around the guess
_WORTH_A_WINDOW = 0.7  # of all nodes: checking a larger window would cost more than it saves
_PLACES = 8  # along each axis
# Of what touches, what may be between the bounds where all the rest yields; and the part of the
# pressure that would close a gap at one node alone (0.15 to 0.5 are nearly as good).
_NEARLY_NONE, _OF_THE_GAP = 0.05, 0.3
# K after its inverse, on a part of the nodes: as good as ever; and what is left of a mean at most.
_USUAL, _WORTH_LESS = 3.5, 0.7


def minimise_nested(
    system: System,
    b: Array,
    upper: Bound,
    *,
    tolerance: float,
    max_iterations: int,
) -> tuple[Minimum, int]:
    """Minimise with 0 ≤ p ≤ `upper`; the result and the products with K on the finest grid."""
    everywhere: Box = (slice(0, b.shape[0]), slice(0, b.shape[1]))
    size = shape_of(everywhere)
    p, Kp, products = np.zeros_like(b), None, 0
    whole, its_inverse = system(size, 0)  # first: smaller blocks have the same coefficients
    if min(size) >= _WORTH_A_GUESS:
        p = _first_guess(system, b, upper, level=1)
    window = bounding_box(p > 0)
    if window is not None and _saves(window, size):
        # The coarser grids do not see all that touches: what the guess leaves closed may, too.
        Kp = whole.quick(p)
        window = bounding_box((p > 0) | (Kp < b))
    window = everywhere if window is None else widen(window, _MARGIN, size)
    while True:
        if not _saves(window, size):
            window = everywhere
        K, inverse = whole, its_inverse
        if window != everywhere:
            K, inverse = system(shape_of(window), 0)
        bound = upper[window] if _is_array(upper) else upper
        found = minimise_quadratic(
            K,
            b[window],
            0.0,
            bound,
            start=p[window],
            product=None if Kp is None else Kp[window],
            precondition=_with_less_mean(inverse, p[window], b[window], bound),
            quick=K.quick,
            rough=window != everywhere,  # the check will see
            tolerance=tolerance,
            max_iterations=max_iterations,
        )
        if window == everywhere:
            return found, products + whole.count
        products += K.count
        iterations, converged = found.iterations, found.converged
        del K, inverse, found  # their arrays make room for those of the check
        g = whole(p, out=Kp)
        residual = violation(p, g, b, 0.0, upper)
        if residual <= tolerance or not converged:
            checked = Minimum(p, g, residual, iterations, residual <= tolerance)
            return checked, products + whole.count
        wider = union(window, bounding_box(g < -tolerance))
        Kp = np.add(g, b, out=g)
        # The same window again: what the last digits of the check leave, all nodes mend.
        window = everywhere if wider is None or wider == window else widen(wider, _MARGIN, size)


def _with_less_mean(inverse: Operator, p: Array, b: Array, upper: Bound) -> Operator:
    """`inverse` on the free nodes, with less of what an array is in the mean there.

    A constant on a part of the nodes ends in steps. The inverse of a smoothing operator weighs the
    short waves of a step, the more the finer the grid (McLean and Steinbach 1999, Adv. Comput.
    Math. 11, 271–286), and makes too much of the constant: up to 30 times on rough contacts, far
    more than of all else, and conjugate gradients would have to mend it anew whenever nodes change
    sides. How much too much, the guess `p` tells, for on its nodes K makes `b` of it. Means around
    8 × 8 places stand for what is nearly constant.
    """
    free, nodes, touching = _between_the_bounds(p, upper)
    if nodes <= 0.5 * touching:  # no guess, or where most yields: edges
        return inverse
    constant: Any = free.astype(np.float32)
    made = inverse(constant, out=np.empty_like(constant))
    flexible = passes.dot(b, constant) / float(p.sum())
    stiff = passes.dot(made, constant) / touching
    kept = _USUAL / max(flexible * stiff, _USUAL)
    if kept > _WORTH_LESS:
        return inverse

    def less(r: Array, out: Array | None = None) -> Array:
        lowered = np.empty_like(r) if out is None else out
        sums, nodes = np.empty_like(b, shape=(2, _PLACES, _PLACES))
        passes.levels(r, sums, nodes)
        passes.lower(r, 1.0 - kept, sums, nodes, lowered)
        return inverse(lowered, out=lowered)

    return less


def _is_array(bound: Bound) -> TypeGuard[Array]:
    """Whether each node has a bound of its own."""
    return np.ndim(bound) > 0


def _between_the_bounds(p: Array, upper: Bound) -> tuple[Mask, int, int]:
    """The nodes with 0 < p < `upper`; how many they are, and how many with 0 < p."""
    touching = p > 0
    free = touching & (p < upper)
    return free, int(np.count_nonzero(free)), int(np.count_nonzero(touching))


def _saves(window: Box, size: tuple[int, int]) -> bool:
    """Whether a window on arrays of that size is small enough to be worth its check."""
    rows, columns = shape_of(window)
    return rows * columns <= _WORTH_A_WINDOW * size[0] * size[1]


def _first_guess(system: System, b: Array, upper: Bound, level: int) -> Array:
    """The solution on the next coarser grid, itself begun on one coarser; zero on the coarsest."""
    if min(b.shape) < _COARSEST:
        return np.zeros_like(b)
    rows, columns = b.shape
    size = (rows + 1) // 2, (columns + 1) // 2
    coarse = np.empty_like(b, shape=size, order="C")
    passes.coarsen(b, coarse)
    bound = upper
    if _is_array(upper):
        bound = np.empty_like(coarse)
        passes.coarsen(upper, bound)
    K, inverse = system(size, level)
    start = _first_guess(system, coarse, bound, level + 1)
    found = minimise_quadratic(
        K,
        coarse,
        0.0,
        bound,
        start=start,
        precondition=_with_less_mean(inverse, start, coarse, bound),
        quick=K.quick,
        rough=True,
        tolerance=_COARSE_ACCURACY * max(float(b.max()), 0.0),
        max_iterations=_COARSE_ITERATIONS,
    )
    guess = np.empty_like(b, order="C")
    _, free, touching = _between_the_bounds(found.point, bound)
    if free > _NEARLY_NONE * touching:
        passes.refine(found.point, guess)
        return guess
    # Where nearly all that touches yields, pressure ends in a jump somewhere between two nodes. By
    # how much one of them gives way, and the other gapes, tells where.
    passes.refine(found.point - _OF_THE_GAP / K.own * found.gradient, guess)
    return np.clip(guess, 0.0, upper, out=guess)
