"""The traction law of the nodes of a contact, and the law with the bound of the pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.state import Array
from restitution.numerics.box import Box

if TYPE_CHECKING:
    from restitution.contact.cohesive.law import CohesiveLaw, NodeLaw

# Gaps that differ by less than this fraction of z₀ are joined by the tangent, not by the chord.
_TANGENT = 1e-3


def law_of(contact: Contact) -> CohesiveLaw:
    return cast("CohesiveLaw", contact.adhesion)


def nodes_of(contact: Contact, box: Box) -> NodeLaw:
    return law_of(contact).at_nodes(contact, box)


class BoundedLaw:
    """The traction law of the nodes of a box, as a function of their elastic displacement u.

    The gap is `base` + u. If the bodies yield, the pressure does not exceed `limit` (Pa). For
    elastic bodies, the law is continued linearly above the pressure E*, which keeps the pressure
    finite if the iteration reaches negative gaps. The limit is reached at the gap `least` (m).
    """

    def __init__(
        self, contact: Contact, base: Array, limit: Array | float, box: Box | None = None
    ) -> None:
        self.base = base
        self.yields = bool(np.all(np.isfinite(limit)))
        bound = np.asarray(limit if self.yields else contact.pair.contact_modulus, dtype=float)
        self._law = law_of(contact) if box is None else nodes_of(contact, box)
        self._z0 = law_of(contact).equilibrium_separation
        self.steep = self._law.steep
        self.least = self._law.gap_at(bound)
        self._slope = -bound
        self._stiff = 0.0 if self.yields else self._law.stiffness(self.least)

    def __call__(self, u: Array) -> tuple[Array, Array, Array]:
        """Return energy (J/m²), attraction (Pa) and stiffness (Pa/m) at the displacement `u`."""
        gap = self.base + u
        inside = np.maximum(gap, self.least)
        energy, slope, stiff = self._law.potential(inside)
        below = gap - inside
        if below.any():
            energy += below * (self._slope + 0.5 * self._stiff * below)
            if not self.yields:
                slope += self._stiff * below
            np.copyto(stiff, self._stiff, where=below < 0)
        return energy, slope, stiff

    def secant(self, u: Array, p: Array, slope: Array, stiff: Array) -> Array:
        """Slope (Pa/m) of the chord between the gap of a node and the gap at its pressure `p`.

        The repulsion is so steep that Newton steps along its tangent would be far too short or too
        long, but the pressures of a step are nearly right.
        """
        gap, z0 = self.base + u, self._z0
        at = np.flatnonzero((p > 0) | (gap < z0))
        limit = np.broadcast_to(-self._slope, p.shape).ravel()[at]
        wanted = np.maximum(p.ravel()[at], 0.0)
        goal = self._law.gap_at(np.minimum(wanted, limit))
        if not self.yields:
            goal -= np.maximum(wanted - limit, 0.0) / self._stiff
        way = gap.ravel()[at] - goal
        far = np.abs(way) > _TANGENT * z0
        chord = np.zeros_like(way)
        np.divide((p + slope).ravel()[at], way, out=chord, where=far)
        slopes: Array = stiff.copy()
        slopes.ravel()[at] = np.where(chord > 0, chord, slopes.ravel()[at])
        return slopes

    def beyond(self, u: Array) -> Array:
        """Distance (m) by which the gap is smaller than `least`: the new plastic displacement."""
        return np.maximum(self.least - self.base - u, 0.0)

    def continuation(self, u: Array) -> Array:
        """Energy (J/m²) of the linear continuation."""
        below = -self.beyond(u)
        return below * (self._slope + 0.5 * self._stiff * below)
