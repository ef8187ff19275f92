"""Walton & Braun (1986): linear, partially latched springs; unloading is stiffer than loading.

O. R. Walton, R. L. Braun, J. Rheology 30 (1986) 949–980. First loading has stiffness k₁. Unloading
and reloading have a larger stiffness k₂, which may grow with the largest force F_max so far:

    loading     F = k₁δ
    unloading   F = k₂(δ − δ₀),  δ₀ = δ_max (1 − k₁/k₂),  k₂ = k_u + S F_max,  F_max = k₁δ_max
    impact      δ_max = V (m*/k₁)^½,  e² = W_u/W_l = k₁/k₂

Here k_u and S are constants, δ_max is the largest indentation, and unloading ends at the residual
indentation δ₀. The paper uses two special cases. With S = 0 the unloading stiffness is constant and
e = (k₁/k_u)^½ at any velocity. With k_u = k₁ the unloading stiffness grows from k₁ and
e = (1 + S V (m*/k₁)^½)^{−½}. The paper considers two equal spheres of mass m and writes (m*/k₁)^½
as 1/ω₀, where ω₀ = (2k₁/m)^½.

The contact ends where F returns to zero, at δ₀ > 0, not at δ = 0. There is no adhesion. The
stiffnesses are parameters to be fitted; the law does not use R* and E*.
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


@dataclass(frozen=True, eq=False)
class WaltonBraun:
    """Impact of bodies with partially latched springs.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        loading_stiffness: Stiffness k₁ of first loading (N/m).
        unloading_stiffness: Unloading stiffness k_u (N/m) in the limit of small forces, at least
            k₁.
        hardening: Increase S of the unloading stiffness with the largest force (1/m, which is N/m
            per N), at least 0.

    Raises:
        CaseError: A field is not finite or not in its range.

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
        """Normal force on first loading.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F = k₁δ (N).
        """
        return self.loading_stiffness * touching(indentation)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force on unloading after first loading to `maximum_indentation`.

        Above `maximum_indentation` the force is `loading_force`.

        Args:
            indentation: Approach δ of the spheres (m).
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Normal force F (N); 0 at and below `residual_indentation`.
        """
        d, k2 = touching(indentation), self._stiffness(maximum_indentation)
        unloading = k2 * touching(d - self.residual_indentation(maximum_indentation))
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation at which unloading ends.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Residual indentation δ₀ (m).
        """
        k2 = self._stiffness(maximum_indentation)
        return (1 - self.loading_stiffness / k2) * touching(maximum_indentation)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e = (k₁/k₂)^½ (dimensionless), with the stiffnesses k₁ of
            loading and k₂ of unloading; 1 at zero or negative velocity.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d = touching(velocity) * (m / k1) ** 0.5
        e = (k1 / self._stiffness(d)) ** 0.5
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, e))

    def _stiffness(self, maximum_indentation: Values) -> Array:
        """Unloading stiffness k₂ (N/m) after first loading to `maximum_indentation`."""
        d = touching(maximum_indentation)
        return self.unloading_stiffness + self.hardening * self.loading_stiffness * d
