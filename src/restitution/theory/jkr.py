"""Johnson, Kendall & Roberts (1971): elastic spheres that attract only where they touch.

K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301–313,
doi 10.1098/rspa.1971.0141; D. Maugis, *Contact, Adhesion and Rupture of Elastic Solids*, Springer
2000. With w the work of adhesion, Hertz less a flat punch (`kendall`) of the same contact radius a:

    F = 4E*a³/(3R*) − (8πE*wa³)^½,   δ = a²/R* − (2πwa/E*)^½

Forces are positive in compression and δ closes the contact; only `pull_off_force` is a magnitude.
With a_b = (πwR*²/8E*)^{1/3}, F_c = 3/2 πwR* and U = E*a_b⁵/R*², all is polynomial in s = (a/a_b)^½:

    δ = (s⁴ − 4s) a_b²/R*,   F = (s⁶ − 6s³) F_c/9
    U_el/U = 8/15 s¹⁰ − 16/3 s⁷ + 16 s⁴,   U_T = U_el − wπa² = U_el − 8 s⁴ U,   dU_T = F dδ

    s³ = 1    break at fixed grips, the smallest δ there is:  δ_b = −3a_b²/R*,  F = −5/9 F_c
    s³ = 3    pull-off at fixed load, the smallest F:  a_c = (9πwR*²/8E*)^{1/3},  F = −F_c
    s³ = 4    δ = 0, where an approaching pair jumps in:  F = −8/9 F_c
    s³ = 6    no load:  a = (9πwR*²/2E*)^{1/3}

s ≥ 1 is stable at fixed grips, s < 1 unstable. Functions of the contact radius hold on both
branches, functions of the indentation on the stable one: it exists from δ_b up, but a pair enters
it only by jumping in at δ = 0 (F is 0 before) and leaves it only at δ_b. Nothing touches below
δ_b, so all is 0 there. One cycle from apart to apart loses the same energy however deep it went,
what the jump in and the break shed,

    W_s = −∫ F dδ from δ_b to 0 = U_T(δ_b) − U_T(0) = 8/5 (2 + 3·4^{4/3}) U
        = 7.092 (w⁵R*⁴/E*²)^{1/3},

printed as 7.09 by Thornton & Ning, Powder Technology 99 (1998) 154–162.

Valid where Hertz is (a ≪ R*, nothing yields) and for forces of short range: the Tabor parameter
μ of `sticking` above 5, by the map of Johnson & Greenwood, J. Colloid Interface Sci. 192 (1997)
326–333. Pull-off comes near its JKR value long before the jump in does, for forces of finite range
act before touch: W_s needs a larger μ (Ciavarella, Greenwood & Barber, J. Mech. Phys. Solids 98
(2017) 236–244). Restitution is that of a quasi-static normal impact, V the velocity before the
jump in.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import math

import numpy as np

from ._inputs import Array, Values, positive, scalar_or_array, touching

_AT_BREAK = 16 / 5  # U_T/U at s = 1
_AT_JUMP_IN = -24 / 5 * 4 * math.cbrt(4)  # U_T/U at s³ = 4


def force(
    indentation: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Normal force F (N) on the stable branch, compressive positive; 0 below the break δ_b.

    −5/9 F_c at δ_b, −F_c at its least, −8/9 F_c at δ = 0. An approaching pair feels nothing
    before δ = 0; `loading_work` counts from there.
    """
    s = _root(indentation, radius, contact_modulus, work_of_adhesion)
    return pull_off_force(radius, work_of_adhesion) / 9 * s**3 * (s**3 - 6)


def contact_radius(
    indentation: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Contact radius a (m) on the stable branch, at least a_b; 0 below the break δ_b."""
    s = _root(indentation, radius, contact_modulus, work_of_adhesion)
    return break_radius(radius, contact_modulus, work_of_adhesion) * s**2


def force_at_contact_radius(
    contact_radius: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Normal force F(a) (N), compressive positive; both branches."""
    a = touching(contact_radius)
    R, E_star, w = positive(
        radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion
    )
    return 4 * E_star * a**3 / (3 * R) - (8 * np.pi * E_star * w) ** 0.5 * a**1.5


def indentation_at_contact_radius(
    contact_radius: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Indentation δ(a) (m), negative where the spheres are drawn apart; both branches."""
    a = touching(contact_radius)
    R, E_star, w = positive(
        radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion
    )
    return a**2 / R - (2 * np.pi * w * a / E_star) ** 0.5


def stored_energy_at_contact_radius(
    contact_radius: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Elastic energy U_el(a) (J); both branches.

    Press to a as Hertz does, then draw back at fixed contact by δ′ = (2πwa/E*)^½ against the
    stiffness 2E*a of a punch: U_el = 8E*a⁵/(15R*²) − 4E*a³δ′/(3R*) + E*aδ′².
    """
    a = touching(contact_radius)
    R, E_star, w = positive(
        radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion
    )
    drawn = (2 * np.pi * w * a / E_star) ** 0.5
    return E_star * a * (8 * a**4 / (15 * R**2) - 4 * a**2 * drawn / (3 * R) + drawn**2)


def total_energy_at_contact_radius(
    contact_radius: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Elastic and surface energy U_T(a) = U_el − wπa² (J), 0 when apart; dU_T/dδ = F."""
    a = touching(contact_radius)
    (w,) = positive(work_of_adhesion=work_of_adhesion)
    stored = stored_energy_at_contact_radius(a, radius, contact_modulus, work_of_adhesion)
    return stored - np.pi * w * a**2


def pull_off_force(radius: Values, work_of_adhesion: Values) -> Array:
    """F_c = 3/2 πwR* (N): the tension, as a magnitude, that parts the spheres at fixed load."""
    R, w = positive(radius=radius, work_of_adhesion=work_of_adhesion)
    return 1.5 * np.pi * w * R


def pull_off_radius(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """Contact radius a_c = (9πwR*²/8E*)^{1/3} (m) at the largest tension F_c."""
    return math.cbrt(9) * break_radius(radius, contact_modulus, work_of_adhesion)


def pull_off_indentation(
    radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Indentation −(3π²w²R*/64E*²)^{1/3} (m, negative) at the largest tension F_c."""
    return math.cbrt(1 / 9) * break_indentation(radius, contact_modulus, work_of_adhesion)


def break_force(radius: Values, work_of_adhesion: Values) -> Array:
    """Force −5/9 F_c (N) from which the contact breaks at fixed grips."""
    return -5 / 9 * pull_off_force(radius, work_of_adhesion)


def break_radius(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """Contact radius a_b = (πwR*²/8E*)^{1/3} (m) at the break; the stable branch is a ≥ a_b."""
    R, E_star, w = positive(
        radius=radius, contact_modulus=contact_modulus, work_of_adhesion=work_of_adhesion
    )
    a_b: Array = np.cbrt(np.pi / 8 * w * R**2 / E_star)
    return a_b


def break_indentation(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """Indentation δ_b = −3/4 (π²w²R*/E*²)^{1/3} (m, negative) at which the contact breaks."""
    (R,) = positive(radius=radius)
    return -3 * break_radius(radius, contact_modulus, work_of_adhesion) ** 2 / R


def jump_in_force(radius: Values, work_of_adhesion: Values) -> Array:
    """Force −8/9 F_c (N) right after the jump into contact at δ = 0."""
    return -8 / 9 * pull_off_force(radius, work_of_adhesion)


def zero_load_radius(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """Contact radius (9πwR*²/2E*)^{1/3} (m) of spheres held together by adhesion alone."""
    return math.cbrt(36) * break_radius(radius, contact_modulus, work_of_adhesion)


def loading_work(
    indentation: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Work W_l = ∫F dδ (J) from the jump in at δ = 0 to `indentation`; 0 where that is ≤ 0.

    Negative at small indentation, where adhesion still draws the spheres together.
    """
    s = _root(indentation, radius, contact_modulus, work_of_adhesion)
    U = _energy_unit(radius, contact_modulus, work_of_adhesion)
    W_l = U * (_total_energy(s) - _AT_JUMP_IN)
    return scalar_or_array(np.where(np.asarray(indentation) <= 0, 0.0, W_l))


def unloading_work(
    indentation: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """Work W_u = ∫F dδ (J) from the break to `indentation`, given back on the way apart.

    W_u = W_l − W_s. Negative where parting takes more work than was stored; 0 below the break.
    """
    s = _root(indentation, radius, contact_modulus, work_of_adhesion)
    U = _energy_unit(radius, contact_modulus, work_of_adhesion)
    return scalar_or_array(np.where(s == 0, 0.0, U * (_total_energy(s) - _AT_BREAK)))


def hysteresis_loss(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """Energy W_s = 7.092 (w⁵R*⁴/E*²)^{1/3} (J) lost in one cycle of contact, at any depth."""
    U = _energy_unit(radius, contact_modulus, work_of_adhesion)
    return (_AT_BREAK - _AT_JUMP_IN) * U


def impact_velocity(
    maximum_indentation: Values,
    radius: Values,
    contact_modulus: Values,
    work_of_adhesion: Values,
    mass: Values,
) -> Array:
    """Relative normal velocity V (m/s) that reaches `maximum_indentation`: ½ m* V² = W_l.

    NaN where W_l < 0: adhesion alone draws every impact deeper than that.
    """
    (m,) = positive(mass=mass)
    W_l = loading_work(maximum_indentation, radius, contact_modulus, work_of_adhesion)
    V = (2 * np.abs(W_l) / m) ** 0.5
    return scalar_or_array(np.where(W_l < 0, np.nan, V))


def restitution(
    velocity: Values,
    radius: Values,
    contact_modulus: Values,
    work_of_adhesion: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e = (1 − W_s/½m*V²)^½ after an impact at `velocity` (m/s).

    0 where the spheres stick, ½ m* V² ≤ W_s; 1 at and below zero velocity, where none approaches.
    The same number as `sticking.restitution` at `sticking.sticking_velocity`.
    """
    (m,) = positive(mass=mass)
    kinetic = 0.5 * m * touching(velocity) ** 2
    e = _restitution(kinetic, hysteresis_loss(radius, contact_modulus, work_of_adhesion))
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, e))


def restitution_at_indentation(
    maximum_indentation: Values,
    radius: Values,
    contact_modulus: Values,
    work_of_adhesion: Values,
) -> Array:
    """Coefficient of restitution e = (W_u/W_l)^½ after loading to `maximum_indentation` (m).

    0 where W_u ≤ 0 (they stick); 1 at and below zero indentation, where nothing has touched.
    """
    material = radius, contact_modulus, work_of_adhesion
    e = _restitution(loading_work(maximum_indentation, *material), hysteresis_loss(*material))
    return scalar_or_array(np.where(np.asarray(maximum_indentation) <= 0, 1.0, e))


def _restitution(work: Array, loss: Array) -> Array:
    """(1 − loss/work)^½, 0 where the loss is the greater."""
    e: Array = (1 - loss / np.maximum(work, loss)) ** 0.5
    return e


def _root(
    indentation: Values, radius: Values, contact_modulus: Values, work_of_adhesion: Values
) -> Array:
    """s = (a/a_b)^½ on the stable branch: the root s ≥ 1 of s⁴ − 4s = 3k; 0 below the break.

    With k = δ/|δ_b| ≥ −1, and p² half the one positive root of Ferrari's cubic y³ + 3ky = 2,
    s = p + (1/p − p²)^½. Cardano gives y = t − k/t with t³ = 1 + (1 + k³)^½; here it is written as
    2/(t² + k + k²/t²), which does not cancel at any depth.
    """
    d = np.asarray(indentation, dtype=np.float64)
    d_b = break_indentation(radius, contact_modulus, work_of_adhesion)
    above = np.maximum((d - d_b) / -d_b, 0.0)  # 1 + k, exactly 0 at the break
    k = above - 1
    t = np.cbrt(1 + (above * (1 - k + k**2)) ** 0.5)
    p = (t**2 + k + (k / t) ** 2) ** -0.5
    s = p + np.maximum(1 / p - p**2, 0.0) ** 0.5
    return scalar_or_array(np.where(d < d_b, 0.0, s))


def _energy_unit(radius: Values, contact_modulus: Values, work_of_adhesion: Values) -> Array:
    """U = E*a_b⁵/R*² (J)."""
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return E_star * break_radius(radius, contact_modulus, work_of_adhesion) ** 5 / R**2


def _total_energy(s: Array) -> Array:
    """U_T/U."""
    return s**4 * (8 / 15 * s**6 - 16 / 3 * s**3 + 8)
