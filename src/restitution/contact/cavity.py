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
plastic one does at δ, and its largest pressure is √2 times as large. The bound depends on the
indentation only, and so the state still does not depend on the path.

A ridge yields in plane strain, which holds it together more firmly than a round asperity. With q
between 0 (round, or merged) and 1 (a ridge that touches alone), the bound takes

    c₀ (1 + 0.11 q),  c₁ (1 + q),  c₂ (1 + 0.25 q),    q = (1 − κ₂/κ₁)² max(1 − p_H/m, 0).

κ₂ and κ₁ are the smaller and the larger curvature of the gap at the node. p_H is the pressure of
smooth bodies under the elastic force at 2δ (Hertz): where it is as large as m, asperities have
merged. 1.11 is the ratio of the pressures at first yield of a cylinder and a sphere, 1.79 and
1.61 Y for ν = 0.3 (Johnson 1985, §§4.2, 4.4).

All other constants were chosen on finite elements (docs/validation.md says which, and how far they
hold). c₂ is above 3 because it has to make up for material that piles up around a deep contact,
which the bound does not know; it is reached where the finite elements end.
Where the material hardens by a tangent modulus, Y is the flow stress at the representative strain
0.2 a/R (Tabor 1951), with a/R = π m/(2E*).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import candidate_box, solve_pressure
from restitution.numerics.box import Box
from restitution.numerics.read_only import freeze
from restitution.theory import Hertz

Array = NDArray[np.float64]

GROWTH, LARGEST = 0.65, 3.5  # c₁, c₂
# Parts that a ridge adds to c₀, c₁ and c₂.
_RIDGE_ONSET, _RIDGE_GROWTH, _RIDGE_LARGEST = 0.11, 1.0, 0.25
_DEEPER = 2.0  # times the indentation, where the elastic pressure is taken
_LOOSER = 1e3  # times the residual of the solve
_TABOR = 0.2  # representative strain over a/R


def yield_bound(contact: Contact, indentation: float, residual: float) -> tuple[Array, int]:
    """The largest pressure (Pa) of each node at `indentation` (m), and the convolutions it took.

    The array has the shape of the grid and is read-only. `residual` is that of the solve under this
    bound; that of the elastic solve may be larger, for the bound follows the logarithm of its
    pressure. The elastic contact may reach the edge of the grid. Raises `NotConvergedError`.
    """
    bound = np.full(contact.grid.nodes, contact.first_yield_pressure)
    deeper = _DEEPER * indentation
    box = candidate_box(contact, deeper)
    if box is None:
        return freeze(bound), 0
    elastic = solve_pressure(contact, deeper, box, limit=math.inf, residual=_LOOSER * residual)
    measure = elastic.box_pressure / math.sqrt(_DEEPER)
    merged = np.divide(
        _smooth_pressure(contact, box, elastic.force),
        measure,
        out=np.ones_like(measure),
        where=measure > 0,
    )
    ridge = contact.elongation[box] * np.maximum(1 - merged, 0)
    bound[box] = bound_of(contact, measure, ridge)
    return freeze(bound), elastic.convolutions


def bound_of(contact: Contact, measure: Array, ridge: Array | float = 0.0) -> Array:
    """The bound (Pa) where the measure of strain, a pressure in Pa, is `measure`.

    `ridge` is q, between 0 on round asperities and 1 on ridges.
    """
    Y = contact.yield_strength
    c_0 = contact.first_yield_pressure / Y * (1 + _RIDGE_ONSET * ridge)
    beyond = np.maximum(measure / (c_0 * Y), 1.0)
    factor = np.minimum(
        c_0 + GROWTH * (1 + _RIDGE_GROWTH * ridge) * np.log(beyond),
        LARGEST * (1 + _RIDGE_LARGEST * ridge),
    )
    strain = _TABOR * math.pi / 2 * (beyond - 1) * c_0 * Y / contact.pair.contact_modulus
    bound: Array = factor * (Y + contact.hardening_modulus * strain)
    return bound


def _smooth_pressure(contact: Contact, box: Box, force: float) -> Array:
    """Pressure (Pa) of smooth elastic bodies under `force` (N) on a box of the grid (Hertz)."""
    smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
    x, y = contact.grid.x[box[0]] - contact.apex[0], contact.grid.y[box[1]] - contact.apex[1]
    return smooth.pressure(np.hypot.outer(x, y), smooth.indentation(force))
