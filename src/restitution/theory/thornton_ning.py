"""Thornton & Ning (1998): elastic, perfectly plastic spheres, with and without adhesion."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, PositiveFields, Values, positive, scalar_or_array, touching
from .hertz import Hertz
from .jkr import JKR
from .yielding import FirstYield


@dataclass(frozen=True, eq=False)
class ThorntonNing(PositiveFields):
    """Hertz with the pressure cut off at p_y, without adhesion; the contact radius stays (R*δ)^½.

    With x = δ/δ_y and f = F/F_y, first loading is f = x^{3/2} up to x = 1, then the tangent
    f = (3x − 1)/2. Unloading is Hertz with the radius R_p = R* x^{3/2}/f and a residual indentation
    δ_p: F = 4/3 E* R_p^½ (δ − δ_p)^{3/2}. Above the yield velocity V_y, with q = V_y/V::

        e = (6√3/5)^½ (1 − q²/6)^½ [q/(q + 2(6/5 − q²/5)^½)]^¼.

    Valid for quasi-static impacts with a ≪ R*. Beyond yield the force is too small: the area of a
    real yielded contact tends to 2πR*δ, whereas this law keeps πR*δ.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_pressure: Contact pressure p_y at yield (Pa), not the yield strength of a tensile
            test.

    Source:
        C. Thornton, J. Appl. Mech. 64 (1997) 383–386; C. Thornton, Z. Ning, Powder Technology 99
        (1998) 154–162.
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
        """Normal force F (N) on first loading."""
        d, d_y, F_y = touching(indentation), self.first_yield.indentation, self.first_yield.force
        plastic = F_y + np.pi * self.yield_pressure * self.radius * (d - d_y)
        return scalar_or_array(np.where(d <= d_y, self.elastic.force(d), plastic))

    def indentation(self, force: Values) -> Array:
        """Indentation δ (m) on first loading; the inverse of `loading_force`."""
        f, d_y = touching(force) / self.first_yield.force, self.first_yield.indentation
        return scalar_or_array(d_y * np.where(f <= 1, f ** (2 / 3), (2 * f + 1) / 3))

    def loading_work(self, indentation: Values) -> Array:
        """Loading work W_l = ∫F dδ (J)."""
        d, d_y, F_y = touching(indentation), self.first_yield.indentation, self.first_yield.force
        t = d - d_y
        plastic = 0.4 * F_y * d_y + F_y * t + 0.5 * np.pi * self.yield_pressure * self.radius * t**2
        return scalar_or_array(np.where(d <= d_y, self.elastic.stored_energy(d), plastic))

    def unloading_radius(self, maximum_indentation: Values) -> Array:
        """Reduced radius R_p (m) of the flattened spheres on unloading; R* up to yield."""
        x = self._yielded(maximum_indentation)
        return self.radius * x**1.5 / _line(x)

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ_p (m) at which unloading ends; 0 up to yield."""
        x = self._yielded(maximum_indentation)
        s = x**0.5
        # The factor after δ_y equals x − f/s with the relative force f = (3s² − 1)/2. The form used
        # here avoids cancellation at yield.
        return self.first_yield.indentation * ((x - 1) / (s + 1)) ** 2 * (s + 0.5) / s

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force F (N) on unloading from `maximum_indentation`; above it, `loading_force`."""
        d, R_p = touching(indentation), self.unloading_radius(maximum_indentation)
        left = d - self.residual_indentation(maximum_indentation)
        unloading = (R_p / self.radius) ** 0.5 * self.elastic.force(left)
        return scalar_or_array(
            np.where(d > touching(maximum_indentation), self.loading_force(d), unloading)
        )

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) returned on unloading to separation."""
        d, first = touching(maximum_indentation), self.first_yield
        x = self._yielded(d)
        plastic = 0.4 * first.force * first.indentation * _line(x) ** 2 / x**0.5
        return scalar_or_array(
            np.where(d <= first.indentation, self.elastic.stored_energy(d), plastic)
        )

    def impact_velocity(self, maximum_indentation: Values, mass: Values) -> Array:
        """Smallest impact velocity V (m/s) that reaches an indentation."""
        (m,) = positive(mass=mass)
        return (2 * self.loading_work(maximum_indentation) / m) ** 0.5

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation δ (m) of an impact; the inverse of `impact_velocity`."""
        v = touching(velocity) / self.first_yield.velocity(mass)
        f = ((6 * np.maximum(v, 1.0) ** 2 - 1) / 5) ** 0.5
        x = np.where(v <= 1, v**0.8, (1 + 2 * f) / 3)
        return scalar_or_array(self.first_yield.indentation * x)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e (dimensionless); 1 up to the yield velocity."""
        V, V_y = touching(velocity), self.first_yield.velocity(mass)
        q = V_y / np.maximum(V, V_y)
        tail = q / (q + 2 * (6 / 5 - q**2 / 5) ** 0.5)
        e = (6 * 3**0.5 / 5) ** 0.5 * (1 - q**2 / 6) ** 0.5 * tail**0.25
        return scalar_or_array(np.where(V_y >= V, 1.0, np.minimum(e, 1.0)))

    def restitution_at_indentation(self, maximum_indentation: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ (dimensionless) of an impact of this depth."""
        x = self._yielded(maximum_indentation)
        W_l = 0.4 + (x - 1) + 0.75 * (x - 1) ** 2
        return (0.4 * _line(x) ** 2 / x**0.5 / W_l) ** 0.5

    def _yielded(self, maximum_indentation: Values) -> Array:
        """Indentation relative to first yield, at least 1, where the formulas give Hertz."""
        return np.maximum(touching(maximum_indentation) / self.first_yield.indentation, 1.0)


@dataclass(frozen=True, eq=False)
class AdhesiveThorntonNing(PositiveFields):
    """Adhesive and plastic losses added: e² = e_p² − (V_s/V)² by `ThorntonNing` and `JKR`.

    Each loss is computed as if the other were absent, and the adhesive loss with the undeformed
    radius R*. So e is an upper estimate, accurate for V_s ≪ V_y. If V_s > V_y, the pair sticks up
    to V_y (e = 0) and the formula fails above it (NaN).

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_pressure: Contact pressure p_y at yield (Pa), not the yield strength of a tensile
            test.
        work_of_adhesion: Work of adhesion w (J/m²).

    Source:
        C. Thornton, Z. Ning, Powder Technology 99 (1998) 154–162.
    """

    radius: Values
    contact_modulus: Values
    yield_pressure: Values
    work_of_adhesion: Values

    @cached_property
    def elastic(self) -> JKR:
        """Adhesive contact without yield."""
        return JKR(self.radius, self.contact_modulus, self.work_of_adhesion)

    @cached_property
    def plastic(self) -> ThorntonNing:
        """Elastic-plastic contact without adhesion."""
        return ThorntonNing(self.radius, self.contact_modulus, self.yield_pressure)

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e (dimensionless); NaN above V_y if V_s > V_y."""
        V, V_y = touching(velocity), self.plastic.first_yield.velocity(mass)
        V_s = self.elastic.sticking_velocity(mass)
        e2 = self.plastic.restitution(velocity, mass) ** 2 - (V_s / np.maximum(V, V_y)) ** 2
        plastic = np.where(V_s > V_y, np.nan, np.maximum(e2, 0.0) ** 0.5)
        return scalar_or_array(np.where(V_y < V, plastic, self.elastic.restitution(velocity, mass)))


def _line(x: Array) -> Array:
    """Force beyond yield, linear in the indentation `x`; both are divided by values at yield."""
    return (3 * x - 1) / 2
