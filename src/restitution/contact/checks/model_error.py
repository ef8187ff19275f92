"""Error of the coefficient of restitution (COR) due to the models of plasticity and of adhesion.

The error of plasticity comes from a comparison with finite elements (docs/validation.md). The
largest relative differences of COR in this comparison are tabulated as a function of e_p, the COR
due to plasticity alone. With the elastic energy E_el and the plastic work W_p, e_p is
sqrt(E_el/(E_el + W_p)). It decreases monotonically from first yield to full plasticity, for smooth
bodies and for asperities. The differences of `expanding-cavity` also depend on the steepness of the
asperities ψ = E* S/Y, with the rms slope S and the yield strength Y. Outside the range of the
finite element results, the nearest value is used and may be too small.

These references are half-spaces. A sphere that yields returns less energy, the less the larger its
contact radius a over its radius R. `depth_difference` adds this difference. It comes from finite
elements of hemispheres and of half-spaces with finite strains (validation/bodies.csv).

With `adhesion = "jkr"` there is a second error. JKR theory neglects the range of the attraction and
therefore dissipates too much energy. The second error is computed from a table of the energy that
smooth elastic spheres dissipate in one cycle of contact. The table gives this energy as a fraction
of the energy dissipated in JKR theory, for several values of the Tabor parameter
(docs/studies/cohesive_reference.csv).
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.checks.resolution import tabor_parameter
from restitution.contact.state import State

# For each model of plasticity with a constant pressure bound: values of the COR due to plasticity
# alone, and the largest relative difference from finite elements at each of these values.
_CONSTANT = {
    "equilibrium": (
        (0.34, 0.5, 0.56, 0.68, 0.77, 0.86, 0.9999, 1.0),
        (0.1, 0.095, 0.06, 0.06, 0.09, 0.115, 0.115, 0.07),
    ),
    "truncated": (
        (0.26, 0.45, 0.48, 0.53, 0.595, 0.61, 0.69, 0.72, 0.8, 0.9999, 1.0),
        (0.3, 0.65, 0.65, 0.55, 0.45, 0.37, 0.3, 0.18, 0.17, 0.11, 0.07),
    ),
}
# For `expanding-cavity`: values of the steepness ψ of the asperities, and the largest relative
# difference between COR and finite element results at each of these values.
_STEEPNESS, _GROWING = (0.0, 4.0, 6.0), (0.03, 0.035, 0.045)
# Values of the COR due to plasticity alone, and a factor for each of them. The largest difference
# (`_GROWING`) is multiplied by this factor.
_NEAR_ONE = (0.94, 0.98, 1.0), (1.0, 0.5, 0.2)
# Ratio a/R above which finite elements of a sphere differ from those of a half-space, and the
# largest difference of COR per a/R beyond it if a sphere or a flat body yields.
_SHALLOW, _OF_SPHERE, _OF_FLAT = 0.02, 0.33, 0.06
# Values of the Tabor parameter, and the energy that smooth elastic spheres dissipate in a cycle of
# contact, as a fraction of the energy dissipated in JKR theory. The fractions come from an
# axisymmetric reference solution.
_TABOR = (0.7, 1.0, 2.0, 3.0, 5.0)
_HYSTERESIS = (0.0, 0.0347, 0.2039, 0.3198, 0.4581)
_BEYOND = 0.44  # exponent of the extrapolation to larger Tabor parameters
_ONSET = 1.6 / 2.8  # ratio of the pressure at first yield to the pressure of full plasticity


def model_error(state: State, restitution: float) -> float:
    """Error of the COR `restitution` of an impact whose deepest point is `state`.

    It has two independent parts, one due to the plasticity model and one due to neglecting the
    range of adhesion.
    """
    parts = _plasticity_error(state, restitution), _range_error(state, restitution)
    error = math.hypot(*parts) if all(parts) else max(parts)
    return min(error, max(restitution, 1 - restitution))  # COR lies between 0 and 1


def hysteresis_ratio(tabor: float) -> float:
    """Energy dissipated in a contact cycle of smooth elastic spheres, as a fraction of that of JKR.

    Up to the Tabor parameter µ = 5, the result is interpolated in a table. For larger µ, its
    difference from 1 is extrapolated as µ^(−n). The exponent n = 0.44 is that of the table values
    at µ = 3 and 5. In the table n increases with µ, so the extrapolated result is more likely too
    small than too large.
    """
    if tabor >= _TABOR[-1]:
        return 1 - (1 - _HYSTERESIS[-1]) * math.pow(_TABOR[-1] / tabor, _BEYOND)
    return float(np.interp(tabor, _TABOR, _HYSTERESIS))


def _range_error(state: State, restitution: float) -> float:
    """Error of the COR `restitution` because JKR neglects the range of the attraction."""
    contact, work = state.contact, state.loading_work
    if not contact.adhesive or contact.cohesive or work <= 0 or state.contact_nodes == 0:
        return 0.0
    lost = max(1 - restitution**2 - state.plastic_work / work, 0.0)
    regained = lost * (1 - hysteresis_ratio(tabor_parameter(state)))
    return min(math.sqrt(restitution**2 + regained), 1.0) - restitution


def _plasticity_error(state: State, restitution: float) -> float:
    """Error of the COR `restitution` due to the plasticity model.

    The error is 0 for elastic bodies, and if no node has reached the pressure of first yield.
    """
    contact = state.contact
    onset = contact.first_yield_pressure * (1.0 if contact.grows else _ONSET)
    if math.isinf(onset) or state.box_pressure.max(initial=0.0) < onset:
        return 0.0
    stored, lost = state.stored_energy, state.plastic_work
    returned = stored / (stored + lost) if stored + lost > 0 else 0.0
    due_to_yield = math.sqrt(returned)
    error = largest_difference(state, due_to_yield)
    if deeper := depth_difference(state, due_to_yield):
        error += deeper / due_to_yield if due_to_yield else 1.0
    # The error of the model of plasticity changes only the plastic loss of energy, and the adhesive
    # loss stays the same. Let e_p be the COR that the plastic loss alone would give. The square of
    # the actual COR then changes by the same amount as e_p².
    high, low = (
        math.sqrt(max(restitution**2 + returned * ((1 + off) ** 2 - 1), 0.0))
        for off in (error, -min(error, 1.0))
    )
    return max(min(high, 1.0) - restitution, restitution - low)


def largest_difference(state: State, restitution: float) -> float:
    """Largest relative difference of COR between the plasticity model and finite elements.

    `restitution` is the COR that plasticity alone would give.
    """
    contact = state.contact
    if not contact.grows:
        return relative_model_error(str(contact.plasticity), restitution, 0.0)
    steepness = contact.pair.contact_modulus * contact.slope / contact.yield_strength
    return relative_model_error("expanding-cavity", restitution, steepness)


def relative_model_error(plasticity: str, restitution: float, steepness: float) -> float:
    """Largest relative difference of COR between a model of plasticity and finite elements.

    `restitution` is the COR that plasticity alone would give, and `steepness` is E* S/Y of the
    asperities (rms slope S), which only the errors of `expanding-cavity` depend on.
    """
    if plasticity in _CONSTANT:
        return float(np.interp(restitution, *_CONSTANT[plasticity]))
    error = np.interp(steepness, _STEEPNESS, _GROWING) * np.interp(restitution, *_NEAR_ONE)
    return float(error)


def depth_difference(state: State, restitution: float) -> float:
    """Largest difference of COR between the bodies and half-spaces at the depth of `state`.

    If both bodies yield, each dissipates half of the energy. If it is unknown which body yields,
    the larger difference is used. `restitution` is the COR that plasticity alone would give.
    """
    pair, yields = state.contact.pair, state.contact.yields
    radius = math.sqrt(state.contact_area / math.pi)
    flat = _OF_FLAT * (radius / pair.radius - _SHALLOW)
    first, second = (
        max(_OF_SPHERE * (radius / body.radius - _SHALLOW), flat, 0.0)
        for body in (pair.first, pair.second)
    )
    parts = {"first": first, "second": second, "both": 0.5 * (first + second)}
    largest = max(parts.values()) if yields is None else parts[yields]
    # A body that hardly yields differs little: elastic bodies return all energy.
    return largest * min(1.0, 2 * (1 - restitution**2))
