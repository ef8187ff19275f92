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

from restitution.numerics.box import Box, shape_of
from restitution.numerics.convolution.operators import Array, Convolution, fast_size
from restitution.numerics.expressions import (
    add_and_compare,
    descend,
    dot,
    ends_above,
    max_magnitude,
)

# Function of the unknowns u that returns the potential φ of each node, and its derivatives φ′ and
# φ″.
NodePotential = Callable[[Array], tuple[Array, Array, Array]]

# Function of the unknowns u, p = K⁻¹u, φ′ and φ″ that returns the φ″ of a Newton step.
Secant = Callable[[Array, Array, Array, Array], Array]

MOST_STEPS = 2000  # Newton steps after which the solve counts as not converged; jumps take many
_MOST_ITERATIONS = 500  # limit on the conjugate-gradient iterations of one Newton step
# Largest relative residual of the linear system of a Newton step. It falls with this power of the
# predicted decrease, relative to the energy, but not below the share _ENOUGH of the decrease of
# `residual` to the tolerance, at most _LOOSEST.
_FORCING, _POWER, _ENOUGH, _LOOSEST = 0.1, 0.2, 0.3, 0.3

# Largest row sums of K |φ″| outside the part of the grid on which a Newton step is solved.
_NEGLIGIBLE = 0.1
# While the error of products in single precision is below this share of the tolerance, u = K p
# follows from those of a Newton step on the whole grid.
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
    start: tuple[Array, Array],
    length: float,
    tolerance: float,
    zero_mean: bool = False,
    secant: Secant | None = None,
    operator_of: Callable[[tuple[int, int]], Convolution] | None = None,
) -> LocalMinimum:
    """Descend from (p, u = K p) to a local minimum of ½ uᵀK⁻¹u + Σ φ(u); `potential` returns φ.

    `start` is p and u, which are not changed. `length` is the change of u over which φ″ changes
    noticeably; it limits the first step along a direction of negative curvature. `tolerance` limits
    `LocalMinimum.residual`. With `zero_mean`, K maps constant arrays to zero, the minimum is sought
    among all u of mean zero, and the mean of p is chosen so that the gradient has mean zero. With
    `secant`, Newton steps use its result for φ″, where φ′ grows so fast that the tangent is poor.
    With `operator_of`, which approximates K on arrays of a shape, they are solved on the part where
    φ″ matters. If the method does not converge, `converged` of the result is False.
    """
    p, u = start
    phi, slope, k = potential(u)
    energy = 0.5 * dot(p, u) + float(phi.sum())
    radius, negative, steps = math.inf, False, 0
    exact = True  # whether u is K p in double precision
    while True:
        if zero_mean:
            p = p - (p + slope).mean()
        r = np.empty_like(p)
        residual = add_and_compare(p, slope, k, 1 / K.diagonal, r)
        if residual <= tolerance or steps >= MOST_STEPS:
            if exact:
                break
            u, exact = K(p), True
            phi, slope, k = potential(u)
            energy = 0.5 * dot(p, u) + float(phi.sum())
            continue
        steps += 1
        h = k if secant is None else secant(u, p, slope, k)
        part = (slice(None), slice(None)) if operator_of is None else _part(h, K.diagonal)
        near = K if operator_of is None else operator_of(shape_of(part))
        x, Sx, predicted, at_edge, bent = _newton_step(
            near,
            r[part],
            h[part],
            energy,
            (radius, length),
            enough=_ENOUGH * tolerance / residual,
            zero_mean=zero_mean,
        )
        negative |= bent
        size = math.sqrt(max(dot(x, Sx), 0.0))
        exactly = operator_of is not None or _SINGLE * max_magnitude(x) > _HARMLESS * tolerance
        if operator_of is not None:
            Sx, inside = -r, Sx  # as if k were 0 outside the part
            Sx[part] = inside
        new_p = p + Sx
        if exactly:
            new_u = K(new_p)
            x = new_u - u
        else:
            new_u = u + x
        new_phi, new_slope, new_k = potential(new_u)
        change = dot(p, x) + 0.5 * dot(Sx, x) + float((new_phi - phi).sum())
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


def _part(k: Array, diagonal: float) -> Box:
    """Box outside which k = φ″ hardly changes a Newton step.

    There, K |k| has row sums of at most about _NEGLIGIBLE. The sides are fast to transform.
    """
    # K₀₀ n is the displacement at the centre of n × n nodes under a uniform pressure.
    least = _NEGLIGIBLE / (diagonal * math.sqrt(k.size))
    ends = ends_above(k, least)
    sides = []
    for (start, stop), nodes in zip((ends[:2], ends[2:]), k.shape, strict=True):
        size = min(fast_size(max(stop - start, 1)), nodes)
        start = min(start, nodes - size)
        sides.append(slice(start, start + size))
    return sides[0], sides[1]


def _newton_step(
    K: Convolution,
    r: Array,
    k: Array,
    energy: float,
    limits: tuple[float, float],
    *,
    enough: float,
    zero_mean: bool,
) -> tuple[Array, Array, float, bool, bool]:
    """Solve (K⁻¹ + k) x = −r approximately, with the gradient r and k = φ″.

    `limits` are the radius of the trust region in the norm (xᵀK⁻¹x)^½, infinite if there is none
    yet, and the largest change of u along a direction of negative curvature while there is none.
    A relative residual of `enough`, but at most _LOOSEST, suffices. Everything is in single
    precision, which is far more accurate than the step is exact. Return x, K⁻¹x, the change of
    energy that the linear system predicts, whether one of the limits ended the step, and whether a
    direction had negative curvature.
    """
    k = k.astype(np.float32)
    rest = np.negative(r, dtype=np.float32)
    start = rest.copy()
    x, Sx = np.zeros_like(rest), np.zeros_like(rest)
    d, z, Hd = np.empty_like(rest), np.empty_like(rest), np.empty_like(rest)
    K.single_precision(rest, out=d)
    first = dot(rest, d)
    # Solve more accurately as the gradient falls, for superlinear convergence.
    forcing = min(_FORCING, (first / max(abs(energy), 1e-300)) ** _POWER)
    forcing = max(forcing, min(enough, _LOOSEST))
    at_edge, bent = descend(
        rest,
        d,
        (x, Sx, rest.copy(), z, Hd),
        k,
        lambda: K.single_precision(rest, out=z),
        (forcing**2 * first, *limits, _MOST_ITERATIONS),
        zero_mean,
    )
    return x, Sx, _predicted(x, start, rest), at_edge, bent


def _predicted(x: Array, start: Array, rest: Array) -> float:
    """Change of the quadratic energy from 0 to x, where its negative gradient is `rest`."""
    return -0.5 * (dot(x, start) + dot(x, rest))
