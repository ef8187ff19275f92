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

import numpy as np

from ._inputs import Array, Values, between, positive, scalar_or_array, touching


def loading_force(indentation: Values, loading_stiffness: Values) -> Array:
    """Normal force (N) on first loading; `loading_stiffness` k₁ in N/m."""
    (k1,) = positive(loading_stiffness=loading_stiffness)
    return k1 * touching(indentation)


def unloading_force(
    indentation: Values,
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    hardening: Values,
) -> Array:
    """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

    Zero at and below `residual_indentation`. Above `maximum_indentation` the contact is loading
    again, and the force is `loading_force`.
    """
    d, springs = touching(indentation), (loading_stiffness, unloading_stiffness, hardening)
    k2 = _stiffness(maximum_indentation, *springs)
    unloading = k2 * touching(d - residual_indentation(maximum_indentation, *springs))
    beyond = d > touching(maximum_indentation)
    return scalar_or_array(np.where(beyond, loading_force(d, loading_stiffness), unloading))


def residual_indentation(
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    hardening: Values,
) -> Array:
    """Indentation δ₀ (m) at which unloading from `maximum_indentation` ends."""
    (k1,) = positive(loading_stiffness=loading_stiffness)
    k2 = _stiffness(maximum_indentation, loading_stiffness, unloading_stiffness, hardening)
    return (1 - k1 / k2) * touching(maximum_indentation)


def restitution(
    velocity: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    hardening: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e = (k₁/k₂)^½ after an impact at relative normal `velocity` (m/s).

    `loading_stiffness` k₁ and `unloading_stiffness` k_u in N/m, `hardening` S in 1/m. 1 at and
    below zero velocity, where none approaches.
    """
    k1, m = positive(loading_stiffness=loading_stiffness, mass=mass)
    d = touching(velocity) * (m / k1) ** 0.5
    e = (k1 / _stiffness(d, loading_stiffness, unloading_stiffness, hardening)) ** 0.5
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, e))


def _stiffness(
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    hardening: Values,
) -> Array:
    """k₂ (N/m)."""
    (k1,) = positive(loading_stiffness=loading_stiffness)
    (k_u,) = between(k1, np.inf, unloading_stiffness=unloading_stiffness)
    (S,) = between(0.0, np.inf, hardening=hardening)
    k2: Array = k_u + S * k1 * touching(maximum_indentation)
    return k2
