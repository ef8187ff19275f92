"""The contact before loading: bodies, surface, models, and the gap between the bodies.

Conventions: a gap above 0 is open, and a pressure above 0 is compressive. The indentation is the
approach of the bodies since first touch; in a periodic contact, that of the mean planes. Arrays are
indexed `[i, j]` along x and y and hold values at cell centres.
"""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.contact.asperities import crest_gap_of, elongation_of
from restitution.contact.bodies import Pair
from restitution.contact.models import Adhesion, Plasticity
from restitution.contact.plasticity.bound import Elastic
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import ArgumentError, CaseError, shown
from restitution.numerics.box import Box
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import freeze
from restitution.surfaces import Surface, rms_slope

Yields = Literal["first", "second", "both"]

# Position (cells) of the apex of smooth adhesive bodies relative to a node, see `Contact.apex`. The
# apex is off every symmetry axis of the grid, so that nodes do not attach or detach in groups.
_OFF_NODE = 0.31, 0.17

# The form that replaces an argument of older versions.
_OLDER = {
    "yield_pressure": "plasticity=ConstantBound(yield_pressure)",
    "yield_strength": "plasticity=ExpandingCavity(yield_strength)",
    "tangent_modulus": "plasticity=ExpandingCavity(yield_strength, tangent_modulus)",
    "work_of_adhesion": "adhesion=JKRLimit(work_of_adhesion) or Cohesive(work_of_adhesion)",
    "approach": "adhesion=JKRLimit(work_of_adhesion, approach=…)",
    "detachment": "adhesion=JKRLimit(work_of_adhesion, detachment=…)",
    "equilibrium_separation": "adhesion=Cohesive(work_of_adhesion, equilibrium_separation)",
}

_MODELS: dict[str, tuple[Any, str]] = {
    "plasticity": (
        Plasticity,
        "Elastic(), ConstantBound(yield_pressure), ExpandingCavity(yield_strength) or "
        "Truncated(yield_pressure)",
    ),
    "adhesion": (Adhesion | None, "JKRLimit(work_of_adhesion), Cohesive(work_of_adhesion) or None"),
}


def _naming_new_form(contact: type[Contact]) -> type[Contact]:
    known: Callable[..., None] = contact.__init__

    @functools.wraps(known)
    def checked(self: Contact, *args: Any, **kwargs: Any) -> None:
        for name in kwargs:
            if name in _OLDER:
                raise ArgumentError(
                    f"{name}: is part of a model now; call Contact(pair, surface, {_OLDER[name]})"
                )
        models = dict(zip(_MODELS, args[2:], strict=False)) | kwargs
        for name, value in models.items():
            if name in _MODELS and not isinstance(value, _MODELS[name][0]):
                raise ArgumentError(f"{name}: {shown(value)} is no model; use {_MODELS[name][1]}")
        known(self, *args, **kwargs)

    contact.__init__ = checked  # type: ignore[method-assign]
    return contact


@_naming_new_form
@typed
@dataclass(frozen=True)
class Contact:
    """A pair of bodies whose composite roughness is `surface`.

    Contacts are equal (and have equal hashes) if their attributes are equal and their surface is
    the same object.

    Attributes:
        pair: The two bodies.
        surface: Composite roughness, on the grid of the contact.
        plasticity: How the bodies yield: `Elastic`, `ConstantBound`, `ExpandingCavity`,
            `Truncated`, or another `Plasticity`.
        adhesion: How the surfaces attract each other: None, `JKRLimit`, `Cohesive`, or another
            `CohesiveLaw`.
        periodic: Whether both bodies are flat and the surface repeats without end along x and y.
        yields: Body that yields; None if unknown. Only `model_error` depends on it.

    Raises:
        CaseError: A value is invalid, two values exclude each other, or an argument has a wrong
            type.
    """

    pair: Pair
    surface: Surface
    plasticity: Plasticity = Elastic()
    adhesion: Adhesion | None = None
    periodic: bool = False
    yields: Yields | None = None

    def __post_init__(self) -> None:
        if self.yields not in (None, *get_args(Yields)):
            names = ", ".join(get_args(Yields))
            raise CaseError(f'yields: "{self.yields}" is not one of {names}')
        self.plasticity.check(self.pair)
        if self.adhesion is not None:
            self.adhesion.check(self)
            object.__setattr__(self, "adhesion", self.adhesion.of_contact(self))
        if self.periodic:
            self._check_period()
        elif self.pair.flat:
            raise CaseError(
                "first.radius, second.radius: both bodies are flat; one must be a sphere, or the "
                "contact must be periodic"
            )

    def _check_period(self) -> None:
        if not self.pair.flat:
            raise CaseError(
                "periodic: a periodic contact needs two flat bodies (radius inf); describe any "
                "curvature by the heights of the surface"
            )
        if np.ptp(self.surface.height) == 0:
            raise CaseError("surface: all heights are equal; a periodic contact needs roughness")
        if not self.plasticity.for_periodic:
            raise CaseError(
                "plasticity: a periodic contact must be elastic or have a constant pressure bound; "
                "for bodies that yield, use ConstantBound(yield_pressure)"
            )

    @property
    def hardness(self) -> float:
        """Pressure of a fully plastic contact (Pa); inf for elastic bodies."""
        return self.plasticity.hardness

    @property
    def first_yield_pressure(self) -> float:
        """Largest pressure at which smooth bodies stay elastic (Pa); inf for elastic bodies."""
        return self.plasticity.first_yield_pressure(self.pair)

    @property
    def adhesive(self) -> bool:
        """Whether the surfaces attract each other."""
        return self.adhesion is not None and self.adhesion.attracts

    @property
    def grid(self) -> Grid:
        """Grid of the surface, on which the contact is solved."""
        return self.surface.grid

    def _summary(self) -> list[str]:
        adheres = ""
        if self.adhesion is not None:
            w = quantity(self.adhesion.work_of_adhesion, "J/m²")
            adheres = f", work of adhesion {w}"
        roughness, _, grid = self.surface._summary()
        grid += ", periodic" if self.periodic else ""
        lines = [f"{self.plasticity.describe()}{adheres}", f"{roughness}; {grid}"]
        return [self.pair._reduced(), *lines]

    __repr__ = summary_text
    _repr_html_ = summary_html

    @property
    def apex(self) -> tuple[float, float]:
        """Coordinates x and y of the lowest point of the smooth bodies (m).

        In an adhesive contact of `smooth` bodies, the apex lies between nodes. At a node, whole
        rings of nodes would attach and detach at once, which would double the error of COR.
        """
        if self.adhesion is None or self.surface.provenance.get("source") != "smooth":
            return 0.0, 0.0
        hx, hy = self.grid.spacing
        return _OFF_NODE[0] * hx, _OFF_NODE[1] * hy

    @cached_property
    def slope(self) -> float:
        """Root mean square slope of the surface (dimensionless)."""
        return rms_slope(self.surface)

    @cached_property
    def gap(self) -> NDArray[np.float64]:
        """Initial gap h₀ = (x² + y²)/(2R*) − z (m), shifted to min h₀ = 0, shape `grid.nodes`."""
        axes = zip((self.grid.x, self.grid.y), self.apex, strict=True)
        x, y = ((along - centre) ** 2 / (2 * self.pair.radius) for along, centre in axes)
        gap: NDArray[np.float64] = np.add.outer(x, y)
        gap -= self.surface.height  # in place: allocating a new array takes as long as subtracting
        gap -= gap.min()
        return freeze(gap)

    @cached_property
    def smallest_gaps(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Smallest initial gap (m) along each row and along each column of nodes."""
        return freeze(self.gap.min(axis=1)), freeze(self.gap.min(axis=0))

    @cached_property
    def mean_offset(self) -> float:
        """Gap (m) at the apex between the smooth shapes of the bodies, at the mean heights."""
        at = tuple(n // 2 for n in self.grid.nodes)  # the origin
        r2 = sum(along**2 for along in self.apex)
        height = self.surface.height
        rise = float(height[at] - height.mean()) - float(r2) / (2 * self.pair.radius)
        return float(self.gap[at]) + rise

    @cached_property
    def elongation(self) -> NDArray[np.float64]:
        """Elongation of the asperity at each node (dimensionless), see `contact.asperities`."""
        return elongation_of(self.gap, self.grid.spacing)

    @cached_property
    def crest_gap(self) -> NDArray[np.float64]:
        """Initial gap (m) at the crest of each node's asperity, see `contact.asperities`."""
        return crest_gap_of(self.gap)


def whole_grid(contact: Contact) -> Box:
    nx, ny = contact.grid.nodes
    return slice(0, nx), slice(0, ny)


@typed
def smooth(grid: Grid) -> Surface:
    """Make a surface without roughness.

    Args:
        grid: Grid of the surface.

    Returns:
        Surface with all heights 0.
    """
    return Surface(freeze(np.zeros(grid.nodes)), grid, {"source": "smooth", "kind": "smooth"})
