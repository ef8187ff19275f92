"""Box-constrained minimisation of a convex quadratic: the one solver of the program.

    minimise  ½ pᵀK p − pᵀb   subject to   lower ≤ p ≤ upper,

K symmetric positive definite and known only through its product. With the gradient g = K p − b the
solution is characterised by (Karush–Kuhn–Tucker)

    g ≥ 0 where p = lower,   g = 0 between the bounds,   g ≤ 0 where p = upper.

The largest violation of these three conditions is the `residual`. What the bounds mean (contact,
yield, adhesion) is the caller's affair.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Operator = Callable[[Array], Array]


@dataclass(frozen=True)
class Minimum:
    """Where the minimiser stopped: the point, its gradient, and how far both can be trusted."""

    point: Array
    gradient: Array
    residual: float
    iterations: int
    converged: bool


def violation(p: Array, g: Array, lower: Array, upper: Array) -> float:
    """Largest violation of the optimality conditions, in the units of the gradient."""
    wrong = np.abs(g)
    at_lower, at_upper = p <= lower, p >= upper
    np.copyto(wrong, -g, where=at_lower)
    np.copyto(wrong, g, where=at_upper)
    np.copyto(wrong, 0.0, where=at_lower & at_upper)  # held from both sides: nothing to violate
    return max(float(wrong.max()), 0.0)


def minimise_quadratic(
    K: Operator,
    b: Array,
    lower: Array,
    upper: Array,
    *,
    start: Array,
    precondition: Operator,
    tolerance: float,
    max_iterations: int,
) -> Minimum:
    """Projected conjugate gradients, Polak–Ribière+, preconditioned on the free nodes.

    The structure is that of Polonsky and Keer (1999, Wear 231, 206–219) with bounds on both sides:
    search among the free nodes, exact step, project onto the bounds. Two changes make it fast: the
    direction is not reset when nodes change sides (Polak–Ribière+ forgets by itself), and the
    residual is preconditioned by an approximate inverse of K masked to the free nodes.

    `tolerance` is on the violation, in the units of `b`. The gradient is updated along the step
    while no bound interferes and recomputed when one does; the result is accepted only on a freshly
    computed gradient. Not converging is reported in the result, never raised.
    """
    p = np.clip(start, lower, upper)
    g = K(p) - b if p.any() else -b
    fresh = True
    d = r_old = np.zeros_like(p)
    rz_old = np.inf
    residual = violation(p, g, lower, upper)

    for iteration in range(max_iterations):
        if residual <= tolerance:
            if fresh:
                return Minimum(p, g, residual, iteration, converged=True)
            g, fresh = K(p) - b, True
            residual = violation(p, g, lower, upper)
            continue
        free = ((p > lower) | (g < 0)) & ((p < upper) | (g > 0))
        r = np.where(free, -g, 0.0)
        z = np.where(free, precondition(r), 0.0)
        rz = _dot(r, z)
        d = np.where(free, z + max(0.0, (rz - _dot(r_old, z)) / rz_old) * d, 0.0)
        if _dot(r, d) <= 0:
            d = z
        r_old, rz_old = r, rz

        Kd = K(d)
        step = _dot(r, d) / _dot(d, Kd)
        if not np.isfinite(step) or step <= 0:
            break
        trial = p + step * d
        p = np.clip(trial, lower, upper)
        fresh = not np.array_equal(p, trial)
        g = K(p) - b if fresh else g + step * Kd
        residual = violation(p, g, lower, upper)

    return Minimum(p, g, residual, max_iterations, converged=False)


def _dot(a: Array, b: Array) -> float:
    # Not np.vdot: its threads wait for each other longer than these products take.
    return float(np.einsum("ij,ij->", a, b))
