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
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Operator = Callable[[Array], Array]

_MEMORY = 8  # iterations over which the energy must fall
_HALVINGS = 30


@dataclass(frozen=True)
class Minimum:
    """Where the minimiser stopped: the point, its gradient, and how far both can be trusted."""

    point: Array
    gradient: Array
    residual: float
    iterations: int
    converged: bool


def free_nodes(p: Array, g: Array, lower: Array, upper: Array) -> NDArray[np.bool_]:
    """Nodes that may go downhill: between the bounds, or on one and pushed off it."""
    return ((p > lower) | (g < 0)) & ((p < upper) | (g > 0))


def violation(p: Array, g: Array, lower: Array, upper: Array) -> float:
    """Largest violation of the optimality conditions, in the units of the gradient."""
    return float(np.where(free_nodes(p, g, lower, upper), np.abs(g), 0.0).max())


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
    computed gradient. Projecting after an exact step may raise the energy; where it has not fallen
    below the highest of the last few iterations, a descending step is taken instead, so that no
    cycle can last (Grippo, Lampariello and Lucidi 1986, SIAM J. Numer. Anal. 23, 707–716). Not
    converging is reported in the result, never raised.
    """
    p = np.clip(start, lower, upper)
    g = K(p) - b if p.any() else -b
    fresh = True
    d = r_old = np.zeros_like(p)
    rz_old = np.inf
    energies: deque[float] = deque(maxlen=_MEMORY)
    iteration = 0
    residual = violation(p, g, lower, upper)

    for iteration in range(1, max_iterations + 1):
        if residual <= tolerance:
            if fresh:
                return Minimum(p, g, residual, iteration - 1, converged=True)
            g, fresh = K(p) - b, True
            residual = violation(p, g, lower, upper)
            continue
        free = free_nodes(p, g, lower, upper)
        r = np.where(free, -g, 0.0)
        z = np.where(free, precondition(r), 0.0)
        rz = _dot(r, z)
        d = np.where(free, z + max(0.0, (rz - _dot(r_old, z)) / rz_old) * d, 0.0)
        if _dot(r, d) <= 0:
            d = z
        r_old, rz_old = r, rz

        Kd = K(d)
        curvature = _dot(d, Kd)
        if not 0 < curvature < np.inf:
            break
        step = _dot(r, d) / curvature
        trial = p + step * d
        old, g_old = p, g
        p = np.clip(trial, lower, upper)
        fresh = not np.array_equal(p, trial)
        g = K(p) - b if fresh else g + step * Kd
        energy = 0.5 * _dot(p, g - b)
        if fresh and len(energies) == energies.maxlen and energy >= max(energies):
            p, g = _descend(K, b, lower, upper, old, g_old, r)
            energy = 0.5 * _dot(p, g - b)
            d, r_old, rz_old = np.zeros_like(p), np.zeros_like(p), np.inf
        energies.append(energy)
        residual = violation(p, g, lower, upper)

    if not fresh:
        g = K(p) - b
        residual = violation(p, g, lower, upper)
    return Minimum(p, g, residual, iteration, converged=residual <= tolerance)


def _descend(
    K: Operator, b: Array, lower: Array, upper: Array, p: Array, g: Array, r: Array
) -> tuple[Array, Array]:
    """Projected steepest descent from p along r, shortened until the energy falls."""
    step = _dot(r, r) / _dot(r, K(r))
    for _ in range(_HALVINGS):
        trial = np.clip(p + step * r, lower, upper)
        g_trial = K(trial) - b
        if _dot(g + g_trial, trial - p) < 0:  # twice the change of a quadratic
            break
        step *= 0.5
    return trial, g_trial


def _dot(a: Array, b: Array) -> float:
    # Not np.vdot: its threads wait for each other longer than these products take.
    return float(np.einsum("i,i->", a.ravel(), b.ravel()))
