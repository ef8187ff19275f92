"""Minimisation of an energy that is not convex: a quadratic plus a sum over single nodes.

    minimise  ½ uᵀK⁻¹u + Σ_i φ_i(u_i)

K is symmetric positive definite and known only through its product with an array; K⁻¹ is never
needed. The point is stored twice, as u and as p = K⁻¹u. The gradient is r = p + φ′, and the Hessian
is K⁻¹ + diag(φ″).

Newton's method with conjugate gradients that stop at the boundary of a trust region or at negative
curvature (Steihaug 1983, SIAM J. Numer. Anal. 20, 626–637). K preconditions the conjugate
gradients. Then K⁻¹ of each direction is a sum of residuals that are already known, so an iteration
takes one product with K. The energy falls in every step. So from a point that is no longer a
minimum, the method descends into the next one.

K may also annihilate the mean of an array (`zero_mean`). The minimum is then over all u of mean
zero, the gradient is known except for its mean, and the mean of p is chosen so that it vanishes.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from restitution.numerics.convolution.operators import Convolution

Array = NDArray[np.float64]
# φ, φ′ and φ″ of all nodes at u
NodePotential = Callable[[Array], tuple[Array, Array, Array]]

MOST_STEPS = 300  # of Newton's method, after which the solve counts as not converged
_MOST_ITERATIONS = 500  # conjugate gradients of one step
_FORCING = 0.1  # largest residual of the linear system over the gradient
# Ratio of the actual to the predicted decrease of the energy: a step is taken above the first, the
# trust region grows above the third and shrinks below the second.
_TAKEN, _POOR, _GOOD = 0.05, 0.25, 0.75
_ROUNDING = 1e-13  # predicted decreases below this fraction of the energy are rounding


@dataclass(frozen=True)
class LocalMinimum:
    """The point at which the method ended.

    `residual` is the largest |r|/(φ″ + 1/K₀₀), a length like u, where K₀₀ is the diagonal of K.
    `negative_curvature` is True if the method met a direction of negative curvature.
    """

    p: Array
    u: Array
    energy: float
    residual: float
    steps: int
    negative_curvature: bool
    converged: bool


def minimise_locally(
    K: Convolution,
    potential: NodePotential,
    *,
    p: Array,
    u: Array,
    length: float,
    tolerance: float,
    zero_mean: bool = False,
) -> LocalMinimum:
    """Descend from (p, u) to a local minimum.

    `p` and `u` = K p are the start, and are not changed. `length` (a value of u over which φ″
    changes) limits the first step along a direction of negative curvature. `tolerance` limits the
    residual. `zero_mean` tells that K is zero for a constant array, and positive for every other.
    If the method does not converge, the result says so; no exception is raised.
    """
    phi, slope, k = potential(u)
    energy = 0.5 * _dot(p, u) + float(phi.sum())
    radius, negative, steps = math.inf, False, 0
    while True:
        r = p + slope
        if zero_mean:
            p = p - r.mean()
            r -= r.mean()
        residual = float(np.max(np.abs(r) / (np.abs(k) + 1 / K.diagonal)))
        if residual <= tolerance or steps >= MOST_STEPS:
            break
        steps += 1
        x, Sx, at_edge, bent = _newton_step(K, r, k, energy, (radius, length), zero_mean=zero_mean)
        negative |= bent
        predicted = _dot(r, x) + 0.5 * _dot(x, Sx + k * x)
        size = math.sqrt(max(_dot(x, Sx), 0.0))
        new_p = p + Sx
        new_u = K(new_p)  # the products along the step are in single precision
        phi, new_slope, new_k = potential(new_u)
        new_energy = 0.5 * _dot(new_p, new_u) + float(phi.sum())
        change = new_energy - energy
        rounding = abs(predicted) <= _ROUNDING * (abs(energy) + 0.5 * _dot(p, u))
        if not (rounding or (predicted < 0 and change < _TAKEN * predicted)):
            radius = 0.3 * size
            continue
        p, u, energy, slope, k = new_p, new_u, new_energy, new_slope, new_k
        if rounding:
            continue
        if at_edge and change < _GOOD * predicted:
            radius = max(2 * size, radius if math.isfinite(radius) else 0.0)
        elif change > _POOR * predicted:
            radius = 0.5 * size
    return LocalMinimum(p, u, energy, residual, steps, negative, residual <= tolerance)


def _newton_step(
    K: Convolution,
    r: Array,
    k: Array,
    energy: float,
    limits: tuple[float, float],
    *,
    zero_mean: bool,
) -> tuple[Array, Array, bool, bool]:
    """Solve (K⁻¹ + k) x = −r approximately.

    Returns x and K⁻¹x, whether the step ended at the trust region, and whether it met a direction
    of negative curvature. The norm of the trust region is (xᵀK⁻¹x)^½. `limits` are its radius and
    the length of a first step along negative curvature.
    """
    radius, length = limits
    x, Sx, Hd, scaled = (np.zeros_like(r) for _ in range(4))
    rest = -r
    d = K(rest)
    z, Sd = np.empty_like(r), rest.copy()
    rz = first = _dot(rest, d)
    # Solve more accurately towards the end, for superlinear convergence.
    forcing = min(_FORCING, (first / max(abs(energy), 1e-300)) ** 0.25)
    inside = math.isinf(radius)  # no trust region yet
    xSd = xSx = dSd = 0.0
    for _ in range(_MOST_ITERATIONS):
        np.multiply(k, d, out=Hd)
        Hd += Sd
        dHd = _dot(d, Hd)
        if not inside:
            dSd, xSd = _dot(d, Sd), _dot(x, Sd)
        bent = dHd <= 0
        a = math.inf if bent else rz / dHd
        along = 0.0 if bent or inside else xSx + a * (2 * xSd + a * dSd)
        if bent or along >= radius * radius:
            if inside:
                a = length / float(np.abs(d).max())
            else:
                a = (math.sqrt(max(xSd * xSd + dSd * (radius**2 - xSx), 0.0)) - xSd) / dSd
            return x + a * d, Sx + a * Sd, True, bent
        xSx = along
        x += np.multiply(d, a, out=scaled)
        Sx += np.multiply(Sd, a, out=scaled)
        rest -= np.multiply(Hd, a, out=scaled)
        if zero_mean:  # K ignores the mean; without it, single precision keeps the rest
            rest -= rest.mean()
        K.single_precision(rest, out=z)
        before, rz = rz, _dot(rest, z)
        if rz <= forcing**2 * first:
            break
        d *= rz / before
        d += z
        Sd *= rz / before
        Sd += rest
    return x, Sx, False, False


def _dot(a: Array, b: Array) -> float:
    return float(np.vdot(a, b))
