"""A pressure bound that grows from first yield to full plasticity, as in an expanding cavity.

Johnson (1970, J. Mech. Phys. Solids 18, 115–126; 1985, §6.3); docs/method.md:

    bound = Y · min(c₀ + c₁ ln(m/(c₀ Y)), c₂),   m = p_e(2δ)/√2 · [2(δ − h_c)/(2δ − h_c)]^s.

p_e(2δ) is the pressure at the node between *elastic* bodies at twice the indentation, h_c the gap
at the crest of the asperity, and s = max(1 − (p_H/m₀)^1.5, 0) is 1 for separate asperities and 0
where they have merged (p_H: Hertz pressure of the smooth bodies under the same force). On a ridge,
c₀, c₁ and c₂ are larger by 0.11 q, 1.1 q and 0.25 q with q = (1 − κ₂/κ₁)² s. With hardening, a flow
stress replaces the factor Y; its strain is the increase of 0.2 a/R since first yield (Tabor 1951).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import cast

import numpy as np

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import elastic_pressure
from restitution.contact.models import set_field
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.increments import ChangingBound
from restitution.contact.plasticity.size_effect import (
    SizedBound,
    hardness_error,
    strengthening_at,
    strengthening_of_sphere,
    strengthening_of_waves,
)
from restitution.contact.state import Array, State
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.numerics.box import Box
from restitution.numerics.growing_bound import bound_of, growing_bound
from restitution.numerics.read_only import freeze
from restitution.theory import Hertz, yield_coefficient

# Ratio of pressure to yield strength of a fully plastic contact (Tabor 1951).
FULL_CONSTRAINT = 2.8

# Coefficients of the ratio of the pressure bound to the yield strength, for round asperities:
# growth with the logarithm of the strain (c₁), and upper limit (c₂).
GROWTH, LARGEST = 0.65, 3.5
# Three coefficients are larger for a ridge than for a round asperity, by these relative amounts:
# c₀ (value at first yield), c₁ (growth with strain) and c₂ (upper limit).
_OF_RIDGE = 0.11, 1.1, 0.25
_DEPTH_FACTOR = 2.0  # the elastic pressure is computed at this multiple of the indentation

# The bound is computed from an elastic solve. The tolerance of this solve is _RESIDUAL_FACTOR times
# the tolerance of the later solve under the bound, but at most _LARGEST_RESIDUAL. On the
# surfaces of benchmarks/growing_bound.py, tolerances of 1.5e-4 and 1e-8 gave values of COR that
# differ by at most 5e-5 (tests/contact/test_cavity.py checks 1e-4).
_RESIDUAL_FACTOR, _LARGEST_RESIDUAL = 1.5e4, 1.5e-4
_PEAK = 1.5  # largest pressure between elastic paraboloids divided by their mean pressure (Hertz)
_TABOR = 0.2  # representative strain divided by a/R (contact radius a, radius R of the sphere)

# Values of the steepness ψ = E* S/Y of the asperities (rms slope S), and the largest relative
# difference of COR from finite elements (docs/validation.md) at each of these values.
_STEEPNESS, _GROWING = (0.0, 4.0, 6.0), (0.03, 0.035, 0.045)
# Values of the COR due to plasticity alone, and a factor of the difference for each of them.
_NEAR_ONE = (0.94, 0.98, 1.0), (1.0, 0.5, 0.2)


@typed
@dataclass(frozen=True)
class ExpandingCavity(ChangingBound):
    """The pressure bound grows with deformation, as in an expanding cavity.

    Attributes:
        yield_strength: Yield strength Y of a tensile test (Pa).
        tangent_modulus: Slope of the stress-strain curve of a tensile test after yield (Pa).
        size_effect: Depth h* (m) of the size effect, as of `SizedBound`; 0 without.

    Raises:
        CaseError: A value is impossible.

    Source:
        K. L. Johnson, J. Mech. Phys. Solids 18 (1970) 115–126.
    """

    yield_strength: float
    tangent_modulus: float = 0.0
    size_effect: float = 0.0

    label = "expanding-cavity"
    strengths = ("yield_strength",)

    def __post_init__(self) -> None:
        set_field(self, "yield_strength", "Pa")
        object.__setattr__(self, "tangent_modulus", float(self.tangent_modulus))
        if self.size_effect != 0:
            set_field(self, "size_effect", "m")

    def check(self, pair: Pair) -> None:
        softest = min(body.youngs_modulus for body in (pair.first, pair.second))
        if not 0 <= self.tangent_modulus < softest:
            raise CaseError(
                f"tangent_modulus: {self.tangent_modulus:g} Pa is not between 0 and Young's "
                f"modulus, {softest:g} Pa"
            )

    @property
    def hardness(self) -> float:
        return FULL_CONSTRAINT * self.yield_strength

    def describe(self) -> str:
        size = f", size effect h* {quantity(self.size_effect, 'm')}" if self.size_effect else ""
        return f"yield strength {quantity(self.yield_strength, 'Pa')} ({self.label}){size}"

    def first_yield_pressure(self, pair: Pair) -> float:
        """Largest pressure at which smooth bodies stay elastic (Pa).

        Source: R. L. Jackson, I. Green, J. Tribology 127 (2005) 343–354, at the mean Poisson's
        ratio of the bodies.
        """
        nu = 0.5 * (pair.first.poissons_ratio + pair.second.poissons_ratio)
        return float(yield_coefficient(nu)) * self.yield_strength

    def of_smooth(self, pair: Pair) -> ExpandingCavity:
        harder = strengthening_of_sphere(self.size_effect, pair.radius)
        return ExpandingCavity(self.yield_strength * harder, self.tangent_modulus)

    def onset_pressure(self, pair: Pair) -> float:
        return self.first_yield_pressure(pair)

    def hardening_modulus(self, pair: Pair) -> float:
        """Slope E_t/(1 − E_t/E) of the flow stress against *plastic* strain (Pa)."""
        E = min(body.youngs_modulus for body in (pair.first, pair.second))
        return self.tangent_modulus / (1 - self.tangent_modulus / E)

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        return yield_bound(contact, max(indentation, 0.0), residual)

    def bound_after(
        self, state: State, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        if self.size_effect and indentation > state.indentation:
            return self.bound(state.contact, indentation, residual)  # patches that grow soften
        return super().bound_after(state, indentation, residual)

    def bound_at(self, pair: Pair, measure: Array, ridge: Array | float = 0.0) -> Array:
        """Bound (Pa) where the value m of the module docstring is `measure` (Pa).

        `ridge` is q, from 0 (round asperity) to 1 (ridge).
        """
        onset = self.first_yield_pressure(pair) * (1 + _OF_RIDGE[0] * np.asarray(ridge))
        growth = np.log(np.maximum(measure / onset, 1.0))
        return bound_of(growth, np.asarray(ridge), self._constants(pair), _OF_RIDGE)

    def _constants(self, pair: Pair) -> tuple[float, float, float, float]:
        Y, onset = self.yield_strength, self.first_yield_pressure(pair)
        strain = _TABOR * math.pi / 2 * onset / pair.contact_modulus  # at first yield
        return onset, GROWTH * Y, LARGEST * Y, self.hardening_modulus(pair) * strain / Y

    def of_asperities(self, pair: Pair, elastic_pressure: float) -> ConstantBound | SizedBound:
        bound = float(self.bound_at(pair, np.asarray(_PEAK * elastic_pressure)))
        return SizedBound(bound, self.size_effect) if self.size_effect else ConstantBound(bound)

    def bound_of_waves(
        self, contact: Contact, depth: float, measure: Array, nominal: float
    ) -> Array:
        merged = nominal / np.maximum(measure, nominal)
        separate = 1 - merged * np.sqrt(merged)
        gap = contact.crest_gap
        ratio = _DEPTH_FACTOR * np.maximum(depth - gap, 0) / (_DEPTH_FACTOR * depth - gap)
        harder = strengthening_of_waves(contact, self.size_effect, math.sqrt(2) * measure)
        measure = measure * ratio**separate / harder
        return harder * self.bound_at(contact.pair, measure, contact.elongation * separate)

    def smooth_bounds(self, pair: Pair, count: int) -> tuple[Array, Array]:
        first = self.first_yield_pressure(pair)
        last = first * math.exp((LARGEST - first / self.yield_strength) / GROWTH)
        measure = np.geomspace(first, last, count)
        return measure, self.bound_at(pair, measure)

    def hardness_error(self, state: State) -> float:
        return hardness_error(self.size_effect, state)

    def difference(self, contact: Contact, restitution: float) -> float:
        steepness = contact.pair.contact_modulus * contact.slope / self.yield_strength
        return float(
            np.interp(steepness, _STEEPNESS, _GROWING) * np.interp(restitution, *_NEAR_ONE)
        )


def yield_bound(contact: Contact, indentation: float, residual: float) -> tuple[Array, int]:
    model = cast(ExpandingCavity, contact.plasticity)
    bound = np.full(contact.grid.nodes, contact.first_yield_pressure)
    tolerance = min(_RESIDUAL_FACTOR * residual, _LARGEST_RESIDUAL)
    pressure, box, convolutions = elastic_pressure(contact, _DEPTH_FACTOR * indentation, tolerance)
    if pressure.size == 0:
        return freeze(bound), convolutions
    force = float(pressure.sum(dtype=np.float64)) * contact.grid.cell_area
    harder, logarithms = None, np.broadcast_to(np.zeros(pressure.shape[1]), pressure.shape)
    if model.size_effect:
        harder, count = strengthening_at(contact, indentation, model.size_effect)
        convolutions += count
        logarithms = np.log(np.broadcast_to(harder, bound.shape)[box])
    growing_bound(
        pressure,
        _smooth_squares(contact, box, force),
        (contact.crest_gap[box], contact.elongation[box]),
        (indentation, _DEPTH_FACTOR * indentation),
        logarithms,
        model._constants(contact.pair),
        _OF_RIDGE,
        bound[box],
    )
    if harder is not None:
        bound *= harder
    return freeze(bound), convolutions


def _smooth_squares(contact: Contact, box: Box, force: float) -> tuple[Array, Array]:
    """Column and row whose sum is the square of the pressure between smooth bodies.

    It is negative where they do not touch. `force` (N) presses them together.
    """
    R, E = contact.pair.radius, contact.pair.contact_modulus
    x, y = contact.grid.x[box[0]] - contact.apex[0], contact.grid.y[box[1]] - contact.apex[1]
    scale = (2 * E / (math.pi * R)) ** 2
    depth = Hertz(R, E).indentation(force)
    return scale * (R * depth - x[:, None] ** 2), -scale * y[None, :] ** 2
