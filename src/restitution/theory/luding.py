"""Luding (2008): linear springs, plastic up to a limit indentation, with linear adhesion."""

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
    """Linear springs with adhesion, unloaded from the indentation d.

    With δ* = k̂₂/(k̂₂ − k₁) φ_f 2R* and δ₀* = φ_f 2R*::

        loading     F = k₁δ up to δ*, then F = k̂₂(δ − δ₀*)
        unloading   F = k₂(δ − δ₀),  k₂ = k₁ + (k̂₂ − k₁) min(d/δ*, 1),  δ₀ = min((1 − k₁/k₂) d, δ₀*)
        adhesion    F = −k_cδ from δ_min = k₂δ₀/(k₂ + k_c) to δ = 0

    2R* is Luding's 2a₁a₂/(a₁ + a₂). The contact ends at δ = 0, or at δ₀ if k_c = 0. The law is
    quasi-static: the viscous term of the paper is left out. The stiffnesses are fitted.

    Attributes:
        radius: Reduced radius R* (m).
        loading_stiffness: Stiffness k₁ of plastic loading (N/m).
        limit_stiffness: Stiffness k̂₂ of the elastic limit branch (N/m), at least k₁ (elastic).
        adhesive_stiffness: Stiffness k_c of the adhesive branch (N/m), at least 0.
        plasticity_depth: Plasticity depth φ_f (dimensionless): the largest residual indentation
            divided by 2R*.

    Source:
        S. Luding, Granular Matter 10 (2008) 235–246; the limit branch: A. Singh, V. Magnanimo, S.
        Luding, arXiv:1503.03720.
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
        """Indentation δ* (m) beyond which first loading is elastic; infinite if k̂₂ = k₁."""
        k1, k2_hat = self.loading_stiffness, self.limit_stiffness
        with np.errstate(divide="ignore"):  # the result is infinite for equal stiffnesses
            return scalar_or_array(k2_hat / (k2_hat - k1) * self._limit_residual)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force F (N) on first loading: plastic up to `limit_indentation`, then elastic."""
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        return k2 * (d - d0)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force F (N) on unloading from `maximum_indentation`; above it, `loading_force`."""
        d = touching(indentation)
        k2, d0 = self._unloading_line(maximum_indentation)
        unloading = np.maximum(k2 * (d - d0), -self.adhesive_stiffness * d)
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ₀ (m) at which the force is zero on unloading."""
        return scalar_or_array(self._unloading_line(maximum_indentation)[1])

    def pull_off_force(self, maximum_indentation: Values) -> Array:
        """Magnitude k_cδ_min (N) of the largest attraction on unloading."""
        k_c, (k2, d0) = self.adhesive_stiffness, self._unloading_line(maximum_indentation)
        return k_c * k2 / (k2 + k_c) * d0

    def loading_work(self, indentation: Values) -> Array:
        """Loading work W_l = ∫F dδ (J)."""
        d = touching(indentation)
        k2, d0 = self._unloading_line(d)
        plastic = d / np.maximum(self._depth(d), 1.0)
        return 0.5 * k2 * (d - d0) ** 2 + 0.5 * self.loading_stiffness * plastic * d0

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) returned on unloading to δ = 0, negative if the bodies stick."""
        d = touching(maximum_indentation)
        k2, d0 = self._unloading_line(d)
        return 0.5 * k2 * (d - d0) ** 2 - 0.5 * self.pull_off_force(d) * d0

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation δ (m) of an impact."""
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d1 = touching(velocity) * (m / k1) ** 0.5
        x = self._depth(d1)
        d_star, d0_star = d1 / np.maximum(x, 1.0), self._limit_residual
        released = touching(d1**2 - d_star * d0_star)
        limit = d0_star + (k1 / self.limit_stiffness * released) ** 0.5
        return scalar_or_array(np.where(x > 1, limit, d1))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ (dimensionless)."""
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
        """Unloading stiffness k₂ (N/m) and residual indentation δ₀ (m)."""
        d, k1 = touching(maximum_indentation), self.loading_stiffness
        k2 = k1 + (self.limit_stiffness - k1) * np.minimum(self._depth(d), 1.0)
        return k2, np.minimum((1 - k1 / k2) * d, self._limit_residual)
