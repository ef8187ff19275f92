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

s ≥ 1 is stable at fixed grips, s < 1 unstable. Methods of the contact radius hold on both
branches, methods of the indentation on the stable one: it exists from δ_b up, but a pair enters
it only by jumping in at δ = 0 (F is 0 before) and leaves it only at δ_b. Nothing touches below
δ_b, so all is 0 there. One cycle from apart to apart loses the same energy however deep it went,
what the jump in and the break shed,

    W_s = −∫ F dδ from δ_b to 0 = U_T(δ_b) − U_T(0) = 8/5 (2 + 3·4^{4/3}) U
        = 7.092 (w⁵R*⁴/E*²)^{1/3},

printed as 7.09 by Thornton & Ning, Powder Technology 99 (1998) 154–162.

With V the velocity before the jump in, an elastic impact of reduced mass m* sticks up to V_s:

    ½ m* V_s² = W_s:  V_s = (14.18/m*)^½ (w⁵R*⁴/E*²)^{1/6},   e² = 1 − (V_s/V)², 0 for V ≤ V_s

(the same authors print 14.18; 2 × 7.092 = 14.184 exactly, used here).

Valid for quasi-static normal impacts where Hertz is (a ≪ R*, nothing yields: V and V_s below
`FirstYield.velocity`) and for forces of short range, that is for a large Tabor parameter

    μ = (R*w²/(E*²z₀³))^{1/3}

(D. Tabor, J. Colloid Interface Sci. 58 (1977) 2–13), the neck JKR draws out over the range z₀ of
the forces. μ > 5 is JKR, μ < 0.1 DMT or rigid (Johnson & Greenwood, J. Colloid Interface Sci. 192
(1997) 326–333). Pull-off comes near its JKR value long before the jump in does, for forces of
finite range act before touch: W_s needs a larger μ (Ciavarella, Greenwood & Barber, J. Mech. Phys.
Solids 98 (2017) 236–244). Small hard particles have a small μ, and then stick less than V_s says.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, Values, keep_positive, positive, scalar_or_array, touching
from .hertz import Hertz
from .kendall import Kendall

_AT_BREAK = 16 / 5  # U_T/U at s = 1
_AT_JUMP_IN = -24 / 5 * 4 * math.cbrt(4)  # U_T/U at s³ = 4


@dataclass(frozen=True, eq=False)
class JKR:
    """Elastic spheres that adhere with `work_of_adhesion` w (J/m²) where they touch.

    `radius` is R* (m), `contact_modulus` E* (Pa).
    """

    radius: Values
    contact_modulus: Values
    work_of_adhesion: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "work_of_adhesion")

    def force(self, indentation: Values) -> Array:
        """Normal force F (N) on the stable branch, compressive positive; 0 below the break δ_b.

        −5/9 F_c at δ_b, −F_c at its least, −8/9 F_c at δ = 0. An approaching pair feels nothing
        before δ = 0; `loading_work` counts from there.
        """
        s = self._root(indentation)
        return self.pull_off_force / 9 * s**3 * (s**3 - 6)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a (m) on the stable branch, at least a_b; 0 below the break δ_b."""
        return self.break_radius * self._root(indentation) ** 2

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force F(a) (N), compressive positive; both branches."""
        pressed = self._pressed.force_at_contact_radius(contact_radius)
        return pressed - self._drawn.pull_off_force(contact_radius)

    def indentation_at_contact_radius(self, contact_radius: Values) -> Array:
        """Indentation δ(a) (m), negative where the spheres are drawn apart; both branches."""
        a = touching(contact_radius)
        return a**2 / self.radius - self._drawn.pull_off_displacement(a)

    def stored_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Elastic energy U_el(a) (J); both branches.

        Press to a as Hertz does, then draw back at fixed contact by δ′ = (2πwa/E*)^½ against the
        stiffness 2E*a of a punch: U_el = 8E*a⁵/(15R*²) − 4E*a³δ′/(3R*) + E*aδ′².
        """
        R, E_star, a = self.radius, self.contact_modulus, touching(contact_radius)
        drawn = self._drawn.pull_off_displacement(a)
        return E_star * a * (8 * a**4 / (15 * R**2) - 4 * a**2 * drawn / (3 * R) + drawn**2)

    def total_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Elastic and surface energy U_T(a) = U_el − wπa² (J), 0 when apart; dU_T/dδ = F."""
        a = touching(contact_radius)
        return self.stored_energy_at_contact_radius(a) - np.pi * self.work_of_adhesion * a**2

    @property
    def pull_off_force(self) -> Array:
        """F_c = 3/2 πwR* (N): the tension, as a magnitude, that parts the spheres at fixed load."""
        return scalar_or_array(1.5 * np.pi * self.work_of_adhesion * self.radius)

    @property
    def pull_off_radius(self) -> Array:
        """Contact radius a_c = (9πwR*²/8E*)^{1/3} (m) at the largest tension F_c."""
        return math.cbrt(9) * self.break_radius

    @property
    def pull_off_indentation(self) -> Array:
        """Indentation −(3π²w²R*/64E*²)^{1/3} (m, negative) at the largest tension F_c."""
        return math.cbrt(1 / 9) * self.break_indentation

    @property
    def break_force(self) -> Array:
        """Force −5/9 F_c (N) from which the contact breaks at fixed grips."""
        return -5 / 9 * self.pull_off_force

    @cached_property
    def break_radius(self) -> Array:
        """Contact radius a_b = (πwR*²/8E*)^{1/3} (m) at the break; the stable branch is a ≥ a_b."""
        R, E_star, w = self.radius, self.contact_modulus, self.work_of_adhesion
        return scalar_or_array(np.cbrt(np.pi / 8 * w * R**2 / E_star))

    @property
    def break_indentation(self) -> Array:
        """Indentation δ_b = −3/4 (π²w²R*/E*²)^{1/3} (m, negative) at which the contact breaks."""
        return -3 * self.break_radius**2 / self.radius

    @property
    def jump_in_force(self) -> Array:
        """Force −8/9 F_c (N) right after the jump into contact at δ = 0."""
        return -8 / 9 * self.pull_off_force

    @property
    def zero_load_radius(self) -> Array:
        """Contact radius (9πwR*²/2E*)^{1/3} (m) of spheres held together by adhesion alone."""
        return math.cbrt(36) * self.break_radius

    @property
    def adhesive_length(self) -> Array:
        """Length of the neck (w²R*/E*²)^{1/3} (m): δ_b is −1.61 of it."""
        R, E_star, w = self.radius, self.contact_modulus, self.work_of_adhesion
        return scalar_or_array((w * w * R / E_star**2) ** (1 / 3))

    def loading_work(self, indentation: Values) -> Array:
        """Work W_l = ∫F dδ (J) from the jump in at δ = 0 to `indentation`; 0 where that is ≤ 0.

        Negative at small indentation, where adhesion still draws the spheres together.
        """
        W_l = self._energy_unit * (_total_energy(self._root(indentation)) - _AT_JUMP_IN)
        return scalar_or_array(np.where(np.asarray(indentation) <= 0, 0.0, W_l))

    def unloading_work(self, indentation: Values) -> Array:
        """Work W_u = ∫F dδ (J) from the break to `indentation`, given back on the way apart.

        W_u = W_l − W_s. Negative where parting takes more work than was stored; 0 below the break.
        """
        s = self._root(indentation)
        W_u = self._energy_unit * (_total_energy(s) - _AT_BREAK)
        return scalar_or_array(np.where(s == 0, 0.0, W_u))

    @property
    def hysteresis_loss(self) -> Array:
        """Energy W_s = 7.092 (w⁵R*⁴/E*²)^{1/3} (J) lost in one cycle of contact, at any depth."""
        return (_AT_BREAK - _AT_JUMP_IN) * self._energy_unit

    def impact_velocity(self, maximum_indentation: Values, mass: Values) -> Array:
        """Relative normal velocity V (m/s) that reaches `maximum_indentation`: ½ m* V² = W_l.

        NaN where W_l < 0: adhesion alone draws every impact deeper than that.
        """
        (m,), W_l = positive(mass=mass), self.loading_work(maximum_indentation)
        return scalar_or_array(np.where(W_l < 0, np.nan, (2 * np.abs(W_l) / m) ** 0.5))

    def sticking_velocity(self, mass: Values) -> Array:
        """Relative normal velocity V_s (m/s) of the fastest elastic impact that sticks."""
        (m,) = positive(mass=mass)
        return (2 * self.hysteresis_loss / m) ** 0.5

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (1 − (V_s/V)²)^½ after an impact at `velocity` (m/s).

        0 where the spheres stick, V ≤ V_s; 1 at and below zero velocity, where none approaches.
        """
        V, V_s = touching(velocity), self.sticking_velocity(mass)
        q = V_s / np.maximum(V, V_s)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, ((1 - q) * (1 + q)) ** 0.5))

    def restitution_at_indentation(self, maximum_indentation: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ after loading to `maximum_indentation` (m).

        0 where W_u ≤ 0 (they stick); 1 at and below zero indentation, where nothing has touched.
        """
        W_l, W_s = self.loading_work(maximum_indentation), self.hysteresis_loss
        e = (1 - W_s / np.maximum(W_l, W_s)) ** 0.5
        return scalar_or_array(np.where(np.asarray(maximum_indentation) <= 0, 1.0, e))

    def tabor_parameter(self, equilibrium_separation: Values) -> Array:
        """Tabor's μ; `equilibrium_separation` z₀ (m) is that of the surface forces, 0.15–0.4 nm."""
        (z0,) = positive(equilibrium_separation=equilibrium_separation)
        return self.adhesive_length / z0

    @property
    def _pressed(self) -> Hertz:
        return Hertz(self.radius, self.contact_modulus)

    @property
    def _drawn(self) -> Kendall:
        return Kendall(self.contact_modulus, self.work_of_adhesion)

    def _root(self, indentation: Values) -> Array:
        """s = (a/a_b)^½ on the stable branch: the root s ≥ 1 of s⁴ − 4s = 3k; 0 below the break.

        With k = δ/|δ_b| ≥ −1, and p² half the one positive root of Ferrari's cubic y³ + 3ky = 2,
        s = p + (1/p − p²)^½. Cardano gives y = t − k/t with t³ = 1 + (1 + k³)^½; here it is written
        as 2/(t² + k + k²/t²), which does not cancel at any depth.
        """
        d, d_b = np.asarray(indentation, dtype=np.float64), self.break_indentation
        above = np.maximum((d - d_b) / -d_b, 0.0)  # 1 + k, exactly 0 at the break
        k = above - 1
        t = np.cbrt(1 + (above * (1 - k + k**2)) ** 0.5)
        p = (t**2 + k + (k / t) ** 2) ** -0.5
        s = p + np.maximum(1 / p - p**2, 0.0) ** 0.5
        return scalar_or_array(np.where(d < d_b, 0.0, s))

    @property
    def _energy_unit(self) -> Array:
        """U = E*a_b⁵/R*² (J)."""
        return self.contact_modulus * self.break_radius**5 / self.radius**2


def _total_energy(s: Array) -> Array:
    """U_T/U."""
    return s**4 * (8 / 15 * s**6 - 16 / 3 * s**3 + 8)
