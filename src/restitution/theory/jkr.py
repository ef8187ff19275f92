"""Johnson, Kendall & Roberts (1971): elastic spheres with adhesion inside the contact area only.

K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301–313, doi
10.1098/rspa.1971.0141; D. Maugis, *Contact, Adhesion and Rupture of Elastic Solids*, Springer 2000.
JKR combines a Hertz contact and an adhering flat punch (`kendall`) of the same contact radius a.
The JKR force is the Hertz force minus the pull-off force of the punch. The JKR indentation is the
Hertz indentation minus the pull-off displacement of the punch. With the work of adhesion w:

    F = 4E*a³/(3R*) − (8πE*wa³)^½,   δ = a²/R* − (2πwa/E*)^½

Forces are positive in compression, except `pull_off_force`, which is a magnitude; δ is positive
when the contact is compressed. At fixed grips (prescribed δ) the contact breaks at the radius
a_b = (πwR*²/8E*)^{1/3}; at fixed load it detaches at the tension F_c = 3/2 πwR*, the pull-off
force. With the unit of energy U = E*a_b⁵/R*², the indentation δ, the force F, the elastic energy
U_el and the total energy U_T are polynomials in s = (a/a_b)^½:

    δ = (s⁴ − 4s) a_b²/R*,   F = (s⁶ − 6s³) F_c/9
    U_el/U = 8/15 s¹⁰ − 16/3 s⁷ + 16 s⁴,   U_T = U_el − wπa² = U_el − 8 s⁴ U,   dU_T = F dδ

    s³ = 1    break at fixed grips, the smallest possible δ:  δ_b = −3a_b²/R*,  F = −5/9 F_c
    s³ = 3    pull-off at fixed load, the smallest F:  a_c = (9πwR*²/8E*)^{1/3},  F = −F_c
    s³ = 4    δ = 0, where approaching spheres jump into contact:  F = −8/9 F_c
    s³ = 6    no load:  a = (9πwR*²/2E*)^{1/3}

At fixed grips the branch s ≥ 1 is stable and the branch s < 1 unstable. Methods with the argument
`contact_radius` cover both branches; methods with the argument `indentation` cover the stable
branch. The stable branch exists for δ ≥ δ_b. Approaching spheres jump onto this branch at δ = 0
(F = 0 before the jump), and separating spheres leave it at δ_b; below δ_b all quantities are 0. The
jump into contact and the break together dissipate the energy W_s, whatever the largest indentation:

    W_s = −∫ F dδ from δ_b to 0 = U_T(δ_b) − U_T(0) = 8/5 (2 + 3·4^{4/3}) U
        = 7.092 (w⁵R*⁴/E*²)^{1/3},

printed as 7.09 by Thornton & Ning, Powder Technology 99 (1998) 154–162.

If V is the velocity before the jump into contact, an elastic impact of reduced mass m* sticks up to
the sticking velocity V_s:

    ½ m* V_s² = W_s:  V_s = (14.18/m*)^½ (w⁵R*⁴/E*²)^{1/6},   e² = 1 − (V_s/V)², 0 for V ≤ V_s

(Thornton & Ning print 14.18; the exact value 2 × 7.092 = 14.184 is used here).

Valid for quasi-static normal impacts in the range of Hertz (a ≪ R*, no yield: V and V_s below
`FirstYield.velocity`) and for surface forces of short range. The Tabor parameter μ is the height of
the JKR neck divided by the range z₀, so μ is large if the range is short (D. Tabor, J. Colloid
Interface Sci. 58 (1977) 2–13):

    μ = (R*w²/(E*²z₀³))^{1/3}

JKR holds for μ > 5. For μ < 0.1 the theory of Derjaguin, Muller and Toporov (DMT) or the theory of
rigid spheres holds (Johnson & Greenwood, J. Colloid Interface Sci. 192 (1997) 326–333).
Forces of finite range act before first touch and change the jump into contact. So a larger μ is
needed for an accurate W_s than for an accurate pull-off force (Ciavarella, Greenwood & Barber, J.
Mech. Phys. Solids 98 (2017) 236–244). Small hard particles have a small μ, and their sticking
velocity is below V_s.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching
from .hertz import Hertz
from .kendall import Kendall

# Total energy in units of U: where the contact breaks at prescribed indentation (s = 1), and right
# after the jump into contact (s³ = 4). The module docstring defines U and s.
_AT_BREAK = 16 / 5
_AT_JUMP_IN = -24 / 5 * 4 * math.cbrt(4)


@dataclass(frozen=True, eq=False)
class JKR(PositiveFields):
    """JKR contact of elastic spheres with adhesion.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        work_of_adhesion: Work of adhesion w (J/m²).

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301–313.
    """

    radius: Values
    contact_modulus: Values
    work_of_adhesion: Values

    def force(self, indentation: Values) -> Array:
        """Normal force of spheres in contact, on the branch that is stable at fixed grips.

        F_c is the pull-off force. The force is −5/9 F_c at the indentation δ_b, where the contact
        breaks. It is −8/9 F_c at δ = 0. Its minimum, −F_c, lies between δ_b and 0. For δ < 0 the
        result is the force on separation. On approach, the force is 0 until the spheres jump into
        contact at δ = 0.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F (N), positive in compression; 0 below `break_indentation`.
        """
        s = self._root(indentation)
        return self.pull_off_force / 9 * s**3 * (s**3 - 6)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius at an indentation, on the branch that is stable at fixed grips.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Contact radius a (m), at least `break_radius`; 0 below `break_indentation`.
        """
        return self.break_radius * self._root(indentation) ** 2

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force at a contact radius, on the stable and the unstable branch.

        Args:
            contact_radius: Contact radius a (m).

        Returns:
            Normal force F (N), positive in compression.
        """
        pressed = Hertz(self.radius, self.contact_modulus).force_at_contact_radius(contact_radius)
        return pressed - self._drawn.pull_off_force(contact_radius)

    def indentation_at_contact_radius(self, contact_radius: Values) -> Array:
        """Indentation at a contact radius, on the stable and the unstable branch.

        Args:
            contact_radius: Contact radius a (m).

        Returns:
            Indentation δ (m), negative if the spheres are pulled apart.
        """
        a = touching(contact_radius)
        return a**2 / self.radius - self._drawn.pull_off_displacement(a)

    def stored_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Elastic energy at a contact radius, on the stable and the unstable branch.

        This state can be reached in two steps: Hertz loading to the contact radius a, then
        unloading by δ′ = (2πwa/E*)^½ at fixed a with the stiffness 2E*a. The work of both steps is
        U_el = 8E*a⁵/(15R*²) − 4E*a³δ′/(3R*) + E*aδ′².

        Args:
            contact_radius: Contact radius a (m).

        Returns:
            Elastic energy U_el (J).
        """
        R, E_star, a = self.radius, self.contact_modulus, touching(contact_radius)
        drawn = self._drawn.pull_off_displacement(a)
        return E_star * a * (8 * a**4 / (15 * R**2) - 4 * a**2 * drawn / (3 * R) + drawn**2)

    def total_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Elastic plus surface energy at a contact radius, on the stable and the unstable branch.

        Its derivative with respect to the indentation is the force: dU_T/dδ = F.

        Args:
            contact_radius: Contact radius a (m).

        Returns:
            Total energy U_T = U_el − wπa² (J), 0 for separated spheres.
        """
        a = touching(contact_radius)
        return self.stored_energy_at_contact_radius(a) - np.pi * self.work_of_adhesion * a**2

    @property
    def pull_off_force(self) -> Array:
        """Magnitude F_c = 3/2 πwR* (N) of the tension that separates the spheres at fixed load."""
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
        """Force (N) at which the contact breaks at fixed grips, −5/9 of the pull-off force."""
        return -5 / 9 * self.pull_off_force

    @cached_property
    def break_radius(self) -> Array:
        """Contact radius a_b = (πwR*²/8E*)^{1/3} (m) at which the contact breaks at fixed grips.

        It is the smallest contact radius on the stable branch.
        """
        R, E_star, w = self.radius, self.contact_modulus, self.work_of_adhesion
        return scalar_or_array(np.cbrt(np.pi / 8 * w * R**2 / E_star))

    @property
    def break_indentation(self) -> Array:
        """Indentation δ_b = −3/4 (π²w²R*/E*²)^{1/3} (m, negative) at which the contact breaks."""
        return -3 * self.break_radius**2 / self.radius

    @property
    def jump_in_force(self) -> Array:
        """Force (N) right after the jump into contact at δ = 0, −8/9 of the pull-off force."""
        return -8 / 9 * self.pull_off_force

    @property
    def zero_load_radius(self) -> Array:
        """Contact radius (9πwR*²/2E*)^{1/3} (m) of spheres held together by adhesion alone."""
        return math.cbrt(36) * self.break_radius

    @property
    def adhesive_length(self) -> Array:
        """Height h = (w²R*/E*²)^{1/3} (m) of the adhesive neck; `break_indentation` is −1.61 h."""
        R, E_star, w = self.radius, self.contact_modulus, self.work_of_adhesion
        return scalar_or_array((w * w * R / E_star**2) ** (1 / 3))

    def loading_work(self, indentation: Values) -> Array:
        """Work from the jump into contact at δ = 0 to an indentation.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Loading work W_l = ∫F dδ (J), negative at small indentation, where adhesion draws the
            spheres together; 0 for δ ≤ 0.
        """
        W_l = self._energy_unit * (_total_energy(self._root(indentation)) - _AT_JUMP_IN)
        return scalar_or_array(np.where(np.asarray(indentation) <= 0, 0.0, W_l))

    def unloading_work(self, indentation: Values) -> Array:
        """Work that the contact returns on unloading from an indentation to the break.

        For δ ≥ 0 this work equals `loading_work` minus `hysteresis_loss`.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Unloading work W_u = ∫F dδ from the break to δ (J), negative if separation consumes
            work; 0 below the break.
        """
        s = self._root(indentation)
        W_u = self._energy_unit * (_total_energy(s) - _AT_BREAK)
        return scalar_or_array(np.where(s == 0, 0.0, W_u))

    @property
    def hysteresis_loss(self) -> Array:
        """Energy W_s = 7.092 (w⁵R*⁴/E*²)^{1/3} (J) dissipated per impact.

        It does not depend on the depth of the impact.
        """
        return (_AT_BREAK - _AT_JUMP_IN) * self._energy_unit

    def impact_velocity(self, maximum_indentation: Values, mass: Values) -> Array:
        """Impact velocity that is just large enough to reach an indentation.

        The impact energy ½ m* V² then equals the loading work up to this indentation.

        Args:
            maximum_indentation: Largest indentation δ_max of the impact (m).
            mass: Reduced mass m* (kg).

        Returns:
            Relative normal velocity V (m/s); NaN if the loading work is negative, because adhesion
            then pulls the spheres deeper at any velocity.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,), W_l = positive(mass=mass), self.loading_work(maximum_indentation)
        return scalar_or_array(np.where(W_l < 0, np.nan, (2 * np.abs(W_l) / m) ** 0.5))

    def sticking_velocity(self, mass: Values) -> Array:
        """Largest relative normal velocity at which an elastic impact sticks.

        Args:
            mass: Reduced mass m* (kg).

        Returns:
            Sticking velocity V_s (m/s).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,) = positive(mass=mass)
        return (2 * self.hysteresis_loss / m) ** 0.5

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e = (1 − (V_s/V)²)^½ (dimensionless); 0 if the spheres
            stick (V ≤ V_s), 1 at zero or negative velocity.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        V, V_s = touching(velocity), self.sticking_velocity(mass)
        q = V_s / np.maximum(V, V_s)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, ((1 - q) * (1 + q)) ** 0.5))

    def restitution_at_indentation(self, maximum_indentation: Values) -> Array:
        """Coefficient of restitution after loading to `maximum_indentation`.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Coefficient of restitution e = (W_u/W_l)^½ (dimensionless), with the unloading work W_u
            and the loading work W_l; 0 if W_u ≤ 0 (the spheres stick), 1 at zero or negative
            indentation.
        """
        W_l, W_s = self.loading_work(maximum_indentation), self.hysteresis_loss
        e = (1 - W_s / np.maximum(W_l, W_s)) ** 0.5
        return scalar_or_array(np.where(np.asarray(maximum_indentation) <= 0, 1.0, e))

    def tabor_parameter(self, equilibrium_separation: Values) -> Array:
        """Tabor parameter, the ratio of the height of the neck to the range of the surface forces.

        Args:
            equilibrium_separation: Equilibrium separation z₀ of the surface forces (m), about
                0.15–0.4 nm.

        Returns:
            Tabor parameter μ (dimensionless).

        Raises:
            CaseError: `equilibrium_separation` is not positive and finite.
        """
        (z0,) = positive(equilibrium_separation=equilibrium_separation)
        return self.adhesive_length / z0

    @property
    def _drawn(self) -> Kendall:
        return Kendall(self.contact_modulus, self.work_of_adhesion)

    def _root(self, indentation: Values) -> Array:
        """Square root s = (a/a_b)^½ of the relative contact radius on the stable branch.

        The contact breaks at the radius a_b and the indentation δ_b; below δ_b the result is 0.
        Above, s ≥ 1 is the larger solution of s⁴ − 4s = 3k with k = δ/|δ_b|. Ferrari's method gives
        s = p + (1/p − p²)^½. Here y = 2p² is the positive root of y³ + 3ky = 2. Cardano's formula
        gives y = t − k/t with t³ = 1 + (1 + k³)^½. The code uses the equivalent form
        y = 2/(t² + k + k²/t²), which avoids cancellation.
        """
        d, d_b = np.asarray(indentation, dtype=np.float64), self.break_indentation
        above = np.maximum((d - d_b) / -d_b, 0.0)  # 1 + k, exactly 0 where the contact breaks
        k = above - 1
        t = np.cbrt(1 + (above * (1 - k + k**2)) ** 0.5)
        p = (t**2 + k + (k / t) ** 2) ** -0.5
        s = p + np.maximum(1 / p - p**2, 0.0) ** 0.5
        return scalar_or_array(np.where(d < d_b, 0.0, s))

    @property
    def _energy_unit(self) -> Array:
        """Unit of energy U = E*a_b⁵/R*² (J), where a_b is `break_radius`."""
        return self.contact_modulus * self.break_radius**5 / self.radius**2


def _total_energy(s: Array) -> Array:
    """Total energy in units of U = E*a_b⁵/R*², for s = (a/a_b)^½.

    a is the contact radius and a_b its value where the contact breaks.
    """
    return s**4 * (8 / 15 * s**6 - 16 / 3 * s**3 + 8)
