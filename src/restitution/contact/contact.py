"""The contact before it is loaded: bodies, surface and yield, and the gap between them.

Conventions: gap > 0 open, pressure > 0 compressive, indentation (approach of the bodies) > 0
closing and zero at the first touch of the undeformed bodies. Arrays `[i, j]` ↔ `[x, y]` at cell
centres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.contact.bodies import Pair
from restitution.contact.detachment import Detachment
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import freeze
from restitution.surfaces import Surface, rms_slope
from restitution.theory import JKR, yield_coefficient

Plasticity = Literal["expanding-cavity", "equilibrium", "truncated"]
Approach = Literal["equilibrium", "hertzian", "pull-increments"]
FULL_CONSTRAINT = 2.8  # pressure over yield strength of fully plastic contact (Tabor 1951)
_OFF_NODE = 0.31, 0.17  # of a cell: no symmetry of the grid maps this point onto itself


@dataclass(frozen=True)
class Contact:
    """A pair of bodies whose composite roughness is `surface`.

    Bodies yield by their `yield_strength` (Pa, of a tensile test) or by a `yield_pressure` (Pa, the
    largest pressure the surface carries: a hardness, about 2.8 times the yield strength); at most
    one of them is finite, and elastic bodies have neither. `plasticity` is

    * `expanding-cavity`, for a yield strength: the largest pressure grows with deformation, see
      `cavity`; `tangent_modulus` (Pa) is the slope of the tensile stress over strain after yield;
    * `equilibrium`, for a yield pressure: pressure and surface in equilibrium under that bound;
    * `truncated`: the elastic pressure truncated at the yield pressure (Thornton and Ning 1998).

    None is the first for a yield strength, else the second.

    Contacts are equal (and hash alike) when their values are equal and their surface is the same
    object. `gap` and `elongation` are computed once, and read-only.

    Raises `CaseError` for values that are none or do not go together, and for a pair or a surface
    that is none.
    """

    pair: Pair
    surface: Surface
    yield_pressure: float = math.inf
    plasticity: Plasticity | None = None
    work_of_adhesion: float = 0.0
    approach: Approach = "equilibrium"
    detachment: Detachment = "crack-closure"
    yield_strength: float = math.inf
    tangent_modulus: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.pair, Pair):
            raise CaseError(
                f"pair: {_kind(self.pair)} is not a pair of bodies; give Pair(first, second), the "
                "same body twice for two equal spheres"
            )
        if not isinstance(self.surface, Surface):
            raise CaseError(
                f"surface: {_kind(self.surface)} is not a surface; give Surface(height, grid), or "
                "what generate_surface and read_surface return"
            )
        for name, value, known in (
            ("plasticity", self.plasticity, (None, *get_args(Plasticity))),
            ("approach", self.approach, get_args(Approach)),
            ("detachment", self.detachment, get_args(Detachment)),
        ):
            if value not in known:
                names = ", ".join(filter(None, known))
                raise CaseError(f'{name}: "{value}" is not one of {names}')
        # The compiled loops take double precision only.
        for name in ("yield_pressure", "work_of_adhesion", "yield_strength", "tangent_modulus"):
            object.__setattr__(self, name, float(getattr(self, name)))
        if not self.yield_pressure > 0:
            raise CaseError(f"yield_pressure: {self.yield_pressure} Pa is not positive")
        if not self.yield_strength > 0:
            raise CaseError(f"yield_strength: {self.yield_strength} Pa is not positive")
        grows = math.isfinite(self.yield_strength)
        if self.plasticity is None:
            model = "expanding-cavity" if grows else "equilibrium"
            object.__setattr__(self, "plasticity", model)
        if grows != (self.plasticity == "expanding-cavity"):
            raise CaseError(
                f'plasticity: "{self.plasticity}" takes a '
                + ("yield_pressure, not a yield_strength" if grows else "yield_strength")
            )
        if grows and math.isfinite(self.yield_pressure):
            raise CaseError("yield_strength, yield_pressure: only one of them can be given")
        softest = min(body.youngs_modulus for body in (self.pair.first, self.pair.second))
        if not 0 <= self.tangent_modulus < softest:
            raise CaseError(
                f"tangent_modulus: {self.tangent_modulus:g} Pa is not zero or more and below "
                f"Young's modulus, {softest:g} Pa"
            )
        if self.tangent_modulus and not grows:
            raise CaseError("tangent_modulus: hardening needs a yield_strength")
        if not 0 <= self.work_of_adhesion < math.inf:
            raise CaseError(f"work_of_adhesion: {self.work_of_adhesion} J/m2 is not zero or more")

    @property
    def grows(self) -> bool:
        """Whether the yield bound grows with deformation (`expanding-cavity`)."""
        return self.plasticity == "expanding-cavity"

    @property
    def hardness(self) -> float:
        """Pressure of a fully plastic contact, Pa; inf for elastic bodies."""
        return FULL_CONSTRAINT * self.yield_strength if self.grows else self.yield_pressure

    @property
    def first_yield_pressure(self) -> float:
        """Largest pressure (Pa) under which smooth bodies stay elastic; inf for elastic bodies.

        `yield_coefficient` times the yield strength, with the mean Poisson's ratio of both bodies,
        or the yield pressure.
        """
        if not self.grows:
            return self.yield_pressure
        nu = 0.5 * (self.pair.first.poissons_ratio + self.pair.second.poissons_ratio)
        return float(yield_coefficient(nu)) * self.yield_strength

    @property
    def hardening_modulus(self) -> float:
        """Slope of the flow stress over *plastic* strain, Pa: E_t/(1 − E_t/E)."""
        E = min(body.youngs_modulus for body in (self.pair.first, self.pair.second))
        return self.tangent_modulus / (1 - self.tangent_modulus / E)

    @property
    def truncates(self) -> bool:
        """Whether the elastic pressure is truncated at p_y (`truncated`)."""
        return self.plasticity == "truncated" and math.isfinite(self.yield_pressure)

    @property
    def adhesive(self) -> bool:
        """Whether nodes in contact can carry tension."""
        return self.work_of_adhesion > 0

    @property
    def adhesive_length(self) -> float:
        """Length scale of adhesion, (w²R*/E*²)^⅓, m; 0 without adhesion."""
        if not self.adhesive:
            return 0.0
        pair = self.pair
        return float(JKR(pair.radius, pair.contact_modulus, self.work_of_adhesion).adhesive_length)

    @property
    def crack_opening(self) -> float:
        """How far the surfaces part over the first cell outside an edge that lets go, m.

        1.86 sqrt(w h/E*) on a straight edge of the grid; see `detachment`.
        """
        h = math.sqrt(self.grid.cell_area)
        return 1.86 * math.sqrt(self.work_of_adhesion * h / self.pair.contact_modulus)

    def residual_length(self, indentation: float) -> float:
        """The length that residuals at `indentation` (m) are divided by, m."""
        return max(abs(indentation), self.adhesive_length)

    @property
    def grid(self) -> Grid:
        """The grid of the surface, on which everything is solved."""
        return self.surface.grid

    def _summary(self) -> list[str]:
        yields = "elastic"
        if self.grows:
            yields = f"yield strength {quantity(self.yield_strength, 'Pa')} ({self.plasticity})"
        elif math.isfinite(self.yield_pressure):
            yields = f"yield pressure {quantity(self.yield_pressure, 'Pa')} ({self.plasticity})"
        w = quantity(self.work_of_adhesion, "J/m²")
        adheres = f", work of adhesion {w}" if self.adhesive else ""
        roughness, _, grid = self.surface._summary()
        return [self.pair._reduced(), f"{yields}{adheres}", f"{roughness}; {grid}"]

    __repr__ = summary_text
    _repr_html_ = summary_html

    @property
    def apex(self) -> tuple[float, float]:
        """x and y of the lowest point of the smooth bodies, m: on a node, the origin.

        An adhesive contact without roughness (`smooth`) has it between nodes. Centred on a node,
        whole rings of nodes attach and release at once: twice the error of restitution.
        """
        if not self.adhesive or self.surface.provenance.get("source") != "smooth":
            return 0.0, 0.0
        hx, hy = self.grid.spacing
        return _OFF_NODE[0] * hx, _OFF_NODE[1] * hy

    @cached_property
    def slope(self) -> float:
        """The rms slope of the surface."""
        return rms_slope(self.surface)

    @cached_property
    def gap(self) -> NDArray[np.float64]:
        """Initial gap h₀ = (x² + y²)/(2R*) − z, shifted to min h₀ = 0; shape `grid.nodes`, m.

        x and y count from the lowest point of the undeformed bodies, `apex`.
        """
        axes = zip((self.grid.x, self.grid.y), self.apex, strict=True)
        x, y = ((along - centre) ** 2 / (2 * self.pair.radius) for along, centre in axes)
        gap: NDArray[np.float64] = np.add.outer(x, y)
        gap -= self.surface.height  # in place: other arrays of this size would take as long
        gap -= gap.min()
        return freeze(gap)

    @cached_property
    def elongation(self) -> NDArray[np.float64]:
        """How elongated asperities are at each node, (1 − κ₂/κ₁)²; shape `grid.nodes`.

        κ₂ and κ₁ are the smaller and the larger curvature of the gap in size, by second
        differences: 0 where it is round and 1 along a ridge. The outermost nodes of the grid, which
        no contact may reach, have 0.
        """
        gap, inner = self.gap, slice(1, -1)
        hx, hy = self.grid.spacing
        elongation = np.zeros(self.grid.nodes)
        xx = (gap[2:, inner] - 2 * gap[inner, inner] + gap[:-2, inner]) / hx**2
        yy = (gap[inner, 2:] - 2 * gap[inner, inner] + gap[inner, :-2]) / hy**2
        xy = (gap[2:, 2:] - gap[2:, :-2] - gap[:-2, 2:] + gap[:-2, :-2]) / (4 * hx * hy)
        mean, spread = 0.5 * np.abs(xx + yy), np.hypot(0.5 * (xx - yy), xy)
        larger = mean + spread
        ratio = np.divide(np.abs(mean - spread), larger, out=np.ones_like(larger), where=larger > 0)
        elongation[inner, inner] = (1 - ratio) ** 2
        return freeze(elongation)


def _kind(value: object) -> str:
    """What `value` is, in words."""
    return f"an object of type {type(value).__name__}"


def smooth(grid: Grid) -> Surface:
    """The surface without roughness on `grid`."""
    return Surface(freeze(np.zeros(grid.nodes)), grid, {"source": "smooth", "kind": "smooth"})
