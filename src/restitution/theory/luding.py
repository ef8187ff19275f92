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

from dataclasses import dataclass

import numpy as np

from ._inputs import (
    Array,
    Values,
    keep_between,
    keep_positive,
    positive,
    scalar_or_array,
    touching,
)
from .law import restitution_of_work


@dataclass(frozen=True, eq=False)
class Luding:
    """Springs `loading_stiffness` k₁, `limit_stiffness` k̂₂ and `adhesive_stiffness` k_c (N/m).

    `radius` is R* (m); `plasticity_depth` φ_f is a number.
    """

    radius: Values
    loading_stiffness: Values
    limit_stiffness: Values
    adhesive_stiffness: Values
    plasticity_depth: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "loading_stiffness", "plasticity_depth")
        keep_between(self, "limit_stiffness", self.loading_stiffness)
        keep_between(self, "adhesive_stiffness", 0.0)

    @property
    def limit_indentation(self) -> Array:
        """Indentation δ* (m) beyond which loading is elastic too; infinite where k̂₂ = k₁."""
        k1, k2_hat = self.loading_stiffness, self.limit_stiffness
        with np.errstate(divide="ignore"):  # k̂₂ = k₁: nothing is plastic at any depth
            return scalar_or_array(k2_hat / (k2_hat - k1) * self._limit_residual)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force (N) on first loading: k₁δ up to δ*, the elastic limit k̂₂(δ − δ₀*) beyond."""
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        return k2 * (d - d0)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

        Negative, attractive, below `residual_indentation`. Above `maximum_indentation` the contact
        is loading again, and the force is `loading_force`.
        """
        d = touching(indentation)
        k2, d0 = self._unloading_line(maximum_indentation)
        unloading = np.maximum(k2 * (d - d0), -self.adhesive_stiffness * d)
        beyond = d > touching(maximum_indentation)
        return scalar_or_array(np.where(beyond, self.loading_force(d), unloading))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ₀ (m) at which the force of unloading from `maximum_indentation` is zero."""
        return scalar_or_array(self._unloading_line(maximum_indentation)[1])

    def pull_off_force(self, maximum_indentation: Values) -> Array:
        """Greatest attraction k_cδ_min (N, positive) on unloading from `maximum_indentation`."""
        k_c, (k2, d0) = self.adhesive_stiffness, self._unloading_line(maximum_indentation)
        return k_c * k2 / (k2 + k_c) * d0

    def loading_work(self, indentation: Values) -> Array:
        """Work W_l = ∫F dδ (J) done from first touch to `indentation` on first loading.

        It is ½k₂(δ − δ₀)² that unloading without adhesion gives back, and ½k₁ min(δ, δ*) δ₀ that is
        lost.
        """
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        plastic = d / np.maximum(self._depth(d), 1.0)
        return 0.5 * k2 * (d - d0) ** 2 + 0.5 * self.loading_stiffness * plastic * d0

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) given back down to δ = 0; negative where they stick."""
        d = touching(maximum_indentation)
        k2, d0 = self._unloading_line(d)
        return 0.5 * k2 * (d - d0) ** 2 - 0.5 * self.pull_off_force(d) * d0

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation (m) of an impact at relative normal `velocity` (m/s).

        d₁ = V (m*/k₁)^½ up to δ*; beyond, k̂₂(δ − δ₀*)² = k₁(d₁² − δ*δ₀*).
        """
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d1 = touching(velocity) * (m / k1) ** 0.5
        x = self._depth(d1)
        d_star, d0_star = d1 / np.maximum(x, 1.0), self._limit_residual
        released = touching(d1**2 - d_star * d0_star)
        limit = d0_star + (k1 / self.limit_stiffness * released) ** 0.5
        return scalar_or_array(np.where(x > 1, limit, d1))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ after an impact at `velocity` (m/s).

        0 where they stick; 1 at and below zero velocity, where none approaches.
        """
        W_u = self.unloading_work(self.indentation_from_velocity(velocity, mass))
        return restitution_of_work(W_u, velocity, mass)

    @property
    def _limit_residual(self) -> Values:
        """δ₀* (m)."""
        return self.plasticity_depth * 2 * self.radius

    def _depth(self, indentation: Values) -> Array:
        """x = δ/δ*, zero where k̂₂ = k₁."""
        rise = 1 - self.loading_stiffness / self.limit_stiffness
        return touching(indentation) * rise / self._limit_residual

    def _unloading_line(self, maximum_indentation: Values) -> tuple[Array, Array]:
        """k₂ (N/m) and δ₀ (m)."""
        d, k1 = touching(maximum_indentation), self.loading_stiffness
        k2 = k1 + (self.limit_stiffness - k1) * np.minimum(self._depth(d), 1.0)
        return k2, np.minimum((1 - k1 / k2) * d, self._limit_residual)
