"""Small contacts are harder: geometrically necessary dislocations (docs/size-effect.md).

W. D. Nix, H. Gao, J. Mech. Phys. Solids 46 (1998) 411–425: H = H₀ √(1 + h*/h) for a Berkovich
indenter. The density of dislocations is (3π/4) p̄/(E* a b), with the mean pressure p̄ of a contact
patch of area πa² between elastic bodies at twice the indentation, and the Burgers vector b. This is
3 tan²θ/(2bh) for a cone (within 5 %), 1/(bR) for a sphere and 3h/(ba²) for a flat punch, as in
J. G. Swadener, E. P. George, G. M. Pharr, J. Mech. Phys. Solids 50 (2002) 681–694.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.arguments import typed
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import elastic_pressure, solve_nonadhesive
from restitution.contact.models import set_field
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.increments import ChangingBound
from restitution.contact.state import Array, State
from restitution.display import quantity
from restitution.numerics.box import Box
from restitution.numerics.contours import contour_means
from restitution.numerics.read_only import freeze

BERKOVICH = 0.358  # tangent of the angle between the surface and a cone that equals the indenter
_DEPTH_FACTOR = 2.0  # the elastic pressure is computed at this multiple of the indentation
_RESIDUAL = 1.5e-4  # of the elastic pressure
_INCOMPLETE = 0.99  # largest mean indentation of elastic periodic bodies, over the mean gap


def equivalent_depth(density: Array) -> Array:
    """Depth (m) of a Berkovich indent with this density of dislocations.

    `density` (1/m) is multiplied by the Burgers vector: 1/R for a sphere.
    """
    with np.errstate(divide="ignore"):
        return np.asarray(1.5 * BERKOVICH**2 / density)


def dislocation_density(contact: Contact, pressure: Array, *, periodic: bool = False) -> Array:
    """Density of dislocations times the Burgers vector (1/m) at each node, 0 without pressure.

    `pressure` (Pa) is that between elastic bodies at twice the indentation, 0 where the undeformed
    surfaces do not overlap at the indentation. Where patches merge, the density is the mean over
    the contours of the pressure that enclose the node.
    """
    density = np.empty(pressure.shape)
    contour_means(np.ascontiguousarray(pressure, dtype=float), periodic, density)
    E, cell = contact.pair.contact_modulus, contact.grid.cell_area
    density *= 0.75 * math.pi**1.5 / (E * math.sqrt(cell))
    return density


def strengthening(length: float, density: Array) -> Array:
    """Ratio √(1 + h*/h) of hardness to bulk hardness, for h* = `length` (m)."""
    return np.asarray(np.sqrt(1 + length * density / (1.5 * BERKOVICH**2)))


def strengthening_of_waves(
    contact: Contact, depth: float, length: float, pressure: Array
) -> Array | float:
    """`strengthening` on the nodes of a periodic patch of short waves, as `strengthening_at`."""
    if not length:
        return 1.0
    pressure = np.where(contact.gap < depth, pressure, 0.0)
    return strengthening(length, dislocation_density(contact, pressure, periodic=True))


def strengthening_at(
    contact: Contact, indentation: float, length: float, elastic: tuple[Array, Box]
) -> Array | float:
    """`strengthening` on the whole grid; nodes without pressure have that of the nearest patch.

    `elastic` is the pressure (Pa) between elastic bodies at twice the `indentation` (m), on a box.
    """
    from scipy.ndimage import distance_transform_edt

    pressure, box = elastic
    if pressure.size == 0:
        return 1.0
    pressure = np.where(contact.gap[box] < indentation, pressure, 0.0)
    if not (touching := pressure > 0).any():
        return 1.0
    density = dislocation_density(contact, pressure, periodic=contact.periodic)
    factor = strengthening(length, density)
    if not touching.all():
        nearest = distance_transform_edt(~touching, return_distances=False, return_indices=True)
        factor = factor[tuple(nearest)]
    around = [(side.start, n - side.stop) for side, n in zip(box, contact.grid.nodes, strict=True)]
    return np.pad(factor, around, mode="edge")


@typed
@dataclass(frozen=True)
class SizedBound(ChangingBound):
    """A pressure bound that is constant in large contacts, and higher in small ones.

    Attributes:
        yield_pressure: Pressure (Pa) at which the surface yields in large contacts.
        size_effect: Depth h* (m) at which a Berkovich indent is √2 times as hard; half of it if
            both bodies yield alike, because then each has half of the imprint.

    Raises:
        CaseError: A value is not positive.

    Source:
        W. D. Nix, H. Gao, J. Mech. Phys. Solids 46 (1998) 411–425.
    """

    yield_pressure: float
    size_effect: float

    label = "equilibrium"
    for_periodic = True
    strengths = ("yield_pressure",)

    def __post_init__(self) -> None:
        set_field(self, "yield_pressure", "Pa")
        set_field(self, "size_effect", "m")

    @property
    def hardness(self) -> float:
        return self.yield_pressure

    def describe(self) -> str:
        pressure, length = quantity(self.yield_pressure, "Pa"), quantity(self.size_effect, "m")
        return f"yield pressure {pressure} ({self.label}), size effect h* {length}"

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        depth = max(indentation, 0.0)
        if contact.periodic:
            deep = min(_DEPTH_FACTOR * depth, _INCOMPLETE * float(contact.gap.mean()))
            elastic = solve_nonadhesive(contact, deep, math.inf, _RESIDUAL)
            pressure, box = elastic.box_pressure, elastic.box
            convolutions = elastic.convolutions
        else:
            deep = _DEPTH_FACTOR * depth
            pressure, box, convolutions = elastic_pressure(contact, deep, _RESIDUAL)
        factor = strengthening_at(contact, depth, self.size_effect, (pressure, box))
        bound = np.broadcast_to(self.yield_pressure * factor, contact.grid.nodes)
        return freeze(np.ascontiguousarray(bound)), convolutions

    def begun(self, after: State) -> Array | float:
        return after.bound

    def bound_after(
        self, state: State, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        if indentation <= state.indentation:
            return state.bound, 0
        return self.bound(state.contact, indentation, residual)

    def bound_of_waves(
        self, contact: Contact, depth: float, measure: Array, nominal: float
    ) -> Array:
        pressure = math.sqrt(2) * measure  # at twice the indentation
        waves = strengthening_of_waves(contact, depth, self.size_effect, pressure)
        return np.broadcast_to(self.yield_pressure * waves, measure.shape)

    def difference(self, contact: Contact, restitution: float) -> float:
        return ConstantBound(self.yield_pressure).difference(contact, restitution)
