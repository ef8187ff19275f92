"""The yield bound that grows with deformation: from first yield to full plasticity.

A contact that has just begun to yield carries a pressure of 1.6 Y, Y the yield strength of a
tensile test; a fully plastic one about 3 Y, because the material around the plastic zone holds it
together. In between the pressure grows with the logarithm of the strain, as that in an expanding
cavity does (Johnson 1970, J. Mech. Phys. Solids 18, 115–126; Johnson 1985, §6.3):

    bound = Y · min(c₀ + c₁ ln(m/(c₀ Y)), c₂).

c₀ is the largest pressure over Y at first yield of a sphere (`yield_coefficient` in `theory`). m is
the measure of strain: on a sphere E*a/R times 2/π, which is the largest pressure of an elastic
contact. On a rough surface

    m = p_e(2δ)/√2,

with p_e(2δ) the pressure that *elastic* bodies of this shape would have at the same node at twice
the indentation. It follows the slope of an asperity while asperities touch alone, and the slope of
the bodies once they have merged. At twice the indentation an elastic sphere touches as far as a
plastic one does at δ, and its largest pressure is √2 times as large. p_e nowhere falls when the
indentation grows, and so neither does the bound: the state still does not depend on the path.

c₁ and c₂ were chosen on finite elements (docs/validation.md says which, and how far it holds). c₂
is above 3 because it has to make up for material that piles up around a deep contact, which the
bound does not know; it is reached where the finite elements end.
Where the material hardens by a tangent modulus, Y is the flow stress at the representative strain
0.2 a/R (Tabor 1951), with a/R = π m/(2E*).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import equilibrate, reach

Array = NDArray[np.float64]

GROWTH, LARGEST = 0.65, 3.5  # c₁, c₂
_DEEPER = 2.0  # times the indentation, where the elastic pressure is taken
_LOOSER = 1e2  # times the residual of the solve
_TABOR = 0.2  # representative strain over a/R


def yield_bound(contact: Contact, indentation: float, residual: float) -> tuple[Array, int]:
    """The largest pressure (Pa) of each node at `indentation` (m), and the convolutions it took.

    The array has the shape of the grid. `residual` is that of the solve under this bound; that of
    the elastic solve may be larger, for the bound follows the logarithm of its pressure. The
    elastic contact may reach the edge of the grid. Raises `NotConvergedError`.
    """
    onset = contact.first_yield_pressure
    bound = np.full(contact.grid.nodes, onset)
    deeper = _DEEPER * indentation
    box = reach(contact, deeper)
    if box is None:
        return bound, 0
    elastic = equilibrate(contact, deeper, box, limit=math.inf, residual=_LOOSER * residual)
    measure = elastic.box_pressure / math.sqrt(_DEEPER)
    bound[box] = bound_of(contact, measure)
    return bound, elastic.convolutions


def bound_of(contact: Contact, measure: Array) -> Array:
    """The bound (Pa) where the measure of strain, a pressure in Pa, is `measure`."""
    Y, c_0 = contact.yield_strength, contact.first_yield_pressure / contact.yield_strength
    beyond = np.maximum(measure / (c_0 * Y), 1.0)
    factor = np.minimum(c_0 + GROWTH * np.log(beyond), LARGEST)
    strain = _TABOR * math.pi / 2 * (beyond - 1) * c_0 * Y / contact.pair.contact_modulus
    bound: Array = factor * (Y + contact.hardening_modulus * strain)
    return bound
