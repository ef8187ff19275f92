"""Box-constrained minimisation of a convex quadratic: the one solver of the program.

    minimise  ½ pᵀK p − pᵀb   subject to   lower ≤ p ≤ upper,

K symmetric positive definite and known only through its product. With the gradient g = K p − b the
solution is characterised by (Karush–Kuhn–Tucker)

    g ≥ 0 where p = lower,   g = 0 between the bounds,   g ≤ 0 where p = upper.

The largest violation of these three conditions is the `residual`. What the bounds mean (contact,
yield, adhesion) is the caller's affair.

Arrays are of shape (*batch, nx, ny): each item of a batch is a problem of its own, with
steps and residuals of its own (`items`).
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from functools import reduce
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.items import dot, largest, ratio

Array = NDArray[np.float64]
Bound = Array | float

_MEMORY = 8  # iterations over which the energy must fall
_HALVINGS = 30
_DRIFT = 1e-3  # of the violation, after which the gradient is computed anew


class Operator(Protocol):
    """A linear map of arrays of one shape."""

    def __call__(self, p: Array, /, out: Array | None = None) -> Array:
        """The map of `p`: in a new array, or in `out`."""


@dataclass(frozen=True)
class Minimum:
    """Where the minimiser stopped: the point, its gradient, and how far both can be trusted.

    `residual` and `converged` are of shape (*batch, 1, 1).
    """

    point: Array
    gradient: Array
    residual: Array
    iterations: int
    converged: NDArray[np.bool_]


def free_nodes(p: Array, g: Array, lower: Bound, upper: Bound) -> NDArray[np.bool_]:
    """Nodes that may go downhill: between the bounds, or on one and pushed off it."""
    free = p > lower
    free |= g < 0
    below = p < upper
    below |= g > 0
    free &= below
    return free


def minimise_quadratic(
    K: Operator,
    b: Array,
    lower: Bound,
    upper: Bound,
    *,
    start: Array,
    precondition: Operator,
    tolerance: Bound,
    max_iterations: int,
    quick: Operator | None = None,
    rough: bool = False,
) -> Minimum:
    """Projected conjugate gradients, Polak–Ribière+, preconditioned on the free nodes.

    The structure is that of Polonsky and Keer (1999, Wear 231, 206–219) with bounds on both sides:
    search among the free nodes, exact step, project onto the bounds. Two changes make it fast: the
    direction is not reset when nodes change sides (Polak–Ribière+ forgets by itself), and the
    residual is preconditioned by an approximate inverse of K masked to the free nodes.

    `start` is overwritten. `tolerance` is on the violation, in the units of `b`; an item that is
    there rests until all are. The gradient follows the steps with the products of `quick`,
    which may be K in single precision; it is computed anew with K whenever the violation has fallen
    to a thousandth, and the result is accepted only on such a gradient; or, if `rough`, on one that
    `quick` has led there, which will do for a large tolerance.
    Projecting after an exact step may raise the energy; where it has not fallen below the highest
    of the last few iterations, a descending step is taken instead, so that no cycle can last
    (Grippo, Lampariello and Lucidi 1986, SIAM J. Numer. Anal. 23, 707–716). Not converging is
    reported in the result, never raised.
    """
    quick = K if quick is None else quick
    K = quick if rough else K
    p = np.clip(start, lower, upper, out=start)
    g = _gradient(K, p, b)
    free = free_nodes(p, g, lower, upper)
    r = g * free  # uphill, where there is a way down
    residual = largest(r)
    low = _DRIFT * residual
    d, r_old, p_old, work = (np.zeros_like(p) for _ in range(4))
    rz_old, energy, exact = np.full_like(residual, np.inf), _energy(p, g, b), True
    stuck = np.zeros_like(residual, dtype=bool)
    energies: deque[Array] = deque(maxlen=_MEMORY)
    iteration = 0

    for iteration in range(1, max_iterations + 1):
        going = ~stuck & (residual > (tolerance if exact else np.maximum(tolerance, low)))
        if not going.any():
            if exact:
                iteration -= 1
                break
            g, exact = _gradient(K, p, b, out=g), True
        else:
            if not going.all():
                r *= going
            z = precondition(r, out=work)
            z *= free
            rz = dot(r, z)
            d *= np.maximum(0.0, ratio(rz - dot(r_old, z), rz_old))
            d -= z
            d *= free
            slope = dot(r, d)
            uphill = going & (slope >= 0)
            if uphill.any():
                d = np.where(uphill, -z, d)
                slope = np.where(uphill, -rz, slope)
            Kd = quick(d, out=work)
            curvature = dot(d, Kd)
            stuck |= going & ~((curvature > 0) & (curvature < np.inf))
            if stuck.all():
                break
            step = ratio(-slope, curvature)
            r, r_old, rz_old, exact = r_old, r, rz, rough
            np.multiply(d, step, out=p_old)
            p_old += p
            p, p_old = p_old, p
            if ((p < lower) | (p > upper)).any():
                np.clip(p, lower, upper, out=p)
                np.subtract(p, p_old, out=work)
                g += quick(work, out=work)
                energy = _energy(p, g, b)
                recent = reduce(np.maximum, energies) if len(energies) == _MEMORY else np.inf
                rising = going & (energy >= recent)
                if rising.any():
                    lower_p, lower_g = _descend(K, b, lower, upper, p_old, r_old, rising)
                    p, g = np.where(rising, lower_p, p), np.where(rising, lower_g, g)
                    energy = _energy(p, g, b)
                    d *= ~rising
                    r_old *= ~rising
                    rz_old = np.where(rising, np.inf, rz_old)
            else:
                Kd *= step
                g += Kd
                energy = energy + 0.5 * step * slope
            energies.append(energy)
        free = free_nodes(p, g, lower, upper)
        np.multiply(g, free, out=r)
        residual = largest(r)
        low = _DRIFT * residual if exact else low

    if not exact:
        g = _gradient(K, p, b, out=g)
        residual = violation(p, g, lower, upper)
    return Minimum(p, g, residual, iteration, converged=residual <= tolerance)


def violation(p: Array, g: Array, lower: Bound, upper: Bound) -> Array:
    """Largest violation of the optimality conditions, in the units of the gradient."""
    return largest(g * free_nodes(p, g, lower, upper))


def _gradient(K: Operator, p: Array, b: Array, out: Array | None = None) -> Array:
    g = K(p, out=out) if p.any() else np.zeros_like(p)
    g -= b
    return g


def _descend(
    K: Operator,
    b: Array,
    lower: Bound,
    upper: Bound,
    p: Array,
    uphill: Array,
    wanted: NDArray[np.bool_],
) -> tuple[Array, Array]:
    """Projected steepest descent from p, shortened until the energy of the items `wanted` falls."""
    g = _gradient(K, p, b)
    step = ratio(dot(uphill, uphill), dot(uphill, K(uphill)))
    for _ in range(_HALVINGS):
        trial = np.clip(p - step * uphill, lower, upper)
        g_trial = _gradient(K, trial, b)
        falls = dot(g + g_trial, trial - p) < 0  # twice the change of a quadratic
        if (falls | ~wanted).all():
            break
        step = np.where(falls, step, 0.5 * step)
    return trial, g_trial


def _energy(p: Array, g: Array, b: Array) -> Array:
    return 0.5 * (dot(p, g) - dot(p, b))
