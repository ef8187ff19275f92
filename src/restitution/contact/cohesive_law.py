"""The law of the gap of a cohesive contact, with a pressure bound or a continuation beyond it."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.contact.contact import Contact
from restitution.theory import LennardJones

Array = NDArray[np.float64]

_SOFTEST = (2 / 15) ** (1 / 6)  # z₀/g at which φ″ is smallest


def law_of(contact: Contact) -> LennardJones:
    """The law of the gap between the bodies of `contact`."""
    return LennardJones(contact.work_of_adhesion, contact.equilibrium_separation)


def stiffness(contact: Contact, x: Array) -> Array:
    """Slope of the traction (Pa/m) at z₀/g = x; negative where the attraction weakens with g."""
    scale = 8 * contact.work_of_adhesion / contact.equilibrium_separation**2
    slope: Array = scale * x**4 * (3 * x**6 - 1)
    return slope


def largest_softening(contact: Contact, smallest_gap: float) -> float:
    """Largest −φ″ (Pa/m) at any gap not smaller than `smallest_gap`."""
    x = np.minimum(contact.equilibrium_separation / np.asarray(smallest_gap), _SOFTEST)
    return max(0.0, -float(stiffness(contact, x)))


class BoundedLaw:
    """The law of the gap on a box, as a function of u, bounded or continued beyond `limit`.

    If the bodies yield (`yields`), the pressure does not exceed `limit`. For elastic bodies, the
    law is continued linearly above the pressure E*, which no result reaches. The continuation keeps
    the iteration away from negative gaps.
    """

    def __init__(self, contact: Contact, base: Array, limit: Array | float) -> None:
        self.base = base
        self.yields = bool(np.all(np.isfinite(limit)))
        bound = np.asarray(limit if self.yields else contact.pair.contact_modulus, dtype=float)
        w, z0 = contact.work_of_adhesion, contact.equilibrium_separation
        self._w, self._z0 = w, z0
        self.least = z0 / np.cbrt(_cubic_root(bound * 3 * z0 / (8 * w)))
        x = z0 / self.least
        self._slope = -bound
        self._stiff = 0.0 if self.yields else stiffness(contact, x)

    def __call__(self, u: Array) -> tuple[Array, Array, Array]:
        """Energy (J/m²), its slope (Pa) and its curvature (Pa/m) at u."""
        gap = self.base + u
        below = np.minimum(gap - self.least, 0.0)
        x = self._z0 / (gap - below)
        x2 = x * x
        x4 = x2 * x2
        x6 = x4 * x2
        energy = (-self._w / 3) * x2 * (4 - x6)
        slope = (8 * self._w / (3 * self._z0)) * (x2 * x) * (1 - x6)
        stiff = (8 * self._w / self._z0**2) * x4 * (3 * x6 - 1)
        energy += below * (self._slope + 0.5 * self._stiff * below)
        slope += self._stiff * below
        stiff[below < 0] = self._stiff
        return energy, slope, stiff

    def beyond(self, u: Array) -> Array:
        """How far the gap would lie below that of the limit (m): the plastic displacement."""
        yielded: Array = np.maximum(self.least - self.base - u, 0.0)
        return yielded

    def continuation(self, u: Array) -> Array:
        """Energy beyond the limit (J/m²) of bodies that do not yield."""
        below = -self.beyond(u)
        energy: Array = below * (self._slope + 0.5 * self._stiff * below)
        return energy


def _cubic_root(c: Array) -> Array:
    """The root y ≥ 1 of y³ − y = c for c ≥ 0, by Viète's formulas."""
    t = 1.5 * math.sqrt(3) * c
    inside = np.cos(np.arccos(np.minimum(t, 1.0)) / 3)
    beyond = np.cosh(np.arccosh(np.maximum(t, 1.0)) / 3)
    root: Array = 2 / math.sqrt(3) * np.where(t < 1, inside, beyond)
    return root
