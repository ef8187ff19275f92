"""Maugis (1992): elastic spheres with a constant attraction of finite range (Dugdale)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, scalar_or_array
from ._roots import increasing_root

# Upper limit of the search for the normalised contact radius ā at pull-off. This radius is below
# 1.15, its value in the JKR limit.
_LARGEST_RADIUS = 2.0
_GOLDEN = 0.5 * (5**0.5 - 1)
_SECTIONS = 40  # steps of the golden-section search for the pull-off force: ā to 1e-8


@dataclass(frozen=True, eq=False)
class MaugisDugdale(PositiveFields):
    """Elastic spheres with a constant attraction σ₀ where the gap is below w/σ₀.

    With λ = 2σ₀ (R*/(πwK²))^{1/3}, K = 4/3 E*, ā = a (K/(πwR*²))^{1/3}, F̄ = F/(πwR*) and the outer
    radius ma of the attracting ring::

        1 = λā²/2 [(m² − 1)^½ + (m² − 2) arcsec m] + 4λ²ā/3 [(m² − 1)^½ arcsec m − m + 1]
        F̄ = ā³ − λā² [(m² − 1)^½ + m² arcsec m]

    The pull-off force goes from 2πwR* (λ → 0, rigid spheres) to 3/2 πwR* (λ → ∞, JKR). With the
    Tabor parameter µ, λ = 1.16 µ for `LennardJones.largest_traction`, 0.62 µ for its
    `dugdale_traction`.

    Attributes:
        radius: Reduced radius R* (m).
        contact_modulus: Contact modulus E* (Pa).
        work_of_adhesion: Work of adhesion w (J/m²).
        traction: Attraction σ₀ per area (Pa).

    Source:
        D. Maugis, J. Colloid Interface Sci. 150 (1992) 243–269; K. L. Johnson, J. A. Greenwood, J.
        Colloid Interface Sci. 192 (1997) 326–333.
    """

    radius: Values
    contact_modulus: Values
    work_of_adhesion: Values
    traction: Values

    @property
    def transition_parameter(self) -> Array:
        """Maugis' transition parameter λ (dimensionless)."""
        w, K = self.work_of_adhesion, 4 / 3 * np.asarray(self.contact_modulus)
        return scalar_or_array(2 * self.traction * np.cbrt(self.radius / (np.pi * w * K**2)))

    def force_at_contact_radius(self, contact_radius: Values) -> Array:
        """Normal force F (N), on the stable and the unstable branch."""
        w, K = self.work_of_adhesion, 4 / 3 * np.asarray(self.contact_modulus)
        a = np.asarray(contact_radius) * np.cbrt(K / (np.pi * w * np.square(self.radius)))
        unit = np.pi * w * self.radius
        return scalar_or_array(unit * _force(a, np.asarray(self.transition_parameter)))

    @property
    def pull_off_force(self) -> Array:
        """Magnitude of the largest tensile force (N)."""
        parameter = np.asarray(self.transition_parameter)
        low = np.full_like(parameter, 1e-4)
        high = np.full_like(parameter, _LARGEST_RADIUS)
        a, b = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
        at_a, at_b = _force(a, parameter), _force(b, parameter)
        for _ in range(_SECTIONS):
            left = at_a < at_b
            low, high = np.where(left, low, a), np.where(left, b, high)
            way = _GOLDEN * (high - low)
            new = np.where(left, high - way, low + way)
            at_new = _force(new, parameter)
            a, b = np.where(left, new, b), np.where(left, a, new)
            at_a, at_b = np.where(left, at_new, at_b), np.where(left, at_a, at_new)
        unit = np.pi * self.work_of_adhesion * self.radius
        return scalar_or_array(-unit * np.minimum(at_a, at_b))


def _force(a: Array, parameter: Array) -> Array:
    """Normalised force at the normalised contact radius `a`, for the transition `parameter`."""
    a, parameter = np.broadcast_arrays(a, parameter)

    def excess(log_width: Array) -> Array:
        root, angle, m = _ring(log_width)
        inner = root + (m * m - 2) * angle
        outer = root * angle - m + 1
        return parameter * a**2 / 2 * inner + 4 / 3 * parameter**2 * a * outer - 1

    # The unknown is ln(m − 1), where m is the ratio of the outer radius of the ring to the contact
    # radius. m − 1 ranges from 0 (JKR) to infinity (rigid spheres).
    width = increasing_root(excess, np.full_like(a, -40.0), np.full_like(a, 40.0))
    root, angle, m = _ring(width)
    return a**3 - parameter * a**2 * (root + m * m * angle)


def _ring(log_width: Array) -> tuple[Array, Array, Array]:
    """Return (m² − 1)^½, arcsec m and m for `log_width` = ln(m − 1)."""
    width = np.exp(log_width)
    root = np.sqrt(width * (2 + width))
    return root, np.arctan(root), 1 + width
