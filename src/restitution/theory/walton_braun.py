"""Walton & Braun (1986): two springs, the stiffer one for unloading; partially latched.

O. R. Walton, R. L. Braun, J. Rheology 30 (1986) 949–980. First loading follows k₁; unloading and
reloading a stiffer k₂, which may grow with the largest force F_max so far:

    loading     F = k₁δ
    unloading   F = k₂(δ − δ₀),  δ₀ = δ_max (1 − k₁/k₂),  k₂ = k_u + S F_max,  F_max = k₁δ_max
    impact      δ_max = V (m*/k₁)^½,  e² = W_u/W_l = k₁/k₂

Two laws of the paper are special cases. S = 0 is its constant law, e = (k₁/k_u)^½ at any velocity.
k_u = k₁ is its variable law, e = (1 + S V (m*/k₁)^½)^{−½}; the paper writes the root with
ω₀ = (2k₁/m)^½, which for two equal spheres of mass m is (k₁/m*)^½.

The contact ends where F returns to zero, at δ₀ > 0, and not at δ = 0. No adhesion and no scale of
length: the springs are parameters to be fitted, and R* and E* do not enter.
Units, shapes and errors are those of `restitution.theory`; here k_u must not be below k₁, and S may
be zero.
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
    """Springs `loading_stiffness` k₁ and `unloading_stiffness` k_u (N/m), `hardening` S (1/m)."""

    loading_stiffness: Values
    unloading_stiffness: Values
    hardening: Values

    def __post_init__(self) -> None:
        keep_positive(self, "loading_stiffness")
        keep_between(self, "unloading_stiffness", self.loading_stiffness)
        keep_between(self, "hardening", 0.0)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force (N) on first loading."""
        return self.loading_stiffness * touching(indentation)

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

        Zero at and below `residual_indentation`. Above `maximum_indentation` the contact is loading
        again, and the force is `loading_force`.
        """
        d, k2 = touching(indentation), self._stiffness(maximum_indentation)
        unloading = k2 * touching(d - self.residual_indentation(maximum_indentation))
        beyond = d > touching(maximum_indentation)
        return scalar_or_array(np.where(beyond, self.loading_force(d), unloading))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ₀ (m) at which unloading from `maximum_indentation` ends."""
        k2 = self._stiffness(maximum_indentation)
        return (1 - self.loading_stiffness / k2) * touching(maximum_indentation)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (k₁/k₂)^½ after an impact at `velocity` (m/s).

        1 at and below zero velocity, where none approaches.
        """
        (m,), k1 = positive(mass=mass), self.loading_stiffness
        d = touching(velocity) * (m / k1) ** 0.5
        e = (k1 / self._stiffness(d)) ** 0.5
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, e))

    def _stiffness(self, maximum_indentation: Values) -> Array:
        """k₂ (N/m)."""
        d = touching(maximum_indentation)
        return self.unloading_stiffness + self.hardening * self.loading_stiffness * d
