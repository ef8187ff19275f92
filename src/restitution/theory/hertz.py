"""Hertz (1882): smooth, frictionless, linear elastic spheres.

With a² = R*δ the contact radius (Johnson 1985, *Contact Mechanics*, section 4.2):

    F = 4/3 E* R*^½ δ^{3/2},   W = 8/15 E* R*^½ δ^{5/2},
    p(r) = p₀ (1 − r²/a²)^½,   p₀ = 2E*a/(πR*).

Valid while the contact is small beside the spheres (a ≪ R*, about a < 0.1 R*, that is
δ < 0.01 R*) and nothing has yielded: δ ≤ `yielding.yield_indentation`. No adhesion.
Units, shapes and errors are those of `restitution.theory`.
"""

from __future__ import annotations

import numpy as np

from ._inputs import Array, Values, positive, touching


def force(indentation: Values, radius: Values, contact_modulus: Values) -> Array:
    """Normal force F (N), compressive positive."""
    d = touching(indentation)
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return 4 / 3 * E_star * R**0.5 * d**1.5


def indentation_from_force(force: Values, radius: Values, contact_modulus: Values) -> Array:
    """Indentation δ (m) under a normal force (N); the inverse of `force`."""
    F = touching(force)
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return (0.75 * F / (E_star * R**0.5)) ** (2 / 3)


def contact_radius(indentation: Values, radius: Values) -> Array:
    """Contact radius a = (R*δ)^½ (m)."""
    d = touching(indentation)
    (R,) = positive(radius=radius)
    return (R * d) ** 0.5


def contact_area(indentation: Values, radius: Values) -> Array:
    """Contact area πa² = πR*δ (m²): half the area the undeformed spheres would overlap in."""
    d = touching(indentation)
    (R,) = positive(radius=radius)
    return np.pi * R * d


def stored_energy(indentation: Values, radius: Values, contact_modulus: Values) -> Array:
    """Elastic energy W = ∫F dδ (J) stored from first touch to `indentation`."""
    d = touching(indentation)
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return 8 / 15 * E_star * R**0.5 * d**2.5


def peak_pressure(indentation: Values, radius: Values, contact_modulus: Values) -> Array:
    """Pressure p₀ in the centre of the contact (Pa), 3/2 of the mean."""
    d = touching(indentation)
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return 2 * E_star / np.pi * (d / R) ** 0.5  # 2E*a/(πR*) with a = (R*δ)^½


def pressure(
    radial_distance: Values, indentation: Values, radius: Values, contact_modulus: Values
) -> Array:
    """Pressure p(r) (Pa) at `radial_distance` (m) from the axis, zero outside the contact.

    For a profile at several depths give the distances and the indentations shapes that
    broadcast: (n,) and (m, 1) make (m, n). The sign of the distance does not matter.
    """
    r = np.asarray(radial_distance, dtype=np.float64)
    d = touching(indentation)
    R, E_star = positive(radius=radius, contact_modulus=contact_modulus)
    return 2 * E_star / (np.pi * R) * touching(R * d - r**2) ** 0.5  # p₀(1 − r²/a²)^½, a² = R*δ
