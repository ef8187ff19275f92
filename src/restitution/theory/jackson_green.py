"""Jackson & Green (2005): finite-element fit of an elastic, perfectly plastic sphere on a flat."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import Array, Values, keep, keep_positive, scalar_or_array, touching
from .hertz import Hertz
from .yielding import FirstYield, yield_coefficient

TRANSITION = 1.9
"""Indentation relative to first yield, ω* = ω/ω_c, up to which the fit equals Hertz."""


@dataclass(frozen=True, eq=False)
class JacksonGreen:
    """First loading of an elastic, perfectly plastic sphere against a rigid frictionless flat.

    With ω* = δ/δ_y of `FirstYield` at the peak pressure CY, the force P and contact area A are
    Hertz's up to ω* = 1.9; beyond it::

        P/P_c = exp(−ω*^{5/12}/4) ω*^{3/2} + 4H_G/(CY) [1 − exp(−ω*^{5/9}/25)] ω*
        A/A_c = ω* (ω*/1.9)^B,  B = 0.14 exp(23 Y/E*),  H_G/Y = 2.84 [1 − exp(−0.82 (a/R*)^{−0.7})]

    Fitted for Y/E* from 0.001 to 0.007, ν = 0.32 and a/R* up to 0.412, to at most 3.5 % (force) and
    4.3 % (area). At ω* = 1.9 the force jumps: by +7.5 % for ν = 0, +1.5 % for ν = 0.25, −3.4 % for
    ν = 0.5. For two deformable bodies use Y and ν of the body with the smaller CY.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        yield_strength: Yield strength Y of a tensile test (Pa).
        poissons_ratio: Poisson's ratio ν (dimensionless), −1 < ν ≤ ½.

    Source:
        R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354, doi 10.1115/1.1866166.
    """

    radius: Values
    contact_modulus: Values
    yield_strength: Values
    poissons_ratio: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "contact_modulus", "yield_strength")
        yield_coefficient(self.poissons_ratio)  # raises CaseError for an impossible value
        keep(self, "poissons_ratio", self.poissons_ratio)

    @cached_property
    def elastic(self) -> Hertz:
        """Hertz contact, which the fit follows up to 1.9 times the indentation at first yield."""
        return Hertz(self.radius, self.contact_modulus)

    @cached_property
    def first_yield(self) -> FirstYield:
        """First yield below the surface, at the peak pressure C Y (see `yield_coefficient`)."""
        p_c = yield_coefficient(self.poissons_ratio) * self.yield_strength
        return FirstYield(self.radius, self.contact_modulus, p_c)

    def contact_area(self, indentation: Values) -> Array:
        """Contact area A (m²) on first loading."""
        B = 0.14 * np.exp(23 * self.yield_strength / self.contact_modulus)
        deep = np.maximum(self._normalised(indentation), TRANSITION)
        return self.elastic.contact_area(indentation) * (deep / TRANSITION) ** B

    def contact_radius(self, indentation: Values) -> Array:
        """Contact radius a (m) on first loading."""
        return (self.contact_area(indentation) / np.pi) ** 0.5

    def hardness(self, contact_radius: Values) -> Array:
        """Mean pressure H_G (Pa) of fully plastic flow."""
        with np.errstate(divide="ignore"):  # a = 0 gives exp(−∞) = 0
            share = -np.expm1(-0.82 * (touching(contact_radius) / self.radius) ** -0.7)
        return scalar_or_array(2.84 * self.yield_strength * share)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force P (N) on first loading."""
        w, first = self._normalised(indentation), self.first_yield
        deep = np.maximum(w, TRANSITION)
        H_G = self.hardness(self.contact_radius(deep * first.indentation))
        fit = (
            np.exp(-0.25 * deep ** (5 / 12)) * deep**1.5
            - 4 * H_G / first.yield_pressure * np.expm1(-(deep ** (5 / 9)) / 25) * deep
        )
        return scalar_or_array(first.force * np.where(w <= TRANSITION, w**1.5, fit))

    def _normalised(self, indentation: Values) -> Array:
        return touching(indentation) / self.first_yield.indentation
