"""The traction law of the nodes of a contact, and the law with the bound of the pressure."""

from __future__ import annotations

from typing import TYPE_CHECKING, Protocol, cast

import numpy as np

from restitution.contact.contact import Contact
from restitution.contact.state import Array
from restitution.numerics.box import Box
from restitution.numerics.expressions import Triple, continue_below

if TYPE_CHECKING:
    from restitution.contact.cohesive.law import CohesiveLaw

# Gaps that differ by less than this fraction of z₀ are joined by the tangent, not by the chord.
_TANGENT = 1e-3


class NodeLaw(Protocol):
    """A traction law at certain nodes; the values of a node are in arrays of their shape.

    `steep` tells whether steps along the tangent of its repulsion are poor.
    """

    @property
    def steep(self) -> bool: ...

    @property
    def gap_of_largest_traction(self) -> Array | float: ...

    def potential(self, gap: Array) -> tuple[Array, Array, Array]: ...

    def energy(self, gap: Array) -> Array: ...

    def traction(self, gap: Array) -> Array: ...

    def stiffness(self, gap: Array) -> Array: ...

    def gap_at(self, pressure: Array) -> Array: ...

    def continued(self, base: Array, u: Array, ends: Triple) -> tuple[Array, Array, Array]:
        """New arrays of energy, traction and stiffness at the gap `base` + `u`.

        Below the smallest gaps of `ends`, the law continues with the pressures and stiffnesses.
        """
        gap = base + u
        inside = np.maximum(gap, ends[0])
        energy, slope, stiffness = self.potential(inside)
        continue_below(gap - inside, ends, energy, slope, stiffness)
        return energy, slope, stiffness


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
        self._whole: CohesiveLaw = law_of(contact)
        self._law = self._whole if box is None else nodes_of(contact, box)
        self.steep = self._law.steep
        self.least = self._law.gap_at(bound)
        self._bound: Array = bound
        self._stiff: Array = np.asarray(0.0 if self.yields else self._law.stiffness(self.least))
        least, bound, stiff = (_rows(of, base) for of in (self.least, bound, self._stiff))
        self._ends = least, bound, stiff
        self._soft = _rows(np.asarray(0.0 if self.yields else 1 / self._stiff), base)

    def __call__(self, u: Array) -> tuple[Array, Array, Array]:
        """Return energy (J/m²), attraction (Pa) and stiffness (Pa/m) at the displacement `u`."""
        return self._law.continued(self.base, u, self._ends)

    def secant(self, u: Array, p: Array, slope: Array, stiff: Array) -> Array:
        """Slope (Pa/m) of the chord between the gap of a node and the gap at its pressure `p`.

        The repulsion is so steep that Newton steps along its tangent would be far too short or too
        long, but the pressures of a step are nearly right.
        """
        known, ends = (p, slope, stiff), (self._ends[1], self._soft)
        least_way = _TANGENT * self._whole.equilibrium_separation
        return self._whole.chords(self.base, u, known, ends, least_way)

    def beyond(self, u: Array) -> Array:
        """Distance (m) by which the gap is smaller than `least`: the new plastic displacement."""
        return np.maximum(self.least - self.base - u, 0.0)

    def continuation(self, u: Array) -> Array:
        """Energy (J/m²) of the linear continuation."""
        below = -self.beyond(u)
        return below * (0.5 * self._stiff * below - self._bound)


def _rows(values: Array, like: Array) -> Array:
    """`values` in the shape of `like`, as the compiled loops take them."""
    if values.ndim == 0:
        values = np.full(like.shape[-1:], values)
    return np.broadcast_to(values, like.shape)
