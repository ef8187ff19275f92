"""EEPA, the Edinburgh elasto-plastic adhesive model: power-law springs and a constant attraction.

J. P. Morrissey, thesis, University of Edinburgh (2013); S. C. Thakur, J. P. Morrissey, J. Sun, J.
F. Chen, J. Y. Ooi, Granular Matter 16 (2014) 383–400. The stiffnesses are k₁ (loading), k₂
(unloading) and k_adh (adhesion). The exponent n is the same for all branches (1: linear, 3/2:
Hertz-like). f₀ ≤ 0 is the constant force and d = δ_max the largest indentation. At δ_p the
unloading force has fallen to f₀. At δ_min the unloading branch meets the adhesive branch. W_l is
the loading work, W_u the work that the contact returns on unloading, and V the impact velocity:

    loading     F = f₀ + k₁δⁿ
    unloading   F = f₀ + k₂(δⁿ − δ_pⁿ),  δ_p = (1 − k₁/k₂)^{1/n} d
    adhesion    F = f₀ − k_adhδⁿ from δ_min = μd to δ = 0,  μⁿ = (k₂ − k₁)/(k₂ + k_adh)
    work        W_l = f₀d + k₁d^{n+1}/(n + 1)
                W_u = f₀d + [k₂ − (n + 1)(k₂ − k₁) + n(k₂ + k_adh) μ^{n+1}] d^{n+1}/(n + 1)
    impact      ½ m* V² = W_l, e² = W_u/W_l; if W_u ≤ 0, e = 0: the bodies stick at some δ > 0

The contact begins and ends at δ = 0, where the force jumps between f₀ and zero. Without adhesion
(f₀ = 0, k_adh = 0) the contact ends at δ_p, where F = 0, and e does not depend on velocity:
e² = [1 − (n + 1)q + n q^{1+1/n}] k₂/k₁ with q = 1 − k₁/k₂. For n = 1, e² = k₁/k₂.

Here k_adh is a constant. Some codes (EDEM, PFC, LIGGGHTS by default) derive k_adh from a surface
energy, so that k_adh depends on δ_p. The exponent of their adhesive branch (Morrissey's χ) can
differ from n. The dashpot of the model is left out. The stiffnesses are parameters to be fitted;
the law does not use R* and E*.
Units, shapes and errors are those of `restitution.theory`, with stiffness in N/mⁿ.
"""

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
    """Impact of bodies with the Edinburgh elasto-plastic adhesive model.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        loading_stiffness: Stiffness k₁ of first loading (N/mⁿ, SI).
        unloading_stiffness: Stiffness k₂ of unloading (N/mⁿ, SI), at least k₁.
        adhesive_stiffness: Stiffness k_adh of the adhesive branch (N/mⁿ, SI), at least 0.
        constant_force: Constant force f₀ (N), at most 0 (attractive).
        exponent: Exponent n of all branches (dimensionless), at least 1.

    Raises:
        CaseError: A field is not finite or not in its range.

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
        """Normal force on first loading.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F (N). It jumps from 0 to the constant force f₀ at first touch.
        """
        d = touching(indentation)
        F = self.constant_force + self.loading_stiffness * d**self.exponent
        return scalar_or_array(np.where(d == 0, 0.0, F))

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force on unloading after first loading to `maximum_indentation`.

        Above `maximum_indentation` the force is `loading_force`.

        Args:
            indentation: Approach δ of the spheres (m).
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Normal force F (N), negative if attractive.
        """
        d, d_max = touching(indentation), touching(maximum_indentation)
        k1, k2, k_adh = self._springs
        f0, n = self.constant_force, self.exponent
        unloading = f0 + np.maximum(k2 * d**n - (k2 - k1) * d_max**n, -k_adh * d**n)
        onwards = (d > d_max) | (d == 0)
        return scalar_or_array(np.where(onwards, self.loading_force(d), unloading))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation at which the force has fallen to the constant force f₀ on unloading.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Residual indentation δ_p (m).
        """
        remaining = 1 - self.loading_stiffness / self.unloading_stiffness
        return remaining ** (1 / self.exponent) * touching(maximum_indentation)

    def pull_off_force(self, maximum_indentation: Values) -> Array:
        """Largest attractive force on unloading.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Magnitude k_adh δ_minⁿ − f₀ of the force (N), where δ_min is the indentation at which
            the unloading branch meets the adhesive branch; 0 if `maximum_indentation` ≤ 0.
        """
        d, (k1, k2, k_adh) = touching(maximum_indentation), self._springs
        F_c = k_adh * (k2 - k1) / (k2 + k_adh) * d**self.exponent - self.constant_force
        return scalar_or_array(np.where(d == 0, 0.0, F_c))

    def loading_work(self, indentation: Values) -> Array:
        """Work done from first touch to an indentation on first loading.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Loading work W_l = ∫F dδ (J), negative where the constant force draws the bodies
            together.
        """
        d, n = touching(indentation), self.exponent
        return self.constant_force * d + self.loading_stiffness * d ** (n + 1) / (n + 1)

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work that the contact returns on unloading from `maximum_indentation` to δ = 0.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Unloading work W_u (J), negative if the bodies stick.
        """
        d, n = touching(maximum_indentation), self.exponent
        k1, k2, k_adh = self._springs
        mu = ((k2 - k1) / (k2 + k_adh)) ** (1 / n)
        k_u = k2 - (n + 1) * (k2 - k1) + n * (k2 + k_adh) * mu ** (n + 1)
        return self.constant_force * d + k_u * d ** (n + 1) / (n + 1)

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation of an impact.

        The indentation is the root of W_l(δ) = K, where W_l is the loading work and K = ½m*V² the
        impact energy. k₁ is the loading stiffness, n the exponent and f₀ the constant force. For
        f₀ = 0 the root is a = ((n + 1) K/k₁)^{1/(n+1)}, and for K = 0 it is
        b = (−(n + 1) f₀/k₁)^{1/n}. In general the root lies between max(a, b) and a + b.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Indentation δ (m).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        k1, f0, n = self.loading_stiffness, self.constant_force, self.exponent
        K = impact_energy(velocity, mass)
        a, b = ((n + 1) * K / k1) ** (1 / (n + 1)), (-(n + 1) * f0 / k1) ** (1 / n)
        d = increasing_root(lambda d: self.loading_work(d) - K, np.maximum(a, b), a + b)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))

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
    def _springs(self) -> tuple[Values, Values, Values]:
        """Stiffnesses k₁ of loading, k₂ of unloading and k_adh of the adhesive branch (N/mⁿ)."""
        return self.loading_stiffness, self.unloading_stiffness, self.adhesive_stiffness
