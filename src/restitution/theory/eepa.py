"""EEPA, the Edinburgh elasto-plastic adhesive model: power-law springs and a constant attraction.

J. P. Morrissey, thesis, University of Edinburgh (2013); S. C. Thakur, J. P. Morrissey, J. Sun,
J. F. Chen, J. Y. Ooi, Granular Matter 16 (2014) 383–400. With the springs k₁ (loading), k₂
(unloading) and k_adh (adhesion), one exponent n for all (1: linear, 3/2: Hertz-like), the constant
f₀ ≤ 0 and d = δ_max:

    loading     F = f₀ + k₁δⁿ
    unloading   F = f₀ + k₂(δⁿ − δ_pⁿ),  δ_p = (1 − k₁/k₂)^{1/n} d
    adhesion    F ≥ f₀ − k_adhδⁿ, reached at δ_min = μd,  μⁿ = (k₂ − k₁)/(k₂ + k_adh)
    work        W_l = f₀d + k₁d^{n+1}/(n + 1)
                W_u = f₀d + [k₂ − (n + 1)(k₂ − k₁) + n(k₂ + k_adh) μ^{n+1}] d^{n+1}/(n + 1)
    impact      ½ m* V² = W_l, e² = W_u/W_l, 0 where W_u ≤ 0: stuck, in contact at δ > 0

The contact begins and ends at δ = 0, where the force jumps between f₀ and zero; without any
adhesion nothing acts below δ_p and it ends at F = 0 there. Then e does not depend on velocity:
e² = [1 − (n + 1)q + n q^{1+1/n}] k₂/k₁ with q = 1 − k₁/k₂, which is k₁/k₂ for n = 1.

k_adh is a constant here. Codes that derive it from a surface energy (EDEM, PFC, LIGGGHTS' default)
make it a function of δ_p, and the exponent of their adhesive branch (Morrissey's χ) may differ from
n; the dashpot is left out. The springs are parameters to be fitted; R* and E* do not enter.
Units, shapes and errors are those of `restitution.theory`, with stiffness in N/mⁿ; here k₂ must not
be below k₁ nor n below 1, and k_adh and f₀ may be zero.
"""

from __future__ import annotations

import numpy as np

from ._inputs import Array, Values, between, positive, scalar_or_array, touching
from ._roots import increasing_root


def loading_force(
    indentation: Values, loading_stiffness: Values, constant_force: Values, exponent: Values
) -> Array:
    """Normal force (N) on first loading; f₀ alone as soon as they touch."""
    d = touching(indentation)
    (k1,) = positive(loading_stiffness=loading_stiffness)
    f0, n = _shape(constant_force, exponent)
    return scalar_or_array(np.where(d == 0, 0.0, f0 + k1 * d**n))


def unloading_force(
    indentation: Values,
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    adhesive_stiffness: Values,
    constant_force: Values,
    exponent: Values,
) -> Array:
    """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

    Above `maximum_indentation` the contact is loading again, and the force is `loading_force`.
    """
    d, d_max = touching(indentation), touching(maximum_indentation)
    k1, k2, k_adh = _springs(loading_stiffness, unloading_stiffness, adhesive_stiffness)
    f0, n = _shape(constant_force, exponent)
    unloading = f0 + np.maximum(k2 * d**n - (k2 - k1) * d_max**n, -k_adh * d**n)
    loading = loading_force(d, loading_stiffness, constant_force, exponent)
    return scalar_or_array(np.where((d > d_max) | (d == 0), loading, unloading))


def residual_indentation(
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    exponent: Values,
) -> Array:
    """Indentation δ_p (m) at which the force of unloading from `maximum_indentation` is f₀."""
    k1, k2, _ = _springs(loading_stiffness, unloading_stiffness, 0.0)
    _, n = _shape(0.0, exponent)
    return (1 - k1 / k2) ** (1 / n) * touching(maximum_indentation)


def pull_off_force(
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    adhesive_stiffness: Values,
    constant_force: Values,
    exponent: Values,
) -> Array:
    """Greatest attraction k_adhδ_minⁿ − f₀ (N, positive) on unloading from `maximum_indentation`.

    Zero where nothing has touched.
    """
    d = touching(maximum_indentation)
    k1, k2, k_adh = _springs(loading_stiffness, unloading_stiffness, adhesive_stiffness)
    f0, n = _shape(constant_force, exponent)
    F_c = k_adh * (k2 - k1) / (k2 + k_adh) * d**n - f0
    return scalar_or_array(np.where(d == 0, 0.0, F_c))


def loading_work(
    indentation: Values, loading_stiffness: Values, constant_force: Values, exponent: Values
) -> Array:
    """Work W_l = ∫F dδ (J) from first touch to `indentation`; negative where f₀ draws them in."""
    d = touching(indentation)
    (k1,) = positive(loading_stiffness=loading_stiffness)
    f0, n = _shape(constant_force, exponent)
    return f0 * d + k1 * d ** (n + 1) / (n + 1)


def unloading_work(
    maximum_indentation: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    adhesive_stiffness: Values,
    constant_force: Values,
    exponent: Values,
) -> Array:
    """Work W_u (J) given back from `maximum_indentation` to δ = 0; negative where they stick."""
    d = touching(maximum_indentation)
    k1, k2, k_adh = _springs(loading_stiffness, unloading_stiffness, adhesive_stiffness)
    f0, n = _shape(constant_force, exponent)
    mu = ((k2 - k1) / (k2 + k_adh)) ** (1 / n)
    k_u = k2 - (n + 1) * (k2 - k1) + n * (k2 + k_adh) * mu ** (n + 1)
    return f0 * d + k_u * d ** (n + 1) / (n + 1)


def indentation_from_velocity(
    velocity: Values,
    loading_stiffness: Values,
    constant_force: Values,
    exponent: Values,
    mass: Values,
) -> Array:
    """Largest indentation (m) of an impact at relative normal `velocity` (m/s).

    With K = ½m*V², the root lies between the greater and the sum of a = ((n + 1) K/k₁)^{1/(n+1)},
    the depth without f₀, and b = (−(n + 1) f₀/k₁)^{1/n}, the depth that f₀ alone draws to.
    """
    k1, m = positive(loading_stiffness=loading_stiffness, mass=mass)
    f0, n = _shape(constant_force, exponent)
    K = 0.5 * m * touching(velocity) ** 2
    a, b = ((n + 1) * K / k1) ** (1 / (n + 1)), (-(n + 1) * f0 / k1) ** (1 / n)
    d = increasing_root(
        lambda d: loading_work(d, loading_stiffness, constant_force, exponent) - K,
        np.maximum(a, b),
        a + b,
    )
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))


def restitution(
    velocity: Values,
    loading_stiffness: Values,
    unloading_stiffness: Values,
    adhesive_stiffness: Values,
    constant_force: Values,
    exponent: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e = (W_u/W_l)^½ after an impact at `velocity` (m/s).

    `loading_stiffness` k₁, `unloading_stiffness` k₂ and `adhesive_stiffness` k_adh in N/mⁿ,
    `constant_force` f₀ ≤ 0 in N. 0 where they stick; 1 at and below zero velocity, where none
    approaches.
    """
    (m,) = positive(mass=mass)
    d = indentation_from_velocity(velocity, loading_stiffness, constant_force, exponent, mass)
    springs = loading_stiffness, unloading_stiffness, adhesive_stiffness
    W_u = unloading_work(d, *springs, constant_force, exponent)
    none = np.asarray(velocity) <= 0
    W_l = 0.5 * m * touching(velocity) ** 2
    e = (touching(W_u) / np.where(W_l > 0, W_l, 1.0)) ** 0.5
    return scalar_or_array(np.where(none, 1.0, np.minimum(e, 1.0)))


def _springs(
    loading_stiffness: Values, unloading_stiffness: Values, adhesive_stiffness: Values
) -> tuple[Array, Array, Array]:
    """k₁, k₂ and k_adh (N/mⁿ)."""
    (k1,) = positive(loading_stiffness=loading_stiffness)
    (k2,) = between(k1, np.inf, unloading_stiffness=unloading_stiffness)
    (k_adh,) = between(0.0, np.inf, adhesive_stiffness=adhesive_stiffness)
    return k1, k2, k_adh


def _shape(constant_force: Values, exponent: Values) -> tuple[Array, Array]:
    """f₀ (N) and n."""
    (f0,) = between(-np.inf, 0.0, constant_force=constant_force)
    (n,) = between(1.0, np.inf, exponent=exponent)
    return f0, n
