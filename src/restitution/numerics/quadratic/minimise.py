"""Minimisation of a convex quadratic within bounds: the solver of most contacts.

K is symmetric positive definite and known only through its product with an array. With the gradient
g = K p − b, the solution satisfies g ≥ 0 where p = lower, g = 0 between the bounds and g ≤ 0 where
p = upper; the largest violation measures the error of a solution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.convolution.operators import Convolution
from restitution.numerics.expressions import dot, max_magnitude
from restitution.numerics.quadratic.few_nodes import Lags, few_free, minimum_on
from restitution.numerics.quadratic.fused_ops import (
    Bound,
    as_rows,
    curvature,
    dot_products,
    projected_direction,
    projected_gradient,
    squares,
    take_step,
    violates_bounds,
)

Array = NDArray[np.float64]

# Bound on the rounding error of a product with K. The unit is the machine epsilon times the largest
# value of the product. The largest error measured on 64² to 4096² nodes is 8 of these units.
_ROUNDING = 10.0
# Each step updates the gradient. The gradient is computed anew when the violation of the optimality
# conditions falls below this multiple of the estimated error of the updated gradient.
_CLEAR = 3.0
# A step is truncated at the nodes where it would cross a bound. The optimal length along the
# truncated step is given as a multiple of this step. If it exceeds this fraction, the whole
# truncated step is taken, so that these nodes reach the bound.
_FULL_STEP_FRACTION = 0.8
# First trial length, as a multiple of the preconditioned gradient. The first steps of a solve
# typically have about this length. It is below 1 because bounds truncate these steps.
_INITIAL_STEP = 0.3
# After each step, the trial length is multiplied by ratio**_STEP_DAMPING. The ratio is the optimal
# length divided by the trial length, limited to the range from _MIN_STEP to _MAX_STEP. The exponent
# damps oscillations of the optimal length from step to step.
_MIN_STEP, _MAX_STEP, _STEP_DAMPING = 0.1, 3.0, 0.5
# If the trial length has decreased to this value, the preconditioned gradient is almost
# perpendicular to the gradient. One step then follows the gradient itself.
_STALLED_LENGTH = 1e-8
# After a step on few nodes that leaves more than this fraction of the violation, the next step is
# one of all nodes.
_FEW_CONVERGE = 0.5


class Operator(Protocol):
    """A linear operator on arrays of one shape."""

    def __call__(self, p: Array, /, out: Array | None = None) -> Array:
        """Return the product with `p`, in a new array or in `out`."""


@dataclass(frozen=True, eq=False)
class BoundedQuadratic:
    """The problem: minimise ½ pᵀK p − pᵀb with lower ≤ p ≤ upper.

    `b` has shape (nx, ny), and a bound is a number or an array of this shape. `K_single`, K in
    single precision, is applied to the steps of the minimiser; None stands for K itself.
    """

    K: Operator
    b: Array
    lower: Bound
    upper: Bound
    K_single: Operator | None = None
    lags: Lags | None = None

    @classmethod
    def of(cls, K: Convolution, b: Array, lower: Bound, upper: Bound) -> BoundedQuadratic:
        """Problem with all that the operator `K` provides."""
        return cls(K, b, lower, upper, K.single_precision, K.lags)


@dataclass(frozen=True)
class Minimum:
    """Final point of the minimiser, the gradient at this point, and their accuracy.

    `residual` is the violation of the optimality conditions plus the estimated error of the
    gradient.
    """

    point: Array
    gradient: Array
    residual: float
    iterations: int
    converged: bool


def minimise_quadratic(
    problem: BoundedQuadratic,
    *,
    start: Array,
    precondition: Operator,
    tolerance: float,
    max_iterations: int,
    K_start: Array | None = None,
    accept_estimated_gradient: bool = False,
    mean_violation: bool = False,
) -> Minimum:
    """Solve `problem` by projected, preconditioned conjugate gradients (Polak–Ribière+).

    The search on the free nodes follows Polonsky and Keer (1999, Wear 231, 206–219), with an upper
    bound and four changes (docs/method.md): a direction is truncated at a trial length before the
    one product with K, then scaled to its optimal length; it is not reset when nodes reach or leave
    a bound, but β is limited to that of Fletcher and Reeves (Gilbert and Nocedal 1992, SIAM J.
    Optim. 2, 21–42); an ascent direction, from an unsymmetric approximate inverse, is reversed; and
    a solve that stalls takes a step along the gradient itself.

    `start`, shape (nx, ny), is overwritten. `precondition` is an approximate inverse of K.
    `tolerance` limits the violation, in the units of `b`: the largest magnitude of the projected
    gradient or, with `mean_violation`, the root mean square of its nonzero values. `K_start`, if
    given, is the product of `K_single` and a `start` within the bounds, and is overwritten. With
    `accept_estimated_gradient`, the first gradient is computed with `K_single`, and the updated
    gradient is final if the violation plus its estimated rounding error is within `tolerance`; else
    the final gradient is computed with K. If the solve does not converge, `converged` of the result
    is False.
    """
    # Floating-point type of the direction d, of the arrays r and z (from which d is computed), and
    # of the product K d.
    work_type: Any = np.float64 if problem.K_single is None else np.float32
    measured = _root_mean_square if mean_violation else _largest
    K, b, K_single = problem.K, problem.b, problem.K_single or problem.K
    rounding = _ROUNDING * float(np.finfo(work_type).eps)
    p = np.clip(start, problem.lower, problem.upper, out=start)
    bounds = as_rows(problem.lower, problem.upper, p)
    first = K_single if accept_estimated_gradient or K_start is not None else K
    if K_start is None:
        K_start = first(p, out=np.empty_like(p)) if max_magnitude(p) > 0 else np.zeros_like(p)
    error = 0.0 if first is K else rounding * max_magnitude(K_start)
    d, r_old = (np.zeros_like(p, dtype=work_type) for _ in range(2))
    r, z, Kd = (np.empty_like(p, dtype=work_type) for _ in range(3))
    g = K_start  # `projected_gradient` subtracts b in place
    residual = measured(projected_gradient(p, g, b, bounds, r), r)
    rz_old, iteration = 0.0, 0
    step_change = 1.0  # factor by which the trial length last changed
    trial_length = _INITIAL_STEP
    lags = problem.lags if isinstance(p, np.ndarray) else None  # sweeps are slow on a GPU
    converges = True  # whether the last step on few nodes, if it was one, was worth its time

    for iteration in range(1, max_iterations + 1):
        if not (residual > tolerance and residual > _CLEAR * error):
            if error == 0 or (accept_estimated_gradient and residual + error <= tolerance):
                iteration -= 1
                break
            g, error = K(p, out=g), 0.0
            residual = measured(projected_gradient(p, g, b, bounds, r), r)
            continue
        few = few_free(r) if lags and converges else None
        if lags and few is not None:
            slope, cut, rz = minimum_on(few, lags, p, g, bounds, d), True, 0.0
        else:
            z = precondition(r, out=z)
            if trial_length < _STALLED_LENGTH:
                z = np.multiply(r, math.sqrt(dot(z, z) / dot(r, r)), out=z)
                trial_length, rz_old, step_change = _INITIAL_STEP, 0.0, 1.0
            rz, overlap = dot_products(z, r, r_old)
            beta = (rz - max(overlap, 0.0)) / rz_old if rz_old > 0 else 0.0
            beta = beta * step_change if beta > 0 else 0.0
            length = math.copysign(trial_length, rz)  # negative for an ascent direction
            slope, cut = projected_direction(d, beta, z, length, p, g, r, bounds)
        Kd = K_single(d, out=Kd)
        dKd, max_Kd = curvature(d, Kd)
        if not dKd < math.inf or (slope < 0 and dKd <= 0):
            break
        optimum = -slope / dKd if dKd > 0 else 0.0
        step = 1.0 if cut and optimum > _FULL_STEP_FRACTION else max(optimum, 0.0)
        if step > 1 and violates_bounds(p, d, step, bounds):
            step = 1.0
        r, r_old = r_old, r
        before, residual = residual, measured(take_step(p, g, d, Kd, step, bounds, r), r)
        converges = few is None or residual < _FEW_CONVERGE * before
        error = float(np.hypot(error, rounding * step * max_Kd))
        rz_old = rz
        if few is None:
            step_change = min(max(optimum, _MIN_STEP), _MAX_STEP) ** _STEP_DAMPING
            trial_length *= step_change

    if not accept_estimated_gradient and error > 0:
        g, error = K(p, out=g), 0.0
        residual = measured(projected_gradient(p, g, b, bounds, r), r)
    residual += error
    return Minimum(p, g, residual, iteration, converged=residual <= tolerance)


def violation(p: Array, product: Array, b: Array, lower: Bound, upper: Bound) -> float:
    """Largest violation of the optimality conditions; `product` is K p and becomes the gradient."""
    bounds = as_rows(lower, upper, p)
    return projected_gradient(p, product, b, bounds, np.empty_like(p, dtype=np.float32))


def _largest(largest: float, r: Array) -> float:
    return largest


def _root_mean_square(largest: float, r: Array) -> float:
    if not largest > 0:
        return largest
    total, nodes = squares(r)
    return math.sqrt(total / nodes)
