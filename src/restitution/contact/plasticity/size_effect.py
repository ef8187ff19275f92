"""Small contacts are harder: geometrically necessary dislocations (docs/size-effect.md).

W. D. Nix, H. Gao, J. Mech. Phys. Solids 46 (1998) 411–425: H = H₀ √(1 + h*/h) for a Berkovich
indenter. The density of dislocations is (3π/4) p̄/(E* a b), with the mean pressure p̄ of a contact
patch of area πa² between elastic bodies at √2 times the indentation, and the Burgers vector b. This
is 1/(bR) for a sphere and, within 3 %, 3 tan²θ/(2bh) for a cone and 3h/(ba²) for a flat punch, as
in J. G. Swadener, E. P. George, G. M. Pharr, J. Mech. Phys. Solids 50 (2002) 681–694.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from scipy.fft import irfft2, next_fast_len, rfft2

from restitution.arguments import typed
from restitution.contact.bodies import Pair
from restitution.contact.contact import Contact
from restitution.contact.equilibrium import candidate_box, elastic_pressure, solve_nonadhesive
from restitution.contact.interface import interface_of
from restitution.contact.models import set_field
from restitution.contact.plasticity.bound import ConstantBound
from restitution.contact.plasticity.increments import ChangingBound
from restitution.contact.state import Array, State
from restitution.display import quantity
from restitution.numerics.box import reframe
from restitution.numerics.contours import contour_means
from restitution.numerics.read_only import freeze

BERKOVICH = 0.358  # tangent of the angle between the surface and a cone that equals the indenter
_DEEPER = math.sqrt(2)  # the elastic pressure is computed at this multiple of the indentation
# Area of a Hertz contact from the entropy of its pressure, over its area: (2/3) e^(1/3).
_OF_HERTZ = 2 / 3 * math.exp(1 / 3)
_RESIDUAL = 1.5e-4  # of the elastic pressure
# Relative error of h*/h. The theory of Nix and Gao makes h* H₀² one constant for all states of a
# metal; in their two states of copper it differs from its geometric mean by this much.
_SCATTER = 0.26
# Depth (m) of the Berkovich indent in whose whole volume the density has reached its largest
# value; hardness is then 4 % below the law at twice this depth, as in MgO (G. Feng, W. D. Nix,
# Scripta Mater. 51 (2004) 599–603).
_SATURATED = 100e-9
_OWN = 1000.0  # weight of a node in its own mean; that of a neighbour is 1
_DIGITS = 1e-18  # least sum of weights above rounding
_FAR = 1e-5  # weight of distance⁻⁴ beside distance⁻⁸, whose transform has no digits far away
_SHARED = 0.5  # part of an imprint in each body if both yield
_INCOMPLETE = 0.99  # largest mean indentation of elastic periodic bodies, over the mean gap


def dislocation_density(contact: Contact, pressure: Array, *, periodic: bool = False) -> Array:
    """Density of dislocations times the Burgers vector (1/m) at each node, 0 without pressure.

    `pressure` (Pa) is that between elastic bodies at √2 times the indentation. Where patches merge,
    the density is the mean over the contours of the pressure that enclose the node.
    """
    density = np.empty(pressure.shape)
    contour_means(np.ascontiguousarray(pressure, dtype=float), periodic, density)
    E, cell = contact.pair.contact_modulus, contact.grid.cell_area
    density *= 0.75 * (math.pi * _OF_HERTZ) ** 1.5 / (E * math.sqrt(cell))
    return density


def strengthening(length: float, density: Array) -> Array:
    """Ratio √(1 + h*/h) of hardness to bulk hardness, for h* = `length` (m)."""
    return np.asarray(np.sqrt(1 + length * density / (1.5 * BERKOVICH**2)))


def strengthening_of_sphere(length: float, radius: float) -> float:
    """`strengthening` of smooth bodies of the reduced `radius` (m), the same at every depth.

    Source: Swadener, George and Pharr (2002).
    """
    return float(strengthening(length, np.asarray(1 / radius)))


def spread(density: Array, pressure: Array, *, periodic: bool) -> Array:
    """Mean density of the nodes around: by pressure/distance⁸ for nodes without pressure.

    Nodes with pressure have their own, but for a share of a mean by pressure²/distance⁴, so that
    no node jumps when a patch begins to touch with a density that rises from zero.
    """
    touching = pressure > 0
    if touching.all():
        return density
    shape = density.shape
    padded = shape if periodic else tuple(next_fast_len(2 * n - 1, real=True) for n in shape)
    x, y = (np.minimum(np.arange(n), n - np.arange(n)) for n in padded)
    squares = np.maximum(x[:, None] ** 2 + y[None, :] ** 2, 1).astype(float)
    weight = pressure / pressure.max()

    def mean(kernel: Array, weight: Array) -> Array:
        of = rfft2(kernel)
        sums = [
            irfft2(of * rfft2(values, padded), padded)[: shape[0], : shape[1]]
            for values in (weight * density, weight)
        ]
        values = sums[0] / np.maximum(sums[1], _DIGITS)
        return np.asarray(np.clip(values, density[touching].min(), density.max()))

    wide = squares**-2
    wide[0, 0] = _OWN
    return np.where(touching, mean(wide, weight**2), mean(squares**-4 + _FAR * squares**-2, weight))


def strengthening_of_waves(contact: Contact, length: float, pressure: Array) -> Array | float:
    """`strengthening_at` on a periodic patch of short waves.

    `pressure` (Pa) is that between elastic bodies at any larger indentation: asperities are round.
    """
    if not length or not pressure.any():
        return 1.0
    density = dislocation_density(contact, pressure, periodic=True)
    return strengthening(length, spread(density, pressure, periodic=True))


def strengthening_at(
    contact: Contact, indentation: float, length: float
) -> tuple[Array | float, int]:
    """`strengthening` on the whole grid, and the number of convolutions that it took."""
    density, count = _density_at(contact, indentation)
    return (1.0 if density is None else strengthening(length, density)), count


@lru_cache(maxsize=4)  # the bound of a state and the error of its hardness need the same
def _density_at(contact: Contact, indentation: float) -> tuple[Array | None, int]:
    """`dislocation_density` on the whole grid, and the number of convolutions that it took.

    Nodes without pressure have a mean of the patches around them; None without any pressure.
    """
    deep = _DEEPER * indentation
    if contact.periodic:
        deep = min(deep, _INCOMPLETE * float(contact.gap.mean()))
        elastic = solve_nonadhesive(contact, deep, math.inf, _RESIDUAL)
        pressure, box, count = elastic.box_pressure, elastic.box, elastic.convolutions
    else:
        pressure, window, count = elastic_pressure(contact, deep, _RESIDUAL)
        box = candidate_box(contact, deep) or window
        pressure = reframe(pressure, window, box)
    if not pressure.any():
        return None, count
    density = dislocation_density(contact, pressure, periodic=contact.periodic)
    density = spread(density, pressure, periodic=contact.periodic)
    around = [(side.start, n - side.stop) for side, n in zip(box, contact.grid.nodes, strict=True)]
    return freeze(np.pad(density, around, mode="edge")), count


def sharpness(state: State) -> tuple[Array, Array]:
    """1/h (1/m) of the Berkovich indents as sharp as what has yielded, and its plastic work (J)."""
    inverse, work = [np.zeros(0)], [np.zeros(0)]
    for contact, indentation, lost in interface_of(state.contact).yielding(state):
        if (some := lost > 0).any():
            inverse.append(_sharpness(contact, indentation)[some])
            work.append(lost[some])
    return np.concatenate(inverse), np.concatenate(work)


def _sharpness(contact: Contact, indentation: float) -> Array:
    ratio, _ = strengthening_at(contact, max(indentation, 0.0), 1.0)
    return np.broadcast_to(np.square(ratio) - 1, contact.grid.nodes)


def hardness_error(length: float, state: State) -> float:
    """Relative error of the hardness in `state` for h* = `length` (m), weighted by plastic work."""
    if not length:
        return 0.0
    inverse, work = sharpness(state)
    if not inverse.size:
        return 0.0
    share = _SHARED if state.contact.yields == "both" else 1.0
    return float(np.average(error_of_law(length / share, share * inverse), weights=work))


def error_of_law(length: float, inverse: Array) -> Array:
    """Relative error of `strengthening` at a sharpness 1/h (1/m) of the imprint in a body.

    Its parts are the scatter of h*, and the largest density that a crystal can have.

    Source:
        Y. Huang et al., J. Mech. Phys. Solids 54 (2006) 1668–1686, for the largest density.
    """
    x, near = length * inverse, np.maximum(_SATURATED * inverse, 1e-12)
    kept = np.where(near < 1, 1 - near**2 / 3, 2 / (3 * near))
    softer = 1 - np.sqrt((1 + x * kept) / (1 + x))
    return np.asarray(np.hypot(softer, 0.5 * _SCATTER * x / (1 + x)))


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
    alike = 1.1  # as bodies of nearly the same strength (case/interface)
    strengths = ("yield_pressure",)

    def __post_init__(self) -> None:
        set_field(self, "yield_pressure", "Pa")
        set_field(self, "size_effect", "m")

    @property
    def hardness(self) -> float:
        return self.yield_pressure

    def of_smooth(self, pair: Pair) -> ConstantBound:
        return ConstantBound(
            self.yield_pressure * strengthening_of_sphere(self.size_effect, pair.radius)
        )

    def describe(self) -> str:
        pressure, length = quantity(self.yield_pressure, "Pa"), quantity(self.size_effect, "m")
        return f"yield pressure {pressure} ({self.label}), size effect h* {length}"

    def bound(
        self, contact: Contact, indentation: float, residual: float
    ) -> tuple[Array | float, int]:
        factor, convolutions = strengthening_at(contact, max(indentation, 0.0), self.size_effect)
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
        waves = strengthening_of_waves(contact, self.size_effect, math.sqrt(2) * measure)
        return np.broadcast_to(self.yield_pressure * waves, measure.shape)

    def hardness_error(self, state: State) -> float:
        return hardness_error(self.size_effect, state)

    def difference(self, contact: Contact, restitution: float) -> float:
        return ConstantBound(self.yield_pressure).difference(contact, restitution)
