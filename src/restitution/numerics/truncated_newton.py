"""Minimisation of an energy that is not convex: ½ uᵀK⁻¹u + Σ_i φ_i(u_i).

K is symmetric positive definite. The point is stored as u and p = K⁻¹u; the gradient is r = p + φ′.
Newton steps are solved by conjugate gradients up to the boundary of a trust region or negative
curvature (Steihaug 1983, SIAM J. Numer. Anal. 20, 626–637). With K as preconditioner, each
direction is K s with a sum s of residuals, so K⁻¹ is never needed.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from restitution.numerics.convolution.operators import Array, Convolution
from restitution.numerics.expressions import (
    add_curvature,
    advance,
    dot,
    largest_ratio,
    max_magnitude,
    redirect,
)

# Function of the unknowns u that returns the potential φ of each node, and its derivatives φ′ and
# φ″.
NodePotential = Callable[[Array], tuple[Array, Array, Array]]

# Function of the unknowns u, p = K⁻¹u, φ′ and φ″ that returns the φ″ of a Newton step.
Secant = Callable[[Array, Array, Array, Array], Array]

MOST_STEPS = 2000  # Newton steps after which the solve counts as not converged; jumps take many
_MOST_ITERATIONS = 500  # limit on the conjugate-gradient iterations of one Newton step
_FORCING = 0.1  # largest relative residual of the linear system of a Newton step

# While the error of products in single precision is below this share of the tolerance, u = K p
# follows from those of a Newton step.
_HARMLESS, _SINGLE = 0.1, 1e-6

# Let q be the actual decrease of the energy in a step, divided by the predicted decrease. The step
# is accepted if q > _TAKEN. The trust region shrinks if q < _POOR. It grows if q > _GOOD and the
# step ended at the edge of the region.
_TAKEN, _POOR, _GOOD = 0.05, 0.25, 0.75
# If the predicted decrease is below this fraction of the energy, rounding errors can be larger than
# the decrease. The step is then accepted without a test.
_ROUNDING = 1e-13


@dataclass(frozen=True)
class LocalMinimum:
    """Final point of `minimise_locally`: u and p = K⁻¹u.

    `residual` is the largest |r|/(|φ″| + 1/K₀₀), in the units of u, with the diagonal K₀₀ of K.
    `steps` counts Newton steps. `negative_curvature` tells whether the method met such a direction.
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
    secant: Secant | None = None,
) -> LocalMinimum:
    """Descend from (p, u) to a local minimum of ½ uᵀK⁻¹u + Σ φ(u), where `potential` returns φ.

    `p` and `u` = K p are not changed. `length` is the change of u over which φ″ changes noticeably;
    it limits the first step along a direction of negative curvature. `tolerance` limits
    `LocalMinimum.residual`. With `zero_mean`, K maps constant arrays to zero, the minimum is sought
    among all u of mean zero, and the mean of p is chosen so that the gradient has mean zero. With
    `secant`, Newton steps use its result for φ″, where φ′ grows so fast that the tangent is poor.
    If the method does not converge, `converged` of the result is False.
    """
    phi, slope, k = potential(u)
    energy = 0.5 * dot(p, u) + float(phi.sum())
    radius, negative, steps = math.inf, False, 0
    exact = True  # whether u is K p in double precision
    while True:
        r = p + slope
        if zero_mean:
            p = p - r.mean()
            r -= r.mean()
        residual = largest_ratio(r, k, 1 / K.diagonal)
        if residual <= tolerance or steps >= MOST_STEPS:
            if exact:
                break
            u, exact = K(p), True
            phi, slope, k = potential(u)
            energy = 0.5 * dot(p, u) + float(phi.sum())
            continue
        steps += 1
        h = k if secant is None else secant(u, p, slope, k)
        x, Sx, predicted, at_edge, bent = _newton_step(
            K, r, h, energy, (radius, length), zero_mean=zero_mean
        )
        negative |= bent
        exactly = _SINGLE * max_magnitude(x) > _HARMLESS * tolerance
        size = math.sqrt(max(dot(x, Sx), 0.0))
        new_p = p + Sx
        new_u = K(new_p) if exactly else u + x
        new_phi, new_slope, new_k = potential(new_u)
        change = dot(p, new_u - u) + 0.5 * dot(Sx, x) + float((new_phi - phi).sum())
        rounding = abs(predicted) <= _ROUNDING * (abs(energy) + 0.5 * dot(p, u))
        if not (rounding or (predicted < 0 and change < _TAKEN * predicted)):
            radius = 0.3 * size
            continue
        p, u, phi, slope, k, exact = new_p, new_u, new_phi, new_slope, new_k, exactly
        energy += change
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
) -> tuple[Array, Array, float, bool, bool]:
    """Solve (K⁻¹ + k) x = −r approximately, with the gradient r and k = φ″.

    `limits` are the radius of the trust region in the norm (xᵀK⁻¹x)^½, infinite if there is none
    yet, and the largest change of u along a direction of negative curvature while there is none.
    Everything is in single precision, which is far more accurate than the step is exact.
    Return x, K⁻¹x, the change of energy that the linear system predicts, whether one of the limits
    ended the step, and whether a direction had negative curvature.
    """
    radius, length = limits
    k = k.astype(np.float32)
    rest = np.negative(r, dtype=np.float32)
    start = rest.copy()
    x, Sx, Hd = (np.zeros_like(rest) for _ in range(3))
    z, d, Sd = np.empty_like(rest), np.empty_like(rest), rest.copy()
    K.single_precision(rest, out=d)
    rz = first = dot(rest, d)
    # Solve more accurately as the gradient falls, for superlinear convergence.
    forcing = min(_FORCING, (first / max(abs(energy), 1e-300)) ** 0.25)
    inside = math.isinf(radius)  # no trust region yet
    xSd = xSx = dSd = 0.0
    for _ in range(_MOST_ITERATIONS):
        dHd = add_curvature(d, Sd, k, Hd)
        if not inside:
            dSd, xSd = dot(d, Sd), dot(x, Sd)
        bent = dHd <= 0
        a = math.inf if bent else rz / dHd
        along = 0.0 if bent or inside else xSx + a * (2 * xSd + a * dSd)
        if bent or along >= radius * radius:
            if inside:
                a = length / float(np.abs(d).max())
            else:
                a = (math.sqrt(max(xSd * xSd + dSd * (radius**2 - xSx), 0.0)) - xSd) / dSd
            advance(x, Sx, rest, d, Sd, Hd, a)
            return x, Sx, _predicted(x, start, rest), True, bent
        xSx = along
        advance(x, Sx, rest, d, Sd, Hd, a)
        if zero_mean:  # K ignores the mean, which would only increase rounding errors
            rest -= rest.mean()
        K.single_precision(rest, out=z)
        before, rz = rz, dot(rest, z)
        if rz <= forcing**2 * first:
            break
        redirect(d, Sd, z, rest, rz / before)
    return x, Sx, _predicted(x, start, rest), False, False


def _predicted(x: Array, start: Array, rest: Array) -> float:
    """Change of the quadratic energy from 0 to x, where its negative gradient is `rest`."""
    return -0.5 * (dot(x, start) + dot(x, rest))
