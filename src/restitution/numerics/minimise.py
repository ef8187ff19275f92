"""Box-constrained minimisation of a convex quadratic: the one solver of the program.

    minimise  ½ pᵀK p − pᵀb   subject to   lower ≤ p ≤ upper,

K symmetric positive definite and known only through its product. With the gradient g = K p − b the
solution is characterised by (Karush–Kuhn–Tucker)

    g ≥ 0 where p = lower,   g = 0 between the bounds,   g ≤ 0 where p = upper.

The largest violation of these three conditions is the `residual`. What the bounds mean (contact,
yield, adhesion) is the caller's affair.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.numerics import passes
from restitution.numerics.passes import Bound

Array = NDArray[np.float64]

# What rounding does to a product, in units of the last place of its largest value (measured on 64²
# to 4096² nodes: up to 8), and how far above the error of the gradient a violation has to be to be
# followed.
_ROUNDING, _CLEAR = 10.0, 3.0
_NEARLY = 0.8  # of what was projected: where this much is best, all of it is taken
# Trials begin as long as they mostly end up, for bounds cut off much of them. The best step changes
# between long and short; their length follows half-heartedly.
_FIRST, _SHORTER, _LONGER, _DAMPED = 0.3, 0.1, 3.0, 0.5


class Operator(Protocol):
    """A linear map of arrays of one shape."""

    def __call__(self, p: Array, /, out: Array | None = None) -> Array:
        """The map of `p`: in a new array, or in `out`."""


@dataclass(frozen=True)
class Minimum:
    """Where the minimiser stopped: the point, its gradient, and how far both can be trusted.

    `residual` is the violation with the error of the gradient.
    """

    point: Array
    gradient: Array
    residual: float
    iterations: int
    converged: bool


def minimise_quadratic(
    K: Operator,
    b: Array,
    lower: Bound,
    upper: Bound,
    *,
    start: Array,
    precondition: Operator,
    tolerance: float,
    max_iterations: int,
    quick: Operator | None = None,
    rough: bool = False,
    product: Array | None = None,
) -> Minimum:
    """Projected conjugate gradients, Polak–Ribière+, preconditioned on the free nodes.

    The search among the free nodes is that of Polonsky and Keer (1999, Wear 231, 206–219) with
    bounds on both sides, changed in three ways. The direction, as long as the last steps suggest,
    is projected onto the bounds before the product with K, not after it; the step is the best part
    of that, so an iteration takes one product and the energy always falls. The direction is not
    reset when nodes change sides: Polak–Ribière's formula forgets by itself, between nothing and
    what Fletcher and Reeves keep (Gilbert and Nocedal 1992, SIAM J. Optim. 2, 21–42), since steps
    that end at a bound are not the best ones. And the residual is preconditioned by an approximate
    inverse of K, which need not be symmetric, or point down.

    `start` is overwritten, and so is `product`, that of `quick` with a `start` within the bounds,
    where it is known. `tolerance` is on the violation, in the units of `b`. The gradient at `start`
    is that of K, unless `product` is known or the solve `rough`, and then follows the steps with
    the products of `quick`, which may be K in single precision. What rounding them may have done is
    added up, as independent errors are, and the gradient is computed anew where the violation is no
    longer well above that. The result is accepted only on a gradient computed there; or, if
    `rough`, on one that the steps led to, when the violation and its error are within `tolerance`
    together. Not converging is reported in the result, never raised.
    """
    # What only leads to the next step need not be more exact than what makes it.
    kind: Any = np.float64 if quick is None else np.float32
    quick = K if quick is None else quick
    rounding = _ROUNDING * np.finfo(kind).eps
    p = np.clip(start, lower, upper, out=start)
    lower, upper = passes.as_rows(lower, p), passes.as_rows(upper, p)
    first = quick if rough or product is not None else K
    if product is None:
        product = first(p) if passes.peak(p) > 0 else np.zeros_like(p)
    error = 0.0 if first is K else rounding * passes.peak(product)
    d, r_old = (np.zeros_like(p, dtype=kind) for _ in range(2))
    r, z, Kd = (np.empty_like(p, dtype=kind) for _ in range(3))
    g = product  # as soon as b is taken off
    residual = passes.downhill(p, g, b, lower, upper, r)
    rz_old, iteration = 0.0, 0
    stretch = 1.0  # the last change of
    length = _FIRST  # the next trial step

    for iteration in range(1, max_iterations + 1):
        if not (residual > tolerance and residual > _CLEAR * error):
            if error == 0 or (rough and residual + error <= tolerance):
                iteration -= 1
                break
            g, error = K(p, out=g), 0.0
            residual = passes.downhill(p, g, b, lower, upper, r)
        else:
            z = precondition(r, out=z)
            rz, overlap = passes.products(z, r, r_old)
            kept = (rz - max(overlap, 0.0)) / rz_old if rz_old > 0 else 0.0
            kept = kept * stretch if kept > 0 else 0.0
            # What only approximates an inverse may point up.
            down = math.copysign(length, rz)
            slope, cut = passes.direct(d, kept, z, down, p, g, r, lower, upper)
            Kd = quick(d, out=Kd)
            curvature, largest = passes.curvature(d, Kd)
            if not curvature < math.inf or (slope < 0 and curvature <= 0):
                break
            step = -slope / curvature if curvature > 0 else 0.0
            taken = 1.0 if cut and step > _NEARLY else max(step, 0.0)
            if taken > 1 and passes.leaves(p, d, taken, lower, upper):
                taken = 1.0
            r, r_old = r_old, r
            residual = passes.advance(p, g, d, Kd, taken, lower, upper, r)
            error = float(np.hypot(error, rounding * taken * largest))
            rz_old = rz
            stretch = min(max(step, _SHORTER), _LONGER) ** _DAMPED
            length *= stretch

    if not rough and error > 0:
        g, error = K(p, out=g), 0.0
        residual = passes.downhill(p, g, b, lower, upper, r)
    residual = residual + error
    return Minimum(p, g, residual, iteration, converged=residual <= tolerance)


def violation(p: Array, product: Array, b: Array, lower: Bound, upper: Bound) -> float:
    """Largest violation of the optimality conditions, in the units of the gradient.

    `product`, that of K with `p`, becomes the gradient.
    """
    lower, upper = passes.as_rows(lower, p), passes.as_rows(upper, p)
    return passes.downhill(p, product, b, lower, upper, np.empty_like(p, dtype=np.float32))
