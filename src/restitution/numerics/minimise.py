"""Box-constrained minimisation of a convex quadratic: the one solver of the program.

    minimise  ½ pᵀK p − pᵀb   subject to   lower ≤ p ≤ upper,

K symmetric positive definite and known only through its product. With the gradient g = K p − b the
solution is characterised by (Karush–Kuhn–Tucker)

    g ≥ 0 where p = lower,   g = 0 between the bounds,   g ≤ 0 where p = upper.

The largest violation of these three conditions is the `residual`. What the bounds mean (contact,
yield, adhesion) is the caller's affair.
"""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

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
    """Where the minimiser stopped: the point, its gradient, and how far both can be trusted."""

    point: Array
    gradient: Array
    residual: float
    iterations: int
    converged: bool


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
    tolerance: float,
    max_iterations: int,
    quick: Operator | None = None,
    rough: bool = False,
) -> Minimum:
    """Projected conjugate gradients, Polak–Ribière+, preconditioned on the free nodes.

    The structure is that of Polonsky and Keer (1999, Wear 231, 206–219) with bounds on both sides:
    search among the free nodes, exact step, project onto the bounds. Two changes make it fast: the
    direction is not reset when nodes change sides (Polak–Ribière+ forgets by itself), and the
    residual is preconditioned by an approximate inverse of K masked to the free nodes.

    `tolerance` is on the violation, in the units of `b`. The gradient follows the steps with the
    products of `quick`, which may be K in single precision; it is computed anew with K whenever the
    violation has fallen to a thousandth, and the result is accepted only on such a gradient; or, if
    `rough`, on one that `quick` has led there, which will do for a large tolerance.
    Projecting after an exact step may raise the energy; where it has not fallen below the highest
    of the last few iterations, a descending step is taken instead, so that no cycle can last
    (Grippo, Lampariello and Lucidi 1986, SIAM J. Numer. Anal. 23, 707–716). Not converging is
    reported in the result, never raised.
    """
    quick = K if quick is None else quick
    K = quick if rough else K
    p = np.clip(start, lower, upper)
    g = _gradient(K, p, b)
    free = free_nodes(p, g, lower, upper)
    r = g * free  # uphill, where there is a way down
    residual = refresh = _largest(r)
    d, r_old, p_old, work = (np.zeros_like(p) for _ in range(4))
    rz_old, energy, exact = np.inf, _energy(p, g, b), True
    energies: deque[float] = deque(maxlen=_MEMORY)
    iteration = 0

    for iteration in range(1, max_iterations + 1):
        if exact and residual <= tolerance:
            return Minimum(p, g, residual, iteration - 1, converged=True)
        if not exact and residual <= max(tolerance, _DRIFT * refresh):
            g, exact = _gradient(K, p, b, out=g), True
        else:
            z = precondition(r, out=work)
            z *= free
            rz = _dot(r, z)
            d *= max(0.0, (rz - _dot(r_old, z)) / rz_old)
            d -= z
            d *= free
            slope = _dot(r, d)
            if slope >= 0:
                np.negative(z, out=d)
                slope = -rz
            Kd = quick(d, out=work)
            curvature = _dot(d, Kd)
            if not 0 < curvature < np.inf:
                break
            step = -slope / curvature
            r, r_old, rz_old, exact = r_old, r, rz, rough
            np.multiply(d, step, out=p_old)
            p_old += p
            p, p_old = p_old, p
            if ((p < lower) | (p > upper)).any():
                np.clip(p, lower, upper, out=p)
                np.subtract(p, p_old, out=work)
                g += quick(work, out=work)
                energy = _energy(p, g, b)
                if len(energies) == energies.maxlen and energy >= max(energies):
                    p, g = _descend(K, b, lower, upper, p_old, r_old)
                    energy = _energy(p, g, b)
                    d[:], r_old[:], rz_old = 0.0, 0.0, np.inf
            else:
                Kd *= step
                g += Kd
                energy += 0.5 * step * slope
            energies.append(energy)
        free = free_nodes(p, g, lower, upper)
        np.multiply(g, free, out=r)
        residual = _largest(r)
        refresh = residual if exact else refresh

    if not exact:
        g = _gradient(K, p, b, out=g)
        residual = violation(p, g, lower, upper)
    return Minimum(p, g, residual, iteration, converged=residual <= tolerance)


def violation(p: Array, g: Array, lower: Bound, upper: Bound) -> float:
    """Largest violation of the optimality conditions, in the units of the gradient."""
    return _largest(g * free_nodes(p, g, lower, upper))


def _gradient(K: Operator, p: Array, b: Array, out: Array | None = None) -> Array:
    g = K(p, out=out) if p.any() else np.zeros_like(p)
    g -= b
    return g


def _descend(
    K: Operator, b: Array, lower: Bound, upper: Bound, p: Array, uphill: Array
) -> tuple[Array, Array]:
    """Projected steepest descent from p, shortened until the energy falls."""
    g = _gradient(K, p, b)
    step = _dot(uphill, uphill) / _dot(uphill, K(uphill))
    for _ in range(_HALVINGS):
        trial = np.clip(p - step * uphill, lower, upper)
        g_trial = _gradient(K, trial, b)
        if _dot(g + g_trial, trial - p) < 0:  # twice the change of a quadratic
            break
        step *= 0.5
    return trial, g_trial


def _energy(p: Array, g: Array, b: Array) -> float:
    return 0.5 * (_dot(p, g) - _dot(p, b))


def _largest(r: Array) -> float:
    return max(float(r.max()), -float(r.min()))


def _dot(a: Array, b: Array) -> float:
    # Not np.vdot: its threads wait for each other longer than these products take.
    return float(np.einsum("i,i->", a.ravel(), b.ravel()))
