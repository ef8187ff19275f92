"""The pressure bound of the model `expanding-cavity`: it grows from first yield to full plasticity.

When a contact begins to yield, its largest pressure is 1.6 Y, where Y is the yield strength in a
tensile test. In a fully plastic contact the pressure is about 3 Y, because the surrounding material
constrains the plastic zone. In between, the pressure grows with the logarithm of the strain, as in
an expanding cavity (Johnson 1970, J. Mech. Phys. Solids 18, 115–126; Johnson 1985, §6.3):

    bound = Y · min(c₀ + c₁ ln(m/(c₀ Y)), c₂).

c₀ is the ratio of the largest pressure to Y at first yield of a sphere (`yield_coefficient` in
`theory`). c₁ and c₂ are fitted constants. m is an elastic pressure that is proportional to the
strain. For a sphere of radius R at the indentation δ, m is the largest pressure of an elastic
contact at δ. This pressure is (2/π) E*a/R with the elastic contact radius a = √(Rδ). At a node of a
rough surface, m is

    m = m₀ [2(δ − h_c)/(2δ − h_c)]^s,    m₀ = p_e(2δ)/√2.

p_e(2δ) is the pressure at the same node between *elastic* bodies of this shape at twice the
indentation. The factor 2 is that of a sphere: an elastic sphere at 2δ has the contact radius of a
plastic sphere at δ. The divisor √2 is the ratio of the largest pressures of elastic spheres at 2δ
and at δ. While asperities are in separate contact, their slope determines m. Once the asperity
contacts have merged, the slope of the bodies determines m. The bound depends only on the
indentation. Therefore, as with a constant bound, the state does not depend on the loading path.

The fraction in brackets corrects the depth of an asperity whose crest has an initial gap h_c. Such
an asperity is deformed by δ − h_c, so p_e should belong to a deformation of 2(δ − h_c). At the
indentation 2δ, however, the asperity is deformed by 2δ − h_c. Without the correction, COR is up to
6 % too high just after a new asperity has come into contact. The fraction is 1 for the asperity
that touches first. The exponent s decreases from 1 for separate asperities to 0 for merged ones:

    s = max(1 − (p_H/m₀)^1.5, 0).

p_H is the Hertz pressure at this node between smooth bodies under the same force as the elastic
rough bodies at the indentation 2δ. Where p_H ≥ m₀, the asperity contacts have merged.

A ridge yields in plane strain. Its plastic flow is therefore more constrained than that of a round
asperity. For ridges, the coefficients become

    c₀ (1 + 0.11 q),  c₁ (1 + 1.1 q),  c₂ (1 + 0.25 q),    q = (1 − κ₂/κ₁)² s.

κ₂ and κ₁ are the smaller and the larger curvature of the gap at the node. q is 1 for a ridge in
separate contact, and 0 for round asperities and for merged contacts. At q = 1, the factor of c₀ is
1.11. This is the ratio of the pressures at first yield of a cylinder and of a sphere, 1.79 Y and
1.61 Y for ν = 0.3 (Johnson 1985, §§4.2, 4.4).

All other constants were fitted to finite element results (docs/validation.md lists the constants
and their range). c₂ is above 3, because it also accounts for the pile-up around a deep contact. The
model does not compute this pile-up. The bound reaches c₂ Y at the largest indentation of the finite
element results.

If the material hardens with a tangent modulus, a flow stress replaces the factor Y of the bound.
The flow stress depends on the plastic strain. This strain is the increase, since first yield, of
the representative strain 0.2 a/R (Tabor 1951), with a/R = π m/(2E*).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.contact.equilibrium import elastic_pressure
from restitution.contact.state import Array, State
from restitution.numerics.box import Box
from restitution.numerics.read_only import freeze
from restitution.theory import Hertz

Nodes = tuple[NDArray[np.intp], ...]  # indices of rows and columns

# Coefficients of the ratio of the pressure bound to the yield strength, for round asperities:
# growth with the logarithm of the strain (c₁), and upper limit (c₂).
GROWTH, LARGEST = 0.65, 3.5
# Three coefficients are larger for a ridge than for a round asperity, by these relative amounts:
# c₀ (value at first yield), c₁ (growth with strain) and c₂ (upper limit).
_RIDGE_ONSET, _RIDGE_GROWTH, _RIDGE_LARGEST = 0.11, 1.1, 0.25
_DEPTH_FACTOR = 2.0  # the elastic pressure is computed at this multiple of the indentation

# The bound is computed from an elastic solve. The tolerance of this solve is _RESIDUAL_FACTOR times
# the tolerance of the later solve under the bound, but at most _LARGEST_RESIDUAL. On 143 random
# rough surfaces, tolerances of 5e-5 and 1e-8 gave values of COR that differ by at most 7.5e-5
# (tests/contact/test_cavity.py checks 1e-4).
_RESIDUAL_FACTOR, _LARGEST_RESIDUAL = 5e3, 5e-5
_TABOR = 0.2  # representative strain divided by a/R (contact radius a, radius R of the sphere)


def yield_bound(contact: Contact, indentation: float, residual: float) -> tuple[Array, int]:
    """Return the pressure bound (Pa) at `indentation` (m), and the number of convolutions it took.

    The bound is a read-only array of the shape of the grid. It is computed from the pressure of an
    elastic solve. `residual` is the tolerance of the later solve under this bound. The elastic
    solve has a larger tolerance, because the bound depends only on the logarithm of the elastic
    pressure. Raises `NotConvergedError`. If the elastic contact reaches the edge of the grid, no
    error is raised.
    """
    bound = np.full(contact.grid.nodes, contact.first_yield_pressure)
    tolerance = min(_RESIDUAL_FACTOR * residual, _LARGEST_RESIDUAL)
    pressure, box, convolutions = elastic_pressure(contact, _DEPTH_FACTOR * indentation, tolerance)
    nodes = np.nonzero(pressure)
    measure = pressure[nodes]
    force = float(measure.sum()) * contact.grid.cell_area
    measure *= 1 / math.sqrt(_DEPTH_FACTOR)
    merged = _smooth_pressure(contact, box, nodes, force) / measure
    separate = np.maximum(1 - merged * np.sqrt(merged), 0)
    apart = np.nonzero(separate)
    at_apart = tuple(index[apart] for index in nodes)
    depth_ratio = _depth_ratio(contact.crest_gap[box][at_apart], indentation)
    ridge = contact.elongation[box][at_apart] * separate[apart]
    bounds = bound_of(contact, measure)
    bounds[apart] = bound_of(contact, measure[apart] * depth_ratio ** separate[apart], ridge)
    bound[box][nodes] = bounds
    return freeze(bound), convolutions


def pressure_bound(
    contact: Contact, indentation: float, residual: float
) -> tuple[Array | float, int]:
    """Return the pressure bound (Pa), and the number of convolutions that the bound took."""
    if contact.grows:
        return yield_bound(contact, max(indentation, 0.0), residual)
    return contact.yield_pressure, 0


def bound_after(state: State, indentation: float, residual: float) -> tuple[Array | float, int]:
    """Return the results of `pressure_bound` for a step from `state` to `indentation`.

    The bound of a node never falls below its value in `state`.
    """
    if indentation <= state.indentation:
        return state.bound, 0
    limit, convolutions = pressure_bound(state.contact, indentation, residual)
    if isinstance(limit, np.ndarray):
        limit = freeze(np.maximum(limit, state.bound))
    return limit, convolutions


def bound_of(contact: Contact, measure: Array, ridge: Array | float = 0.0) -> Array:
    """Return the pressure bound (Pa) for `measure`, the value m (Pa) of the module docstring.

    `ridge` describes the shape of the asperity, from 0 (round) to 1 (ridge).
    """
    Y = contact.yield_strength
    c_0 = contact.first_yield_pressure / Y * (1 + _RIDGE_ONSET * ridge)
    beyond = np.maximum(measure / (c_0 * Y), 1.0)
    factor = np.minimum(
        c_0 + GROWTH * (1 + _RIDGE_GROWTH * ridge) * np.log(beyond),
        LARGEST * (1 + _RIDGE_LARGEST * ridge),
    )
    flow_stress: Array | float = Y
    if contact.hardening_modulus > 0:
        strain = _TABOR * math.pi / 2 * (beyond - 1) * c_0 * Y / contact.pair.contact_modulus
        flow_stress = Y + contact.hardening_modulus * strain
    return factor * flow_stress


def _depth_ratio(crest_gap: Array, indentation: float) -> Array:
    """Return the depth correction 2(δ − h_c)/(2δ − h_c) of the asperity at each node.

    h_c is the `crest_gap` (m), and δ the `indentation` (m). The result is 0 where δ < h_c.
    """
    depth = np.maximum(indentation - crest_gap, 0)
    return _DEPTH_FACTOR * depth / (_DEPTH_FACTOR * indentation - crest_gap)


def _smooth_pressure(contact: Contact, box: Box, nodes: Nodes, force: float) -> Array:
    """Hertzian pressure (Pa) of the smooth bodies under `force` (N) at the `nodes` of `box`."""
    smooth = Hertz(contact.pair.radius, contact.pair.contact_modulus)
    x, y = contact.grid.x[box[0]] - contact.apex[0], contact.grid.y[box[1]] - contact.apex[1]
    return smooth.pressure(np.hypot(x[nodes[0]], y[nodes[1]]), smooth.indentation(force))
