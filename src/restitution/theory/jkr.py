"""JKR (1971): elastic spheres with adhesion inside the contact area only; and Kendall's punch."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching
from .hertz import Hertz

# Total energy in units of U: where the contact breaks at prescribed indentation (s = 1), and right
# after the jump into contact (s³ = 4). The docstring of `JKR` defines U and s.
_AT_BREAK = 16 / 5
_AT_JUMP_IN = -24 / 5 * 4 * math.cbrt(4)


@dataclass(frozen=True, eq=False)
class Kendall(PositiveFields):
    """Flat circular punch on an elastic half-space; it detaches as a whole at F = (8πE*wa³)^½.

    Valid without friction (or for an incompressible half-space), for surface forces of much shorter
    range than the displacement at detachment, for a much smaller than the bodies, and for a rigid
    punch or one whose compliance is in E*.

    Attributes:
        contact_modulus: Contact modulus E* (Pa).
        work_of_adhesion: Work of adhesion w (J/m²).

    Source:
        K. Kendall, J. Phys. D: Appl. Phys. 4 (1971) 1186–1195, doi 10.1088/0022-3727/4/8/320.
    """

    contact_modulus: Values
    work_of_adhesion: Values

    def pull_off_force(self, contact_radius: Values) -> Array:
        """Magnitude (8πE*wa³)^½ (N) of the tension that detaches the punch."""
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(8 * np.pi * E_star * w * a**3))

    def pull_off_displacement(self, contact_radius: Values) -> Array:
        """Magnitude (2πwa/E*)^½ (m) of the displacement at which the punch detaches."""
        E_star, w, a = self.contact_modulus, self.work_of_adhesion, touching(contact_radius)
        return scalar_or_array(np.sqrt(2 * np.pi * a * w / E_star))


@dataclass(frozen=True, eq=False)
class JKR(PositiveFields):
    """Elastic spheres with adhesion: `Hertz` minus the adhering punch `Kendall` of the same radius.

    With F_c = 3/2 πwR*, a_b = (πwR*²/8E*)^{1/3}, s = (a/a_b)^½ and U = E*a_b⁵/R*²::

        F = 4E*a³/(3R*) − (8πE*wa³)^½ = (s⁶ − 6s³) F_c/9,   U_T = U_el − wπa²
        δ = a²/R* − (2πwa/E*)^½ = (s⁴ − 4s) a_b²/R*,   U_el/U = 8/15 s¹⁰ − 16/3 s⁷ + 16 s⁴

        s³ = 1    break at fixed grips, the smallest δ: δ_b = −3a_b²/R*, F = −5/9 F_c
        s³ = 3    pull-off at fixed load, the smallest F: F = −F_c
        s³ = 4    δ = 0, where approaching spheres jump into contact: F = −8/9 F_c
        s³ = 6    no load

    At fixed grips the branch s ≥ 1 is stable. Methods of `contact_radius` cover both branches,
    methods of `indentation` the stable one, with zeros below δ_b. Jump-in and break dissipate W_s =
    7.092 (w⁵R*⁴/E*²)^{1/3}, so e² = 1 − (V_s/V)² with ½ m* V_s² = W_s.

    Valid for quasi-static impacts in the range of Hertz and for a Tabor parameter above 5 (D.
    Tabor, J. Colloid Interface Sci. 58 (1977) 2–13; Johnson & Greenwood, ibid. 192 (1997) 326–333);
    an accurate W_s takes a larger one (Ciavarella, Greenwood & Barber, J. Mech. Phys. Solids 98
    (2017) 236–244).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        work_of_adhesion: Work of adhesion w (J/m²).

    Source:
        K. L. Johnson, K. Kendall, A. D. Roberts, Proc. R. Soc. Lond. A 324 (1971) 301–313, doi
        10.1098/rspa.1971.0141; D. Maugis, *Contact, Adhesion and Rupture of Elastic Solids* (2000);
        the sticking velocity: C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162.
    """

    radius: Values
    contact_modulus: Values
    work_of_adhesion: Values

    def force(self, indentation: Values) -> Array:
        """Normal force F (N) in contact; for δ < 0 the force on separation."""
        s = self._root(indentation)
        return self.pull_off_force / 9 * s**3 * (s**3 - 6)

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a (m)."""
        return self.break_radius * self._root(indentation) ** 2

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force F (N)."""
        pressed = Hertz(self.radius, self.contact_modulus).force_at_contact_radius(contact_radius)
        return pressed - self._drawn.pull_off_force(contact_radius)

    def indentation_at_contact_radius(self, contact_radius: Values) -> Array:
        """Indentation δ (m), negative if the spheres are pulled apart."""
        a = touching(contact_radius)
        return a**2 / self.radius - self._drawn.pull_off_displacement(a)

    def stored_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Elastic energy U_el (J)."""
        R, E_star, a = self.radius, self.contact_modulus, touching(contact_radius)
        drawn = self._drawn.pull_off_displacement(a)
        return E_star * a * (8 * a**4 / (15 * R**2) - 4 * a**2 * drawn / (3 * R) + drawn**2)

    def total_energy_at_contact_radius(self, contact_radius: Values) -> Array:
        """Total energy U_T = U_el − wπa² (J); dU_T/dδ = F."""
        a = touching(contact_radius)
        return self.stored_energy_at_contact_radius(a) - np.pi * self.work_of_adhesion * a**2

    @property
    def pull_off_force(self) -> Array:
        """Magnitude F_c = 3/2 πwR* (N) of the tension that separates the spheres at fixed load."""
        return scalar_or_array(1.5 * np.pi * self.work_of_adhesion * self.radius)

    @property
    def pull_off_radius(self) -> Array:
        """Contact radius (9πwR*²/8E*)^{1/3} (m) at the largest tension F_c."""
        return math.cbrt(9) * self.break_radius

    @property
    def pull_off_indentation(self) -> Array:
        """Indentation −(3π²w²R*/64E*²)^{1/3} (m, negative) at the largest tension F_c."""
        return math.cbrt(1 / 9) * self.break_indentation

    @property
    def break_force(self) -> Array:
        """Force −5/9 F_c (N) at which the contact breaks at fixed grips."""
        return -5 / 9 * self.pull_off_force

    @cached_property
    def break_radius(self) -> Array:
        """Contact radius a_b (m), the smallest stable one, at which the contact breaks."""
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
        """Height h = (w²R*/E*²)^{1/3} (m) of the adhesive neck; `break_indentation` is −1.61 h."""
        R, E_star, w = self.radius, self.contact_modulus, self.work_of_adhesion
        return scalar_or_array((w * w * R / E_star**2) ** (1 / 3))

    def loading_work(self, indentation: Values) -> Array:
        """Work ∫F dδ (J) from the jump into contact at δ = 0, negative at small indentation."""
        W_l = self._energy_unit * (_total_energy(self._root(indentation)) - _AT_JUMP_IN)
        return scalar_or_array(np.where(np.asarray(indentation) <= 0, 0.0, W_l))

    def unloading_work(self, indentation: Values) -> Array:
        """Work ∫F dδ (J) returned up to the break, negative if separation consumes work."""
        s = self._root(indentation)
        W_u = self._energy_unit * (_total_energy(s) - _AT_BREAK)
        return scalar_or_array(np.where(s == 0, 0.0, W_u))

    @property
    def hysteresis_loss(self) -> Array:
        """Energy W_s (J) dissipated per impact, whatever the depth."""
        return (_AT_BREAK - _AT_JUMP_IN) * self._energy_unit

    def impact_velocity(self, maximum_indentation: Values, mass: Values) -> Array:
        """Smallest impact velocity V (m/s) to an indentation; NaN if adhesion alone reaches it."""
        (m,), W_l = positive(mass=mass), self.loading_work(maximum_indentation)
        return scalar_or_array(np.where(W_l < 0, np.nan, (2 * np.abs(W_l) / m) ** 0.5))

    def sticking_velocity(self, mass: Values) -> Array:
        """Largest velocity V_s (m/s) at which an elastic impact sticks."""
        (m,) = positive(mass=mass)
        return (2 * self.hysteresis_loss / m) ** 0.5

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e (dimensionless)."""
        V, V_s = touching(velocity), self.sticking_velocity(mass)
        q = V_s / np.maximum(V, V_s)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 1.0, ((1 - q) * (1 + q)) ** 0.5))

    def restitution_at_indentation(self, maximum_indentation: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ (dimensionless) of an impact of this depth."""
        W_l, W_s = self.loading_work(maximum_indentation), self.hysteresis_loss
        e = (1 - W_s / np.maximum(W_l, W_s)) ** 0.5
        return scalar_or_array(np.where(np.asarray(maximum_indentation) <= 0, 1.0, e))

    def tabor_parameter(self, equilibrium_separation: Values) -> Array:
        """Tabor parameter μ, the height of the neck divided by the range of the surface forces.

        Args:
            equilibrium_separation: Equilibrium separation z₀ of the surface forces (m), about
                0.15–0.4 nm.

        Returns:
            Tabor parameter (w²R*/E*²z₀³)^{1/3} (dimensionless).
        """
        (z0,) = positive(equilibrium_separation=equilibrium_separation)
        return self.adhesive_length / z0

    @property
    def _drawn(self) -> Kendall:
        return Kendall(self.contact_modulus, self.work_of_adhesion)

    def _root(self, indentation: Values) -> Array:
        """Root s ≥ 1 of s⁴ − 4s = 3k with k = δ/|δ_b|, 0 below δ_b; s = (a/a_b)^½.

        Ferrari gives s = p + (1/p − p²)^½ with y = 2p² the positive root of y³ + 3ky = 2, and
        Cardano y = t − k/t with t³ = 1 + (1 + k³)^½; y = 2/(t² + k + k²/t²) avoids cancellation.
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
        return self.contact_modulus * self.break_radius**5 / self.radius**2


def _total_energy(s: Array) -> Array:
    """Total energy in units of U, for s = (a/a_b)^½."""
    return s**4 * (8 / 15 * s**6 - 16 / 3 * s**3 + 8)
