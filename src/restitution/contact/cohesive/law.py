"""The interface law of a cohesive contact: traction and energy as functions of the gap.

The Lennard-Jones law is modified at high pressure: the pressure is bounded if the bodies yield, and
otherwise the law is continued linearly.
"""

from __future__ import annotations

import math

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.state import Array
from restitution.theory import LennardJones

# The attraction weakens most steeply at the gap z₀/_SOFTEST (z₀ is the equilibrium separation).
_SOFTEST = (2 / 15) ** (1 / 6)


def law_of(contact: Contact) -> LennardJones:
    """Return the Lennard-Jones law between the surfaces of `contact`."""
    return LennardJones(contact.work_of_adhesion, contact.equilibrium_separation)


def stiffness(contact: Contact, x: Array) -> Array:
    """Derivative of the attractive traction with respect to the gap (Pa/m).

    It is negative where the attraction weakens as the gap grows. `x` is the ratio of the
    equilibrium separation to the gap.
    """
    scale = 8 * contact.work_of_adhesion / contact.equilibrium_separation**2
    return scale * x**4 * (3 * x**6 - 1)


def largest_softening(contact: Contact, smallest_gap: float) -> float:
    """Largest rate (Pa/m) at which the attraction weakens as the gap grows from `smallest_gap`."""
    x = np.minimum(contact.equilibrium_separation / np.asarray(smallest_gap), _SOFTEST)
    return max(0.0, -float(stiffness(contact, x)))


class BoundedLaw:
    """The interface law of the nodes of a box, as a function of their elastic displacement u.

    The gap is `base` + u. If the bodies yield (`yields`), the pressure does not exceed `limit`. For
    elastic bodies, the law is continued linearly above the pressure E*. The continuation keeps the
    pressure finite if the iteration reaches negative gaps.
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
        """Return the energy (J/m²) at the displacement `u`, and its first and second derivative.

        The derivatives are the attractive traction (Pa) and the slope of this traction (Pa/m).
        """
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
        """Distance (m) by which the gap at the displacement `u` is smaller than `least`, or 0.

        At the gap `least`, the pressure reaches its limit. If the bodies yield, the result is the
        plastic displacement added by this solve.
        """
        return np.maximum(self.least - self.base - u, 0.0)

    def continuation(self, u: Array) -> Array:
        """Energy (J/m²) of the linear continuation, which elastic bodies have below `least`."""
        below = -self.beyond(u)
        return below * (self._slope + 0.5 * self._stiff * below)


def _cubic_root(c: Array) -> Array:
    """The root y ≥ 1 of y³ − y = c for c ≥ 0, by Viète's formulas."""
    t = 1.5 * math.sqrt(3) * c
    inside = np.cos(np.arccos(np.minimum(t, 1.0)) / 3)
    beyond = np.cosh(np.arccosh(np.maximum(t, 1.0)) / 3)
    return 2 / math.sqrt(3) * np.where(t < 1, inside, beyond)
