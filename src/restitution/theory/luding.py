"""Luding (2008): linear springs with plastic loading, an elastic limit and linear adhesion.

S. Luding, Granular Matter 10 (2008) 235–246, eqs. 6–8; with the limit branch as spelled out in
A. Singh, V. Magnanimo, S. Luding, arXiv:1503.03720. The springs are k₁ (plastic loading), k̂₂ (the
elastic limit) and k_c (adhesion), and φ_f is the plasticity depth. With d = δ_max and x = d/δ*:

    limit       δ* = k̂₂/(k̂₂ − k₁) φ_f 2R*,  and there δ₀* = φ_f 2R*
    unloading   F = k₂(δ − δ₀),  k₂ = k₁ + (k̂₂ − k₁) min(x, 1),  δ₀ = min((1 − k₁/k₂) d, δ₀*)
    loading     F = k₁δ up to δ*, and along the limit F = k̂₂(δ − δ₀*) beyond: k₂(δ − δ₀) at δ = d
    adhesion    F ≥ −k_cδ, reached at δ_min = k₂δ₀/(k₂ + k_c); from there F = −k_cδ to δ = 0
    work        W_l = ½k₂(d − δ₀)² + ½k₁ min(d, δ*) δ₀,  W_u = ½k₂(d − δ₀)² − ½ k_cδ_minδ₀
    impact      ½ m* V² = W_l, e² = W_u/W_l, 0 where W_u ≤ 0: stuck, in contact at δ > 0

2R* is Luding's 2a₁a₂/(a₁ + a₂): the radius of each of two equal spheres, twice that of a sphere on
a wall. Without adhesion e = (k₁/k₂)^½ falls to its least, (k₁/k̂₂)^½, at δ* and rises beyond, where
the limit branch is elastic.

With k_c > 0 the contact ends at δ = 0; without, nothing acts below δ₀ and it ends at F = 0 there.
Quasi-static: the viscous term γ₀v of the paper is left out. The springs are parameters to be
fitted; linear springs have no scale of length other than φ_f 2R*.
Units, shapes and errors are those of `restitution.theory`; here k̂₂ must not be below k₁ (equal, it
is elastic), and k_c may be zero.
"""

from __future__ import annotations

import numpy as np

from ._inputs import Array, Values, between, positive, scalar_or_array, touching


def limit_indentation(
    radius: Values, loading_stiffness: Values, limit_stiffness: Values, plasticity_depth: Values
) -> Array:
    """Indentation δ* (m) beyond which loading is elastic too; infinite where k̂₂ = k₁."""
    k1, k2_hat = _springs(loading_stiffness, limit_stiffness)
    with np.errstate(divide="ignore"):  # k̂₂ = k₁: nothing is plastic at any depth
        d_star: Array = k2_hat / (k2_hat - k1) * _limit_residual(radius, plasticity_depth)
    return d_star


def loading_force(
    indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Normal force (N) on first loading: k₁δ up to δ*, the elastic limit k̂₂(δ − δ₀*) beyond."""
    d, springs = touching(indentation), (loading_stiffness, limit_stiffness, plasticity_depth)
    k2, d0 = _unloading_line(d, radius, *springs)
    return k2 * (d - d0)


def unloading_force(
    indentation: Values,
    maximum_indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    adhesive_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

    Negative, attractive, below `residual_indentation`. Above `maximum_indentation` the contact is
    loading again, and the force is `loading_force`.
    """
    d, springs = touching(indentation), (loading_stiffness, limit_stiffness, plasticity_depth)
    (k_c,) = between(0.0, np.inf, adhesive_stiffness=adhesive_stiffness)
    k2, d0 = _unloading_line(maximum_indentation, radius, *springs)
    unloading = np.maximum(k2 * (d - d0), -k_c * d)
    beyond = d > touching(maximum_indentation)
    return scalar_or_array(np.where(beyond, loading_force(d, radius, *springs), unloading))


def residual_indentation(
    maximum_indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Indentation δ₀ (m) at which the force of unloading from `maximum_indentation` is zero."""
    springs = loading_stiffness, limit_stiffness, plasticity_depth
    return scalar_or_array(_unloading_line(maximum_indentation, radius, *springs)[1])


def pull_off_force(
    maximum_indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    adhesive_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Greatest attraction k_cδ_min (N, positive) on unloading from `maximum_indentation`."""
    (k_c,) = between(0.0, np.inf, adhesive_stiffness=adhesive_stiffness)
    springs = loading_stiffness, limit_stiffness, plasticity_depth
    k2, d0 = _unloading_line(maximum_indentation, radius, *springs)
    return k_c * k2 / (k2 + k_c) * d0


def loading_work(
    indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Work W_l = ∫F dδ (J) done from first touch to `indentation` on first loading.

    What unloading without adhesion gives back, and ½k₁ min(δ, δ*) δ₀ that is lost.
    """
    d, springs = touching(indentation), (loading_stiffness, limit_stiffness, plasticity_depth)
    (k1,) = positive(loading_stiffness=loading_stiffness)
    k2, d0 = _unloading_line(d, radius, *springs)
    plastic = d / np.maximum(_depth(d, radius, *springs), 1.0)
    return 0.5 * k2 * (d - d0) ** 2 + 0.5 * k1 * plastic * d0


def unloading_work(
    maximum_indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    adhesive_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """Work W_u (J) given back from `maximum_indentation` to δ = 0; negative where they stick."""
    springs = loading_stiffness, limit_stiffness, plasticity_depth
    k2, d0 = _unloading_line(maximum_indentation, radius, *springs)
    F_c = pull_off_force(
        maximum_indentation,
        radius,
        loading_stiffness,
        limit_stiffness,
        adhesive_stiffness,
        plasticity_depth,
    )
    return 0.5 * k2 * (touching(maximum_indentation) - d0) ** 2 - 0.5 * F_c * d0


def indentation_from_velocity(
    velocity: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
    mass: Values,
) -> Array:
    """Largest indentation (m) of an impact at relative normal `velocity` (m/s).

    d₁ = V (m*/k₁)^½ up to δ*; beyond, k̂₂(δ − δ₀*)² = k₁(d₁² − δ*δ₀*).
    """
    k1, m = positive(loading_stiffness=loading_stiffness, mass=mass)
    (k2_hat,) = positive(limit_stiffness=limit_stiffness)
    d1 = touching(velocity) * (m / k1) ** 0.5
    x = _depth(d1, radius, loading_stiffness, limit_stiffness, plasticity_depth)
    d_star, d0_star = d1 / np.maximum(x, 1.0), _limit_residual(radius, plasticity_depth)
    limit = d0_star + (k1 / k2_hat * touching(d1**2 - d_star * d0_star)) ** 0.5
    return scalar_or_array(np.where(x > 1, limit, d1))


def restitution(
    velocity: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    adhesive_stiffness: Values,
    plasticity_depth: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e = (W_u/W_l)^½ after an impact at `velocity` (m/s).

    Stiffnesses k₁, k̂₂ and k_c in N/m; `plasticity_depth` φ_f is a number. 0 where they stick; 1 at
    and below zero velocity, where none approaches.
    """
    (m,) = positive(mass=mass)
    springs = loading_stiffness, limit_stiffness
    d = indentation_from_velocity(velocity, radius, *springs, plasticity_depth, mass)
    W_u = unloading_work(d, radius, *springs, adhesive_stiffness, plasticity_depth)
    none = np.asarray(velocity) <= 0
    W_l = 0.5 * m * touching(velocity) ** 2
    e = (touching(W_u) / np.where(W_l > 0, W_l, 1.0)) ** 0.5
    return scalar_or_array(np.where(none, 1.0, np.minimum(e, 1.0)))


def _springs(loading_stiffness: Values, limit_stiffness: Values) -> tuple[Array, Array]:
    """k₁ and k̂₂ (N/m)."""
    (k1,) = positive(loading_stiffness=loading_stiffness)
    (k2_hat,) = between(k1, np.inf, limit_stiffness=limit_stiffness)
    return k1, k2_hat


def _limit_residual(radius: Values, plasticity_depth: Values) -> Array:
    """δ₀* (m)."""
    R, phi_f = positive(radius=radius, plasticity_depth=plasticity_depth)
    return phi_f * 2 * R


def _depth(
    indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
) -> Array:
    """x = δ/δ*, zero where k̂₂ = k₁."""
    k1, k2_hat = _springs(loading_stiffness, limit_stiffness)
    return touching(indentation) * (1 - k1 / k2_hat) / _limit_residual(radius, plasticity_depth)


def _unloading_line(
    maximum_indentation: Values,
    radius: Values,
    loading_stiffness: Values,
    limit_stiffness: Values,
    plasticity_depth: Values,
) -> tuple[Array, Array]:
    """k₂ (N/m) and δ₀ (m)."""
    k1, k2_hat = _springs(loading_stiffness, limit_stiffness)
    x = _depth(maximum_indentation, radius, loading_stiffness, limit_stiffness, plasticity_depth)
    k2 = k1 + (k2_hat - k1) * np.minimum(x, 1.0)
    d0_star = _limit_residual(radius, plasticity_depth)
    return k2, np.minimum((1 - k1 / k2) * touching(maximum_indentation), d0_star)
