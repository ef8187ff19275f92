"""Thornton & Ning (1998): elastic, perfectly plastic spheres, here without adhesion.

`AdhesiveThorntonNing` adds adhesion. C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162; the
plastic law was published by Thornton, J. Appl. Mech. 64 (1997) 383–386. The law cuts off the Hertz
pressure at the yield pressure p_y. It does not compute how the lower pressure changes the
deformation, so the contact radius a still follows a² = R*δ. The index y marks values at first
yield. The relative indentation is x = δ/δ_y and the relative force f = F/F_y. The works W are in
units of F_y δ_y:

    loading     f = x^{3/2} for x ≤ 1, then the tangent  f = (3x − 1)/2,  F = F_y + πp_yR*(δ − δ_y)
                W_l = ⅖ x^{5/2} for x ≤ 1, then  W_l = ⅖ + (x − 1) + ¾ (x − 1)²
    unloading   Hertz with a flattened radius R_p and a residual indentation δ_p:
                F = 4/3 E* R_p^½ (δ − δ_p)^{3/2},  (δ_max − δ_p)/δ_y = f/x^½,  W_u = ⅖ f²/x^½
                At δ_max, force and contact radius are the same as on loading, so
                R_p F = R* F_Hertz(δ_max),  R_p/R* = x^{3/2}/f
    impact      ½ m* V² = W_l, e² = W_u/W_l; the contact ends where F returns to zero.

The restitution e is a function of x alone. Beyond yield f² = (6v² − 1)/5 with v = V/V_y, so e is
also a function of v alone.

Valid for quasi-static, normal, frictionless impacts of smooth spheres with a ≪ R*. Up to yield the
law is Hertz. Beyond yield, its force is too small, because the deformation does not follow from the
pressure that is cut off at p_y. The error grows with depth: the area of a real yielded contact
tends to 2πR*δ, whereas this law keeps the area πR*δ. p_y is a contact pressure, as in `FirstYield`,
and not the yield strength.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching
from .hertz import Hertz
from .yielding import FirstYield


@dataclass(frozen=True, eq=False)
class ThorntonNing(PositiveFields):
    """Impact of elastic, perfectly plastic spheres without adhesion.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_pressure: Contact pressure p_y at yield (Pa), not the yield strength of a tensile
            test.

    Raises:
        CaseError: A field is not positive and finite.

    Source:
        C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162.
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values

    @cached_property
    def elastic(self) -> Hertz:
        """Hertz contact, which the law follows up to yield."""
        return Hertz(self.radius, self.contact_modulus)

    @cached_property
    def first_yield(self) -> FirstYield:
        """First yield, the end of the elastic range."""
        return FirstYield(self.radius, self.contact_modulus, self.yield_pressure)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force on first loading: Hertz up to first yield, then the tangent at first yield.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Normal force F (N).
        """
        d, d_y, F_y = touching(indentation), self.first_yield.indentation, self.first_yield.force
        plastic = F_y + np.pi * self.yield_pressure * self.radius * (d - d_y)
        return scalar_or_array(np.where(d <= d_y, self.elastic.force(d), plastic))

    def indentation(self, force: Values) -> Array:
        """Indentation under a force on first loading; the inverse of `loading_force`.

        Args:
            force: Normal force F (N).

        Returns:
            Indentation δ (m).
        """
        f, d_y = touching(force) / self.first_yield.force, self.first_yield.indentation
        return scalar_or_array(d_y * np.where(f <= 1, f ** (2 / 3), (2 * f + 1) / 3))

    def loading_work(self, indentation: Values) -> Array:
        """Work done from first touch to an indentation on first loading.

        Args:
            indentation: Approach δ of the spheres (m).

        Returns:
            Loading work W_l = ∫F dδ (J).
        """
        d, d_y, F_y = touching(indentation), self.first_yield.indentation, self.first_yield.force
        t = d - d_y
        plastic = 0.4 * F_y * d_y + F_y * t + 0.5 * np.pi * self.yield_pressure * self.radius * t**2
        return scalar_or_array(np.where(d <= d_y, self.elastic.stored_energy(d), plastic))

    def unloading_radius(self, maximum_indentation: Values) -> Array:
        """Reduced radius of the flattened spheres on unloading.

        With the indentation x = δ_max/δ_y and the force f = F/F_y relative to first yield,
        R_p = R* x^{3/2}/f. This equals the published formula (4E*/3F) [(2F + F_y)/(2πp_y)]^{3/2},
        in which the bracket is the square of the contact radius.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Reduced radius R_p (m); R* up to yield.
        """
        x = self._yielded(maximum_indentation)
        return self.radius * x**1.5 / _line(x)

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation at which unloading ends.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Residual indentation δ_p (m); 0 up to yield.
        """
        x = self._yielded(maximum_indentation)
        s = x**0.5
        # The factor after δ_y equals x − f/s with the relative force f = (3s² − 1)/2. The form used
        # here avoids cancellation at yield.
        return self.first_yield.indentation * ((x - 1) / (s + 1)) ** 2 * (s + 0.5) / s

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force on unloading after first loading to `maximum_indentation`.

        Above `maximum_indentation` the force is `loading_force`.

        Args:
            indentation: Approach δ of the spheres (m).
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Normal force F (N); 0 at and below `residual_indentation`.
        """
        d, R_p = touching(indentation), self.unloading_radius(maximum_indentation)
        left = d - self.residual_indentation(maximum_indentation)
        unloading = (R_p / self.radius) ** 0.5 * self.elastic.force(left)
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work that the contact returns on unloading from `maximum_indentation` to separation.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Unloading work W_u (J); up to yield it equals the loading work.
        """
        d, first = touching(maximum_indentation), self.first_yield
        x = self._yielded(d)
        plastic = 0.4 * first.force * first.indentation * _line(x) ** 2 / x**0.5
        return scalar_or_array(
            np.where(d <= first.indentation, self.elastic.stored_energy(d), plastic)
        )

    def impact_velocity(self, maximum_indentation: Values, mass: Values) -> Array:
        """Impact velocity that is just large enough to reach an indentation.

        The impact energy ½ m* V² then equals the loading work up to this indentation.

        Args:
            maximum_indentation: Largest indentation δ_max of the impact (m).
            mass: Reduced mass m* (kg).

        Returns:
            Relative normal velocity V (m/s).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        (m,) = positive(mass=mass)
        return (2 * self.loading_work(maximum_indentation) / m) ** 0.5

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation of an impact; the inverse of `impact_velocity`.

        The index y marks values at first yield. Up to first yield, δ/δ_y = (V/V_y)^{4/5}. Beyond
        it, δ/δ_y = (1 + 2f)/3 with the relative force f = F/F_y and f² = (6 (V/V_y)² − 1)/5.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Indentation δ (m).

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        v = touching(velocity) / self.first_yield.velocity(mass)
        f = ((6 * np.maximum(v, 1.0) ** 2 - 1) / 5) ** 0.5
        x = np.where(v <= 1, v**0.8, (1 + 2 * f) / 3)
        return scalar_or_array(self.first_yield.indentation * x)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution after an impact.

        Above the yield velocity V_y, with q = V_y/V,

            e = (6√3/5)^½ (1 − q²/6)^½ [q/(q + 2(6/5 − q²/5)^½)]^¼.

        At high velocity e tends to 1.185 q^¼.

        Args:
            velocity: Relative normal impact velocity V (m/s).
            mass: Reduced mass m* (kg).

        Returns:
            Coefficient of restitution e (dimensionless); 1 up to the yield velocity V_y.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        V, V_y = touching(velocity), self.first_yield.velocity(mass)
        q = V_y / np.maximum(V, V_y)
        tail = q / (q + 2 * (6 / 5 - q**2 / 5) ** 0.5)
        e = (6 * 3**0.5 / 5) ** 0.5 * (1 - q**2 / 6) ** 0.5 * tail**0.25
        return scalar_or_array(np.where(V_y >= V, 1.0, np.minimum(e, 1.0)))

    def restitution_at_indentation(self, maximum_indentation: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ after loading to `maximum_indentation`.

        The result equals `restitution` at the velocity `impact_velocity(maximum_indentation, …)`.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Coefficient of restitution e (dimensionless); 1 up to yield.
        """
        x = self._yielded(maximum_indentation)
        W_l = 0.4 + (x - 1) + 0.75 * (x - 1) ** 2
        return (0.4 * _line(x) ** 2 / x**0.5 / W_l) ** 0.5

    def _yielded(self, maximum_indentation: Values) -> Array:
        """Indentation x = δ/δ_y relative to first yield; 1 below first yield.

        With x = 1, the formulas for the flattened radius, the residual indentation and the
        restitution give R*, 0 and 1. These values hold for any contact that has not yielded.
        """
        return np.maximum(touching(maximum_indentation) / self.first_yield.indentation, 1.0)


def _line(x: Array) -> Array:
    """Force beyond yield, linear in the indentation `x`; both are divided by values at yield."""
    return (3 * x - 1) / 2
