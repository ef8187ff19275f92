"""Published closed forms for the smooth bodies of a case; NaN outside their range of validity.

`hertz` and `sticking` hold up to the pressure of first yield (`onset`). Thornton–Ning uses p_y, the
pressure of a fully plastic contact; the others use the yield strength Y of a tensile test: the
smaller of the two bodies, or p_y/2.8 if one has none or the interface overrides them. SI units.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from restitution.case.case import Case
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.theory import (
    JKR,
    MDR,
    AdhesiveThorntonNing,
    FirstYield,
    Hertz,
    Johnson,
    ThorntonNing,
)

Array = NDArray[np.float64]

STRENGTHS = 2.8
"""Ratio p_y/Y of the pressure of a fully plastic contact to the yield strength."""

_SMALL = 0.01  # largest ratio of indentation to R* for which Hertz's theory is used
_JOHNSON = 0.6  # largest e for which Johnson's formula is used

SOURCES = {
    "hertz": "H. Hertz, J. reine angew. Math. 92 (1882) 156-171",
    "sticking": "JKR, elastic: C. Thornton, Z. Ning, Powder Technology 99 (1998) 154-162",
    "thornton-ning": "C. Thornton, Z. Ning, Powder Technology 99 (1998) 154-162",
    "johnson": "K. L. Johnson, Contact Mechanics (Cambridge, 1985), section 11.5",
    "mdr": "W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492, as in LAMMPS",
    "brilliantov": "P. Mueller, T. Poeschel, Phys. Rev. E 84 (2011) 021302, for the viscoelastic "
    "contact of N. V. Brilliantov et al., Phys. Rev. E 53 (1996) 5382-5392",
}


@dataclass(frozen=True)
class Bodies:
    """The smooth bodies of a case, in SI units.

    `R`, `E` and `m` are R*, E* and m*, and `w` is the work of adhesion.
    """

    R: float
    E: float
    m: float
    p_y: float  # pressure of a fully plastic contact; infinite for elastic bodies
    onset: float  # peak of the contact pressure at first yield; infinite for elastic bodies
    w: float
    wall: int | None  # which body is flat (0 or 1); None for two spheres
    equal: bool  # two identical spheres
    sphere_poisson: float
    # Yield strengths Y of both bodies. None if one is missing, or if the interface overrides them.
    strengths: tuple[float, float] | None
    labels: tuple[str, str]
    separation: float  # equilibrium separation of the surface forces (m)

    @classmethod
    def of(cls, case: Case) -> Bodies:
        """The smooth bodies of `case`. Raises `CaseError` if a density is missing."""
        pair = case.pair()
        for name, body in (("first", pair.first), ("second", pair.second)):
            if body.mass is None:
                raise CaseError(
                    f"{name}.density: is missing, but every theory of restitution needs it; write "
                    f'for example density = "2500 kg/m^3" in [{name}]'
                )
        assert pair.mass is not None  # the loop above checked both densities
        tables, model = tuple(case.bodies().values()), case.yielding().model
        yields = model.of_smooth(pair)
        # A yield strength of the interface overrides those of the bodies.
        own = case.interface.yield_strength is None
        Y_1, Y_2 = (table.yield_strength if own else None for table in tables)
        harder = yields.hardness / model.hardness if model.size_effect else 1.0
        radii = [pair.first.radius, pair.second.radius]
        wall = radii.index(math.inf) if math.inf in radii else None
        return cls(
            R=pair.radius,
            E=pair.contact_modulus,
            m=pair.mass,
            p_y=yields.hardness,
            onset=yields.first_yield_pressure(pair),
            w=case.interface.adhesive_energy,
            wall=wall,
            equal=pair.first == pair.second and Y_1 == Y_2,
            sphere_poisson=(pair.second if wall == 0 else pair.first).poissons_ratio,
            strengths=None if Y_1 is None or Y_2 is None else (harder * Y_1, harder * Y_2),
            labels=(tables[0].material or "first", tables[1].material or "second"),
            separation=case.interface.equilibrium_separation,
        )

    @property
    def hertz(self) -> Hertz:
        """Elastic contact without adhesion."""
        return Hertz(self.R, self.E)

    @property
    def yielding(self) -> ThorntonNing:
        """Elastic-plastic contact without adhesion."""
        return ThorntonNing(self.R, self.E, self.p_y)

    @property
    def sticking(self) -> JKR:
        """Elastic contact with adhesion."""
        return JKR(self.R, self.E, self.w)

    @property
    def elastic(self) -> bool:
        """Whether nothing yields."""
        return math.isinf(self.p_y)

    @cached_property
    def yield_velocity(self) -> float:
        """V_y (m/s), above which the bodies yield somewhere; infinite if elastic."""
        if self.elastic:
            return math.inf
        return float(FirstYield(self.R, self.E, self.onset).velocity(self.m))

    @cached_property
    def sticking_velocity(self) -> float:
        """V_s (m/s), up to which elastic bodies stick; zero without adhesion."""
        return 0.0 if self.w == 0 else float(self.sticking.sticking_velocity(self.m))

    @cached_property
    def small_velocity(self) -> float:
        """Impact velocity (m/s) at which the indentation of a Hertz contact is 0.01 R*."""
        return float(self.hertz.impact_velocity(_SMALL * self.R, self.m))

    @property
    def strength(self) -> float:
        """The smaller yield strength Y (Pa) of the two bodies; p_y/2.8 if `strengths` is None."""
        return self.p_y / STRENGTHS if self.strengths is None else min(self.strengths)

    @property
    def convention(self) -> str:
        """`strength` and its origin, in words."""
        if self.strengths is None:
            return f"Y = p_y/{STRENGTHS:g} = {quantity(self.strength, 'Pa')}"
        softer = self.labels[self.strengths.index(self.strength)]
        return f"Y = {quantity(self.strength, 'Pa')}, the yield_strength of {softer}"

    @property
    def yielding_wall(self) -> bool | None:
        """Whether the wall is softer than the sphere; None if that is unknown or neither."""
        if self.wall is None or self.strengths is None or self.strengths[0] == self.strengths[1]:
            return None
        return self.strengths[self.wall] == self.strength

    def velocity(self, indentation: Array) -> Array:
        """Impact velocity (m/s) at which the maximum indentation is `indentation` (m)."""
        return (self.hertz if self.elastic else self.yielding).impact_velocity(indentation, self.m)

    def depth_under(self, force: Array) -> Array:
        """Indentation (m) under `force` (N)."""
        return (self.hertz if self.elastic else self.yielding).indentation(force)


@dataclass(frozen=True)
class Form:
    """The result of one closed form.

    `restitution` is e at the impact velocities, and `holds` its range of validity in words.
    `takes_strength` says whether it uses Y, and `with_adhesion` whether it includes adhesion.
    """

    restitution: Array
    holds: str
    parameters: dict[str, float] = field(default_factory=dict)
    takes_strength: bool = False
    with_adhesion: bool = False


_ELASTIC = "the case is elastic: nothing yields"


def _hertz(b: Bodies, V: Array) -> Form:
    return Form(
        within(min(b.yield_velocity, b.small_velocity) >= V, np.ones_like(V)),
        f"nothing yields and the contact is small, {_elastic_range(b)}",
        {} if b.elastic else {"yield_pressure_Pa": b.onset},
    )


def _sticking(b: Bodies, V: Array) -> Form | str:
    if b.w == 0:
        return "the case has no work_of_adhesion"
    V_s, V_y = b.sticking_velocity, b.yield_velocity
    limit = min(V_y, b.small_velocity) if V_s < V_y else 0.0
    failing = "" if V_s < V_y else ", so at no velocity here"
    return Form(
        within(limit >= V, b.sticking.restitution(V, b.m)),
        f"nothing yields and the contact is small, {_elastic_range(b)}; V_s < V_y (here V_s = "
        f"{speed(V_s)}){failing}; {_tabor(b)}",
        {"sticking_velocity_m_per_s": V_s, "work_of_adhesion_J_per_m2": b.w},
        with_adhesion=True,
    )


def _thornton_ning(b: Bodies, V: Array) -> Form | str:
    if b.elastic:
        return _ELASTIC
    depth = b.yielding.indentation_from_velocity(V, b.m)
    limit = float(b.yielding.impact_velocity(b.R, b.m))
    deepest = math.sqrt(float(np.max(depth, initial=0.0)) / b.R)
    small = f"a << R* (here a/R* up to {deepest:.2g}; no value above {speed(limit)}, where a = R*)"
    inside = depth < b.R
    parameters = {"yield_pressure_Pa": b.p_y}
    if b.w == 0:
        e = b.yielding.restitution(V, b.m)
        return Form(within(inside, e), f"quasi-static impacts, {small}", parameters)
    V_s, V_y = b.sticking_velocity, float(b.yielding.first_yield.velocity(b.m))
    additive = (
        "sum of the losses by adhesion and by yielding; e is an upper estimate, accurate for V_s "
        f"<< V_y (here V_s = {speed(V_s)}, V_y = {speed(V_y)})"
        if V_s <= V_y
        else f"only up to V_y = {speed(V_y)}, because V_s = {speed(V_s)} is higher"
    )
    return Form(
        within(inside, AdhesiveThorntonNing(b.R, b.E, b.p_y, b.w).restitution(V, b.m)),
        f"{additive}; {small}; {_tabor(b)}",
        {**parameters, "work_of_adhesion_J_per_m2": b.w, "sticking_velocity_m_per_s": V_s},
        with_adhesion=True,
    )


def _johnson(b: Bodies, V: Array) -> Form | str:
    if b.elastic:
        return _ELASTIC
    law = Johnson(b.R, b.E, b.strength)
    e = law.restitution(V, b.m)
    lowest = float(law.velocity_at_restitution(_JOHNSON, b.m))
    highest = float(law.velocity_at_full_radius(b.m))
    return Form(
        within((e < _JOHNSON) & (highest > V), e),
        f"fully plastic, e < {_JOHNSON:g}, above {speed(lowest)}; a << R* (no value above "
        f"{speed(highest)}, where a = R*){'' if lowest < highest else ', so at no velocity here'}; "
        "contact pressure 3 Y",
        takes_strength=True,
    )


def _mdr(b: Bodies, V: Array) -> Form | str:
    if b.elastic:
        return _ELASTIC
    if b.wall is None and not b.equal:
        return "the model needs equal spheres, or a sphere and a wall"
    if b.yielding_wall:
        return "the wall is softer than the sphere, but the model assumes a rigid wall"
    nu = b.sphere_poisson
    if nu < 0:
        return "the model does not hold for a negative Poisson's ratio"
    n = 2 if b.equal else 1
    E = n * b.E * (1 - nu**2)
    sphere = MDR(n * b.R, E, nu, b.strength)
    limit = n * math.sqrt(2 * float(sphere.loading_work(n * b.R)) / (n * b.m))
    flat = (
        "two equal spheres with a rigid flat between them"
        if b.equal
        else "a sphere on a rigid flat, with the wall's compliance included in E"
    )
    return Form(
        sphere.restitution(V / n, n * b.m),
        f"{flat}; up to {speed(limit)}, where the indentation equals the radius",
        {"youngs_modulus_Pa": E, "poissons_ratio": nu},
        takes_strength=True,
    )


FORMS: dict[str, Callable[[Bodies, Array], Form | str]] = {
    "hertz": _hertz,
    "sticking": _sticking,
    "thornton-ning": _thornton_ning,
    "johnson": _johnson,
    "mdr": _mdr,
}


def _elastic_range(b: Bodies) -> str:
    if b.yield_velocity < b.small_velocity:
        return f"up to V_y = {speed(b.yield_velocity)}"
    return f"up to {speed(b.small_velocity)} (indentation {_SMALL:g} R*)"


def _tabor(b: Bodies) -> str:
    mu = float(b.sticking.tabor_parameter(b.separation))
    lower = ", so the true V_s is lower" if mu < 5 else ""
    return f"JKR holds for a Tabor parameter above 5 (here {mu:.2g}{lower})"


def within(inside: NDArray[np.bool_], e: Array) -> Array:
    """`e` where the mask `inside` is true, and NaN elsewhere."""
    return np.where(inside, e, np.nan)


def speed(V: float) -> str:
    """Format a velocity with its unit."""
    return f"{V:.3g} m/s"
