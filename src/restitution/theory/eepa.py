"""Edinburgh elasto-plastic adhesive model: power-law springs and a constant attraction."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import (
    Array,
    Values,
    keep_between,
    keep_positive,
    scalar_or_array,
    touching,
)
from ._roots import increasing_root
from .law import impact_energy, restitution_of_work


@dataclass(frozen=True, eq=False)
class EEPA:
    """Power-law springs with adhesion, unloaded from the indentation d::

        loading     F = f₀ + k₁δⁿ
        unloading   F = f₀ + k₂(δⁿ − δ_pⁿ),  δ_p = (1 − k₁/k₂)^{1/n} d
        adhesion    F = f₀ − k_adhδⁿ from δ_min = μd to δ = 0,  μⁿ = (k₂ − k₁)/(k₂ + k_adh)

    The contact begins and ends at δ = 0, where the force jumps between f₀ and zero; without
    adhesion it ends at δ_p. Some codes derive k_adh from a surface energy instead. The dashpot is
    left out. The stiffnesses are fitted; the law does not use R* and E*.

    Attributes:
        loading_stiffness: Stiffness k₁ of first loading (N/mⁿ, SI).
        unloading_stiffness: Stiffness k₂ of unloading (N/mⁿ, SI), at least k₁.
        adhesive_stiffness: Stiffness k_adh of the adhesive branch (N/mⁿ, SI), at least 0.
        constant_force: Constant force f₀ (N), at most 0 (attractive).
        exponent: Exponent n of all branches (dimensionless), at least 1.

    Source:
        J. P. Morrissey, thesis, University of Edinburgh (2013); S. C. Thakur et al., Granular
        Matter 16 (2014) 383–400.
    """

    loading_stiffness: Values
    unloading_stiffness: Values
    adhesive_stiffness: Values
    constant_force: Values
    exponent: Values

    def __post_init__(self) -> None:
        keep_positive(self, "loading_stiffness")
        keep_between(self, "unloading_stiffness", self.loading_stiffness)
        keep_between(self, "adhesive_stiffness", 0.0)
        keep_between(self, "constant_force", -np.inf, 0.0)
        keep_between(self, "exponent", 1.0)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force F (N) on first loading."""
        d = touching(indentation)
        F = self.constant_force + self.loading_stiffness * d**self.exponent
        return scalar_or_array(np.where(d == 0, 0.0, F))

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force F (N) on unloading from `maximum_indentation`; above it, `loading_force`."""
        d, d_max = touching(indentation), touching(maximum_indentation)
        k1, k2, k_adh = self._springs
        f0, n = self.constant_force, self.exponent
        unloading = f0 + np.maximum(k2 * d**n - (k2 - k1) * d_max**n, -k_adh * d**n)
        onwards = (d > d_max) | (d == 0)
        return scalar_or_array(np.where(onwards, self.loading_force(d), unloading))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ_p (m) at which the force has fallen to the constant force on unloading."""
        remaining = 1 - self.loading_stiffness / self.unloading_stiffness
        return remaining ** (1 / self.exponent) * touching(maximum_indentation)

    def pull_off_force(self, maximum_indentation: Values) -> Array:
        """Magnitude k_adh δ_minⁿ − f₀ (N) of the largest attraction on unloading."""
        d, (k1, k2, k_adh) = touching(maximum_indentation), self._springs
        F_c = k_adh * (k2 - k1) / (k2 + k_adh) * d**self.exponent - self.constant_force
        return scalar_or_array(np.where(d == 0, 0.0, F_c))

    def loading_work(self, indentation: Values) -> Array:
        """Loading work W_l = ∫F dδ (J), negative where the constant force draws the bodies in."""
        d, n = touching(indentation), self.exponent
        return self.constant_force * d + self.loading_stiffness * d ** (n + 1) / (n + 1)

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) returned on unloading to δ = 0, negative if the bodies stick."""
        d, n = touching(maximum_indentation), self.exponent
        k1, k2, k_adh = self._springs
        mu = ((k2 - k1) / (k2 + k_adh)) ** (1 / n)
        k_u = k2 - (n + 1) * (k2 - k1) + n * (k2 + k_adh) * mu ** (n + 1)
        return self.constant_force * d + k_u * d ** (n + 1) / (n + 1)

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation δ (m) of an impact."""
        k1, f0, n = self.loading_stiffness, self.constant_force, self.exponent
        K = impact_energy(velocity, mass)
        a, b = ((n + 1) * K / k1) ** (1 / (n + 1)), (-(n + 1) * f0 / k1) ** (1 / n)
        d = increasing_root(lambda d: self.loading_work(d) - K, np.maximum(a, b), a + b)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ (dimensionless)."""
        W_u = self.unloading_work(self.indentation_from_velocity(velocity, mass))
        return restitution_of_work(W_u, velocity, mass)

    @property
    def _springs(self) -> tuple[Values, Values, Values]:
        return self.loading_stiffness, self.unloading_stiffness, self.adhesive_stiffness
