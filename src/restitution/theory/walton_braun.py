"""Walton & Braun (1986): linear, partially latched springs; unloading is stiffer than loading."""

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


@dataclass(frozen=True, eq=False)
class WaltonBraun:
    """Partially latched springs: F = k₁δ on loading, F = k₂(δ − δ₀) on unloading; e² = k₁/k₂.

    k₂ = k_u + S k₁δ_max. The contact ends at δ₀ = δ_max (1 − k₁/k₂) > 0. There is no adhesion. The
    stiffnesses are fitted; the law does not use R* and E*.

    Attributes:
        loading_stiffness: Stiffness k₁ of first loading (N/m).
        unloading_stiffness: Unloading stiffness k_u (N/m) in the limit of small forces, at least
            k₁.
        hardening: Increase S of the unloading stiffness with the largest force (1/m), at least 0.

    Source:
        O. R. Walton, R. L. Braun, J. Rheology 30 (1986) 949–980.
    """

    loading_stiffness: Values
    unloading_stiffness: Values
    hardening: Values

    def __post_init__(self) -> None:
        keep_positive(self, "loading_stiffness")
        keep_between(self, "unloading_stiffness", self.loading_stiffness)
        keep_between(self, "hardening", 0.0)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force F (N) on first loading."""
        return self.loading_stiffness * touching(indentation)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force F (N) on unloading from `maximum_indentation`; above it, `loading_force`."""
        d, k2 = touching(indentation), self._stiffness(maximum_indentation)
        unloading = k2 * touching(d - self.residual_indentation(maximum_indentation))
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ₀ (m) at which unloading ends."""
        k2 = self._stiffness(maximum_indentation)
        return (1 - self.loading_stiffness / k2) * touching(maximum_indentation)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (k₁/k₂)^½ (dimensionless)."""
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d = touching(velocity) * (m / k1) ** 0.5
        e = (k1 / self._stiffness(d)) ** 0.5
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, e))

    def _stiffness(self, maximum_indentation: Values) -> Array:
        d = touching(maximum_indentation)
        return self.unloading_stiffness + self.hardening * self.loading_stiffness * d
