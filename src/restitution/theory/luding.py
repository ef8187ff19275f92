"""Luding (2008): linear springs, plastic up to a limit indentation, with linear adhesion.

S. Luding, Granular Matter 10 (2008) 235–246, eqs. 6–8. Loading is plastic up to the limit
indentation δ*. Beyond δ* it is elastic, on the limit branch of A. Singh, V. Magnanimo, S. Luding,
arXiv:1503.03720. The constants are the stiffnesses k₁ (plastic loading), k̂₂ (limit branch)
and k_c (adhesion), and the plasticity depth φ_f. d = δ_max is the largest indentation and x = d/δ*.
k₂ is the unloading stiffness and δ₀ the residual indentation. W_l is the loading work, W_u the work
that the contact returns on unloading, and V the impact velocity:

    limit       δ* = k̂₂/(k̂₂ − k₁) φ_f 2R*,  with the residual indentation δ₀* = φ_f 2R*
    unloading   F = k₂(δ − δ₀),  k₂ = k₁ + (k̂₂ − k₁) min(x, 1),  δ₀ = min((1 − k₁/k₂) d, δ₀*)
    loading     F = k₁δ up to δ*, then F = k̂₂(δ − δ₀*); both end at F = k₂(d − δ₀)
    adhesion    F = −k_cδ from δ_min = k₂δ₀/(k₂ + k_c) to δ = 0
    work        W_l = ½k₂(d − δ₀)² + ½k₁ min(d, δ*) δ₀,  W_u = ½k₂(d − δ₀)² − ½ k_cδ_minδ₀
    impact      ½ m* V² = W_l, e² = W_u/W_l; if W_u ≤ 0, e = 0: the bodies stick at some δ > 0

2R* is Luding's 2a₁a₂/(a₁ + a₂): the radius of each of two equal spheres, or twice the radius of a
sphere on a wall. Without adhesion e = (k₁/k₂)^½ falls with growing d to its minimum (k₁/k̂₂)^½ at
d = δ*. Beyond δ*, e rises because the limit branch is elastic.

With k_c > 0 the contact ends at δ = 0; with k_c = 0 it ends at δ₀, where F = 0. The law is
quasi-static: the viscous term γ₀v of the paper is left out. The stiffnesses are parameters to be
fitted; φ_f 2R* is the only length scale.
Units, shapes and errors are those of `restitution.theory`.
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
    """Impact of bodies with linear elastic-plastic and adhesive springs.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        loading_stiffness: Stiffness k₁ of plastic loading (N/m).
        limit_stiffness: Stiffness k̂₂ of the elastic limit branch (N/m), at least k₁. If k̂₂ = k₁,
            the law is elastic.
        adhesive_stiffness: Stiffness k_c of the adhesive branch (N/m), at least 0.
        plasticity_depth: Plasticity depth φ_f (dimensionless): the largest residual indentation
            divided by 2R*.

    Raises:
        CaseError: A field is not finite or not in its range.

    Source:
        S. Luding, Granular Matter 10 (2008) 235–246.
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
        """Indentation δ* (m) beyond which first loading is elastic.

        It is infinite if the limit stiffness equals the loading stiffness.
        """
        k1, k2_hat = self.loading_stiffness, self.limit_stiffness
        with np.errstate(divide="ignore"):  # the result is infinite for equal stiffnesses
            return scalar_or_array(k2_hat / (k2_hat - k1) * self._limit_residual)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force on first loading: plastic up to `limit_indentation`, then elastic.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F (N), first k₁δ with the loading stiffness k₁ and then k̂₂(δ − δ₀*) with
            the limit stiffness k̂₂ and the largest residual indentation δ₀*.
        """
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        return k2 * (d - d0)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force on unloading after first loading to `maximum_indentation`.

        Above `maximum_indentation` the force is `loading_force`.

        Args:
            indentation: Approach δ of the spheres (m).
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Normal force F (N). Below `residual_indentation` it is negative (attractive), or 0 if
            the adhesive stiffness is 0.
        """
        d = touching(indentation)
        k2, d0 = self._unloading_line(maximum_indentation)
        unloading = np.maximum(k2 * (d - d0), -self.adhesive_stiffness * d)
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation at which the force is zero on unloading.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Residual indentation δ₀ (m).
        """
        return scalar_or_array(self._unloading_line(maximum_indentation)[1])

    def pull_off_force(self, maximum_indentation: Values) -> Array:
        """Largest attractive force on unloading.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Magnitude k_cδ_min of the force (N), with the adhesive stiffness k_c and the indentation
            δ_min at which the unloading line meets the adhesive branch.
        """
        k_c, (k2, d0) = self.adhesive_stiffness, self._unloading_line(maximum_indentation)
        return k_c * k2 / (k2 + k_c) * d0

    def loading_work(self, indentation: Values) -> Array:
        """Work done during first loading, from first touch to `indentation`.

        The elastic part of the work is ½k₂(δ − δ₀)², with the unloading stiffness k₂ and the
        residual indentation δ₀. The dissipated part is ½k₁ min(δ, δ*) δ₀, with the loading
        stiffness k₁ and the limit indentation δ*.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Loading work W_l = ∫F dδ (J).
        """
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        plastic = d / np.maximum(self._depth(d), 1.0)
        return 0.5 * k2 * (d - d0) ** 2 + 0.5 * self.loading_stiffness * plastic * d0

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work that the contact returns on unloading from `maximum_indentation` to δ = 0.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Unloading work W_u (J), negative if the bodies stick.
        """
        d = touching(maximum_indentation)
        k2, d0 = self._unloading_line(d)
        return 0.5 * k2 * (d - d0) ** 2 - 0.5 * self.pull_off_force(d) * d0

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation of an impact.

        With the loading stiffness k₁, the indentation is d₁ = V (m*/k₁)^½ if d₁ is at most the
        limit indentation δ*. Otherwise it is the root δ > δ* of k̂₂(δ − δ₀*)² = k₁(d₁² − δ*δ₀*),
        with the limit stiffness k̂₂ and the largest residual indentation δ₀*.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Indentation δ (m).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d1 = touching(velocity) * (m / k1) ** 0.5
        x = self._depth(d1)
        d_star, d0_star = d1 / np.maximum(x, 1.0), self._limit_residual
        released = touching(d1**2 - d_star * d0_star)
        limit = d0_star + (k1 / self.limit_stiffness * released) ** 0.5
        return scalar_or_array(np.where(x > 1, limit, d1))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e = (W_u/W_l)^½ (dimensionless), with the unloading work W_u
            and the loading work W_l; 0 if the bodies stick, 1 at zero or negative velocity.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        W_u = self.unloading_work(self.indentation_from_velocity(velocity, mass))
        return restitution_of_work(W_u, velocity, mass)

    @property
    def _limit_residual(self) -> Values:
        """Residual indentation δ₀* (m) after loading to `limit_indentation` or deeper."""
        return self.plasticity_depth * 2 * self.radius

    def _depth(self, indentation: Values) -> Array:
        """Indentation divided by `limit_indentation`; zero where this limit is infinite."""
        rise = 1 - self.loading_stiffness / self.limit_stiffness
        return touching(indentation) * rise / self._limit_residual

    def _unloading_line(self, maximum_indentation: Values) -> tuple[Array, Array]:
        """Unloading stiffness k₂ (N/m) and residual indentation δ₀ (m).

        Both hold for unloading from `maximum_indentation` (m).
        """
        d, k1 = touching(maximum_indentation), self.loading_stiffness
        k2 = k1 + (self.limit_stiffness - k1) * np.minimum(self._depth(d), 1.0)
        return k2, np.minimum((1 - k1 / k2) * d, self._limit_residual)
