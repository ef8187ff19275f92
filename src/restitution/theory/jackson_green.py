"""Jackson & Green (2005): finite-element fit of an elastic, perfectly plastic sphere on a flat.

R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354, doi 10.1115/1.1866166. With E* the contact
modulus (their E′), Y the yield strength of a tensile test (their S_y) and ω* = ω/ω_c:

    C = 1.295 exp(0.736 ν),  ω_c = (πCY/2E*)² R*,  P_c = 4/3 (R*/E*)² (πCY/2)³,  A_c = πR*ω_c
    ω* ≤ 1.9    P/P_c = ω*^{3/2},  A/A_c = ω*: Hertz, although yielding began inside at ω* = 1
    ω* > 1.9    P/P_c = exp(−ω*^{5/12}/4) ω*^{3/2} + 4H_G/(CY) [1 − exp(−ω*^{5/9}/25)] ω*
                A/A_c = ω* (ω*/1.9)^B,  B = 0.14 exp(23 Y/E*)
                H_G/Y = 2.84 [1 − exp(−0.82 (a/R*)^{−0.7})],  πa² = A

CY is the peak pressure at first yield: ω_c is `FirstYield.indentation` with p_y = CY.

Loading only, against a rigid frictionless flat. The fit is to five steel-like materials (Y/E*
from 0.001 to 0.007, ν = 0.32; von Mises, no hardening) and to a/R* ≤ 0.412: there the force is
within 1 % of the finite elements on average and 3.5 % at worst, the area within 1.3 % and 4.3 %.
Elsewhere it extrapolates: the branches of the force, which meet to 0.1 % at ν = 0.32, leave a step
at ω* = 1.9 of +7.5 % at ν = 0, +1.5 % at ν = 0.25 and −3.4 % at ν = 0.5. For two deformable bodies
take Y and ν of the one with the smaller CY.
Units, shapes and errors are those of `restitution.theory`; a Poisson ratio that is not above −1 and
at most ½ raises `CaseError` too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, Values, keep, keep_positive, scalar_or_array, touching
from .hertz import Hertz
from .yielding import FirstYield, yield_coefficient

TRANSITION = 1.9
"""ω* up to which the fit is Hertz."""


@dataclass(frozen=True, eq=False)
class JacksonGreen:
    """A sphere of `yield_strength` Y (Pa, of a tensile test) and `poissons_ratio` ν on a flat.

    `radius` is R* (m), `contact_modulus` E* (Pa).
    """

    radius: Values
    contact_modulus: Values
    yield_strength: Values
    poissons_ratio: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "yield_strength")
        yield_coefficient(self.poissons_ratio)  # raises where there is none
        keep(self, "poissons_ratio", self.poissons_ratio)

    @cached_property
    def elastic(self) -> Hertz:
        """The contact up to the transition."""
        return Hertz(self.radius, self.contact_modulus)

    @cached_property
    def first_yield(self) -> FirstYield:
        """ω_c and P_c, at which the sphere first yields, below its surface: p_y = CY."""
        p_c = yield_coefficient(self.poissons_ratio) * self.yield_strength
        return FirstYield(self.radius, self.contact_modulus, p_c)

    def contact_area(self, indentation: Values) -> Array:
        """Contact area A (m²) on first loading."""
        B = 0.14 * np.exp(23 * self.yield_strength / self.contact_modulus)
        deep = np.maximum(self._normalised(indentation), TRANSITION)
        return self.elastic.contact_area(indentation) * (deep / TRANSITION) ** B

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a (m) on first loading; the fit was made for a ≤ 0.412 R*."""
        return (self.contact_area(indentation) / np.pi) ** 0.5

    def hardness(self, contact_radius: Values) -> Array:
        """Mean contact pressure H_G (Pa) of full plastic flow at a given contact radius (m).

        2.84 yield strengths in the limit of no contact, less as the contact grows beside the
        sphere.
        """
        a = touching(contact_radius)
        with np.errstate(divide="ignore"):  # a = 0: exp(−∞) = 0
            share = -np.expm1(-0.82 * (a / self.radius) ** -0.7)
        return scalar_or_array(2.84 * self.yield_strength * share)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force P (N) on first loading."""
        w, first = self._normalised(indentation), self.first_yield
        deep = np.maximum(w, TRANSITION)
        H_G = self.hardness(self.contact_radius(deep * first.indentation))
        fit = np.exp(-0.25 * deep ** (5 / 12)) * deep**1.5
        fit = fit - 4 * H_G / first.yield_pressure * np.expm1(-(deep ** (5 / 9)) / 25) * deep
        return scalar_or_array(first.force * np.where(w <= TRANSITION, w**1.5, fit))

    def _normalised(self, indentation: Values) -> Array:
        """ω* = ω/ω_c, zero where nothing touches."""
        return touching(indentation) / self.first_yield.indentation
