"""The contact before loading: bodies, surface, yield model, and the gap between the bodies.

Conventions: a gap above 0 is open, and a pressure above 0 is compressive. The indentation (approach
of the bodies) is 0 at the first touch of the undeformed bodies and grows as the bodies approach. In
a periodic contact, the indentation is the approach of the mean planes of the two surfaces since
first touch, which equals the decrease of the mean gap. Arrays are indexed `[i, j]` along x and y
and hold values at cell centres.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from restitution.arguments import typed
from restitution.contact.asperities import crest_gap_of, elongation_of
from restitution.contact.bodies import Pair
from restitution.contact.jkr.detachment import Detachment
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError
from restitution.numerics.box import Box
from restitution.numerics.grid import Grid
from restitution.numerics.read_only import freeze
from restitution.surfaces import Surface, rms_slope
from restitution.theory import JKR

Plasticity = Literal["expanding-cavity", "equilibrium", "truncated"]
Approach = Literal["equilibrium", "hertzian", "pull-increments"]
Adhesion = Literal["jkr", "cohesive"]
Yields = Literal["first", "second", "both"]
EQUILIBRIUM_SEPARATION = 0.3e-9  # default range of the attraction z₀ (m)

# Ratio of pressure to yield strength of a fully plastic contact (Tabor 1951).
FULL_CONSTRAINT = 2.8

# Position (cells) of the apex of smooth adhesive bodies relative to a node, see `Contact.apex`. The
# apex is off every symmetry axis of the grid, so that nodes do not attach or detach in groups.
_OFF_NODE = 0.31, 0.17


@typed
@dataclass(frozen=True)
class Contact:
    """A pair of bodies whose composite roughness is `surface`.

    At most one of `yield_strength` and `yield_pressure` is finite; for elastic bodies both are
    infinite. The models of `plasticity` are

    * `expanding-cavity`: needs a yield strength. The pressure bound grows with deformation, see
      `contact.plasticity.cavity`.
    * `equilibrium`: the yield pressure is a constant bound of the pressure. Under this bound, the
      pressure is in equilibrium with the deformed surface.
    * `truncated`: needs a yield pressure. The elastic pressure is truncated at the yield pressure
      (Thornton and Ning 1998, Powder Technol. 99, 154–162).

    Contacts are equal (and have equal hashes) if their attributes are equal and their surface is
    the same object. `gap`, `elongation` and `crest_gap` are computed once and are read-only.

    Attributes:
        pair: The two bodies.
        surface: Composite roughness, on the grid of the contact.
        yield_pressure: Pressure (Pa) at which the surface yields: a hardness, about 2.8 times the
            yield strength. inf if unused.
        plasticity: Model of yielding. None selects `expanding-cavity` if a yield strength is given
            and `equilibrium` otherwise.
        work_of_adhesion: Work of adhesion w (J/m²); 0 without adhesion.
        approach: How adhesion acts during loading. `equilibrium` finds the adhesive equilibrium at
            each depth. `pull-increments` loads without adhesion and then retracts the bodies by
            0.1 nm with adhesion. `hertzian` loads without adhesion.
        detachment: Criterion by which nodes are released, see `contact.detachment`.
        yield_strength: Yield strength of a tensile test (Pa); inf if unused.
        tangent_modulus: Slope of the stress-strain curve of a tensile test after yield (Pa), for
            `expanding-cavity`.
        adhesion: Range of the attraction. With `jkr` the range is zero (the limit of soft bodies).
            `cohesive` uses the Lennard-Jones law of `theory.LennardJones`, see `contact.cohesive`.
        equilibrium_separation: Gap z₀ (m) at which the traction of `cohesive` is zero. It sets the
            range of the attraction.
        periodic: Whether both bodies are flat and the surface repeats without end along x and y. A
            periodic contact is elastic or has a constant pressure bound (`equilibrium`). The bodies
            attract each other over a finite range (`cohesive`) or not at all.
        yields: Body that yields; None if unknown. Only `model_error` depends on it.

    Raises:
        CaseError: A value is invalid, two values exclude each other, or `pair` or `surface` has a
            wrong type.
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
    adhesion: Adhesion = "jkr"
    equilibrium_separation: float = EQUILIBRIUM_SEPARATION
    periodic: bool = False
    yields: Yields | None = None

    def __post_init__(self) -> None:
        for name, value, known in (
            ("plasticity", self.plasticity, (None, *get_args(Plasticity))),
            ("approach", self.approach, get_args(Approach)),
            ("detachment", self.detachment, get_args(Detachment)),
            ("adhesion", self.adhesion, get_args(Adhesion)),
            ("yields", self.yields, (None, *get_args(Yields))),
        ):
            if value not in known:
                names = ", ".join(filter(None, known))
                raise CaseError(f'{name}: "{value}" is not one of {names}')
        # The compiled loops accept only double precision, so convert all other types of numbers.
        for name in (
            "yield_pressure",
            "work_of_adhesion",
            "yield_strength",
            "tangent_modulus",
            "equilibrium_separation",
        ):
            object.__setattr__(self, name, float(getattr(self, name)))
        for name in ("yield_pressure", "yield_strength"):
            if not (value := getattr(self, name)) > 0:
                raise CaseError(f"{name}: {value} Pa is not positive")
        grows = math.isfinite(self.yield_strength)
        if self.plasticity is None:
            object.__setattr__(self, "plasticity", "expanding-cavity" if grows else "equilibrium")
        if grows != (self.plasticity == "expanding-cavity"):
            raise CaseError(
                f'plasticity: "{self.plasticity}" takes a '
                + ("yield_pressure, not a yield_strength" if grows else "yield_strength")
            )
        if grows and math.isfinite(self.yield_pressure):
            raise CaseError("yield_strength, yield_pressure: both are given; give only one of them")
        softest = min(body.youngs_modulus for body in (self.pair.first, self.pair.second))
        if not 0 <= self.tangent_modulus < softest:
            raise CaseError(
                f"tangent_modulus: {self.tangent_modulus:g} Pa is not between 0 and Young's "
                f"modulus, {softest:g} Pa"
            )
        if self.tangent_modulus and not grows:
            raise CaseError("tangent_modulus: hardening needs a yield_strength")
        if not 0 <= self.work_of_adhesion < math.inf:
            raise CaseError(
                f"work_of_adhesion: {self.work_of_adhesion} J/m2 is negative or not finite"
            )
        if not 0 < self.equilibrium_separation < math.inf:
            raise CaseError(
                f"equilibrium_separation: {self.equilibrium_separation} m is not a positive length"
            )
        if self.adhesion == "cohesive":
            require_cohesive(self.approach, self.detachment, self.plasticity)
        self._check_period()

    def _check_period(self) -> None:
        if not self.periodic:
            if self.pair.flat:
                raise CaseError(
                    "first.radius, second.radius: both bodies are flat; one must be a sphere, or "
                    "the contact must be periodic"
                )
            return
        if not self.pair.flat:
            raise CaseError(
                "periodic: a periodic contact needs two flat bodies (radius inf); describe any "
                "curvature by the heights of the surface"
            )
        if np.ptp(self.surface.height) == 0:
            raise CaseError("surface: all heights are equal; a periodic contact needs roughness")
        if self.adhesive and not self.cohesive:
            raise CaseError(
                'adhesion: "jkr" is not defined for a periodic contact; use "cohesive", or leave '
                "out work_of_adhesion"
            )
        if self.plasticity != "equilibrium":
            raise CaseError(
                "plasticity: a periodic contact must be elastic or have a constant pressure bound; "
                'for bodies that yield, give a yield_pressure and plasticity "equilibrium"'
            )

    @property
    def grows(self) -> bool:
        """Whether the yield bound grows with deformation (`expanding-cavity`)."""
        return self.plasticity == "expanding-cavity"

    @property
    def hardness(self) -> float:
        """Pressure of a fully plastic contact (Pa); inf for elastic bodies."""
        return FULL_CONSTRAINT * self.yield_strength if self.grows else self.yield_pressure

    @property
    def first_yield_pressure(self) -> float:
        """Largest pressure at which smooth bodies stay elastic (Pa); inf for elastic bodies."""
        return self.pair.first_yield_pressure(self.yield_pressure, self.yield_strength)

    @property
    def hardening_modulus(self) -> float:
        """Slope of the flow stress against *plastic* strain (Pa).

        It is E_t/(1 − E_t/E) with the tangent modulus E_t and Young's modulus E of the softer body.
        """
        E = min(body.youngs_modulus for body in (self.pair.first, self.pair.second))
        return self.tangent_modulus / (1 - self.tangent_modulus / E)

    @property
    def truncates(self) -> bool:
        """Whether the model `truncated` is used with a finite yield pressure."""
        return self.plasticity == "truncated" and math.isfinite(self.yield_pressure)

    @property
    def adhesive(self) -> bool:
        """Whether the bodies adhere, that is, the work of adhesion is positive."""
        return self.work_of_adhesion > 0

    @property
    def cohesive(self) -> bool:
        """Whether the bodies attract over a finite range (`adhesion = "cohesive"`)."""
        return self.adhesive and self.adhesion == "cohesive"

    @property
    def adhesive_length(self) -> float:
        """Length scale of adhesion (w²R*/E*²)^⅓ (m); 0 without adhesion or between flat bodies."""
        if not self.adhesive or self.pair.flat:
            return 0.0
        return float(
            JKR(self.pair.radius, self.pair.contact_modulus, self.work_of_adhesion).adhesive_length
        )

    @property
    def crack_opening(self) -> float:
        """Gap (m) one cell outside a straight contact edge that is about to recede.

        It is 1.86 sqrt(w h/E*) with the work of adhesion w and the cell size h; see
        `contact.detachment`.
        """
        h = math.sqrt(self.grid.cell_area)
        return 1.86 * math.sqrt(self.work_of_adhesion * h / self.pair.contact_modulus)

    def residual_length(self, indentation: float) -> float:
        """Length by which the residuals of adhesive contacts are divided.

        Args:
            indentation: Approach of the bodies (m).

        Returns:
            The magnitude of the indentation or the length scale of adhesion, whichever is larger
            (m). Flat bodies have no length scale of adhesion; the equilibrium separation replaces
            it.
        """
        return max(abs(indentation), self.adhesive_length or self.equilibrium_separation)

    @property
    def grid(self) -> Grid:
        """Grid of the surface, on which the contact is solved."""
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
        grid += ", periodic" if self.periodic else ""
        return [self.pair._reduced(), f"{yields}{adheres}", f"{roughness}; {grid}"]

    __repr__ = summary_text
    _repr_html_ = summary_html

    @property
    def apex(self) -> tuple[float, float]:
        """Coordinates x and y of the lowest point of the smooth bodies (m).

        In general the apex is the origin, which is a node. In an adhesive contact without roughness
        (`smooth`), however, the apex lies between nodes. If it were a node, whole rings of nodes
        would attach and detach at once, which would double the error of COR.
        """
        if not self.adhesive or self.surface.provenance.get("source") != "smooth":
            return 0.0, 0.0
        hx, hy = self.grid.spacing
        return _OFF_NODE[0] * hx, _OFF_NODE[1] * hy

    @cached_property
    def slope(self) -> float:
        """Root mean square slope of the surface (dimensionless)."""
        return rms_slope(self.surface)

    @cached_property
    def gap(self) -> NDArray[np.float64]:
        """Initial gap h₀ = (x² + y²)/(2R*) − z (m), shifted to min h₀ = 0, shape `grid.nodes`.

        z is the height of the surface, and x and y are measured from `apex`.
        """
        axes = zip((self.grid.x, self.grid.y), self.apex, strict=True)
        x, y = ((along - centre) ** 2 / (2 * self.pair.radius) for along, centre in axes)
        gap: NDArray[np.float64] = np.add.outer(x, y)
        gap -= self.surface.height  # in place: allocating a new array takes as long as subtracting
        gap -= gap.min()
        return freeze(gap)

    @cached_property
    def mean_offset(self) -> float:
        """Gap (m) between the mean surfaces of the bodies at the apex when the bodies first touch.

        The mean surface of a body is its smooth shape at the mean height of its roughness.
        """
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


def require_cohesive(approach: str, detachment: str, plasticity: str | None) -> None:
    """Raise `CaseError` if an option has no meaning with `adhesion = "cohesive"`."""
    if detachment != "crack-closure":
        raise CaseError(
            f'detachment: "{detachment}" belongs to adhesion = "jkr"; a cohesive contact has no '
            "detachment criterion, so leave detachment out"
        )
    if approach != "equilibrium":
        raise CaseError(
            f'approach: "{approach}" belongs to adhesion = "jkr"; cohesive bodies always attract '
            "each other on approach, so leave approach out"
        )
    if plasticity == "truncated":
        raise CaseError(
            'plasticity: "truncated" is not defined with adhesion = "cohesive"; use "equilibrium", '
            'or adhesion = "jkr"'
        )


def whole_grid(contact: Contact) -> Box:
    """Return the whole grid of `contact` as a box."""
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
