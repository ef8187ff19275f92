"""Jackson & Green (2005): finite-element fit of an elastic, perfectly plastic sphere on a flat.

R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354, doi 10.1115/1.1866166. With E* the contact
modulus (their E′), Y the yield strength of a tensile test (their S_y) and ω* = ω/ω_c:

    C = 1.295 exp(0.736 ν),  ω_c = (πCY/2E*)² R*,  P_c = 4/3 (R*/E*)² (πCY/2)³,  A_c = πR*ω_c
    ω* ≤ 1.9    P/P_c = ω*^{3/2},  A/A_c = ω*: Hertz, although yielding began inside at ω* = 1
    ω* > 1.9    P/P_c = exp(−ω*^{5/12}/4) ω*^{3/2} + 4H_G/(CY) [1 − exp(−ω*^{5/9}/25)] ω*
                A/A_c = ω* (ω*/1.9)^B,  B = 0.14 exp(23 Y/E*)
                H_G/Y = 2.84 [1 − exp(−0.82 (a/R*)^{−0.7})],  πa² = A

CY is the peak pressure at first yield: ω_c is `yielding.yield_indentation` with p_y = CY.

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

import numpy as np

from restitution.errors import CaseError

from . import hertz
from ._inputs import Array, Values, positive, scalar_or_array, touching
from .yielding import yield_force, yield_indentation

TRANSITION = 1.9
"""ω* up to which the fit is Hertz."""


def yield_coefficient(poisson_ratio: Values) -> Array:
    """C, the peak Hertz pressure at first yield over the yield strength; 1.61 at ν = 0.3.

    A fit, within ½ % for 0 ≤ ν ≤ ½, to the largest von Mises stress under a Hertz contact.
    """
    nu = np.asarray(poisson_ratio, dtype=np.float64)
    bad = ~((nu > -1) & (nu <= 0.5))
    if bad.any():
        raise CaseError(
            f"poisson_ratio: {nu[bad].flat[0]:g} is not that of a stable solid; "
            "give one above -1 and at most 0.5"
        )
    C: Array = 1.295 * np.exp(0.736 * nu)
    return C


def critical_indentation(
    radius: Values, contact_modulus: Values, yield_strength: Values, poisson_ratio: Values
) -> Array:
    """Indentation ω_c (m) at which the sphere first yields, below its surface."""
    p_c = _critical_pressure(yield_strength, poisson_ratio)
    return yield_indentation(radius, contact_modulus, p_c)


def critical_force(
    radius: Values, contact_modulus: Values, yield_strength: Values, poisson_ratio: Values
) -> Array:
    """Normal force P_c (N) at which the sphere first yields, below its surface."""
    p_c = _critical_pressure(yield_strength, poisson_ratio)
    return yield_force(radius, contact_modulus, p_c)


def contact_area(
    indentation: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
) -> Array:
    """Contact area A (m²) on first loading."""
    Y, E_star = positive(yield_strength=yield_strength, contact_modulus=contact_modulus)
    w = _normalised(indentation, radius, contact_modulus, yield_strength, poisson_ratio)
    B = 0.14 * np.exp(23 * Y / E_star)
    return hertz.contact_area(indentation, radius) * (np.maximum(w, TRANSITION) / TRANSITION) ** B


def contact_radius(
    indentation: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
) -> Array:
    """Contact radius a (m) on first loading; the fit was made for a ≤ 0.412 R*."""
    A = contact_area(indentation, radius, contact_modulus, yield_strength, poisson_ratio)
    return (A / np.pi) ** 0.5


def hardness(contact_radius: Values, radius: Values, yield_strength: Values) -> Array:
    """Mean contact pressure H_G (Pa) of full plastic flow at a given contact radius (m).

    2.84 yield strengths in the limit of no contact, less as the contact grows beside the sphere.
    """
    a = touching(contact_radius)
    R, Y = positive(radius=radius, yield_strength=yield_strength)
    with np.errstate(divide="ignore"):  # a = 0: exp(−∞) = 0
        H_G: Array = 2.84 * Y * -np.expm1(-0.82 * (a / R) ** -0.7)
    return H_G


def loading_force(
    indentation: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
) -> Array:
    """Normal force P (N) on first loading."""
    material = radius, contact_modulus, yield_strength, poisson_ratio
    w = _normalised(indentation, *material)
    deep = np.maximum(w, TRANSITION)
    a = contact_radius(deep * critical_indentation(*material), *material)
    H_G = hardness(a, radius, yield_strength)
    p_c = _critical_pressure(yield_strength, poisson_ratio)
    fit = np.exp(-0.25 * deep ** (5 / 12)) * deep**1.5
    fit = fit - 4 * H_G / p_c * np.expm1(-(deep ** (5 / 9)) / 25) * deep
    return scalar_or_array(critical_force(*material) * np.where(w <= TRANSITION, w**1.5, fit))


def _critical_pressure(yield_strength: Values, poisson_ratio: Values) -> Array:
    """CY (Pa): the peak Hertz pressure at first yield."""
    (Y,) = positive(yield_strength=yield_strength)
    return yield_coefficient(poisson_ratio) * Y


def _normalised(
    indentation: Values,
    radius: Values,
    contact_modulus: Values,
    yield_strength: Values,
    poisson_ratio: Values,
) -> Array:
    """ω* = ω/ω_c, zero where nothing touches."""
    w_c = critical_indentation(radius, contact_modulus, yield_strength, poisson_ratio)
    return touching(indentation) / w_c
