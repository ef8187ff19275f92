"""The two particles and the reduced quantities of their contact: R*, E*, m*."""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.arguments import typed
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError


@typed
@dataclass(frozen=True)
class Body:
    """An isotropic elastic sphere, or a wall if the radius is infinite.

    Attributes:
        radius: Radius of the sphere (m); inf for a wall.
        youngs_modulus: Young's modulus (Pa), positive.
        poissons_ratio: Poisson's ratio (dimensionless), above −1 and at most 0.5.
        density: Density (kg/m³), positive. Needed only for velocities, and never for a wall.

    Raises:
        CaseError: A value lies outside its range.
    """

    radius: float
    youngs_modulus: float
    poissons_ratio: float
    density: float | None = None

    def __post_init__(self) -> None:
        if not self.radius > 0:
            raise CaseError(f"radius: {self.radius} m is not positive; use inf for a wall")
        if not (math.isfinite(self.youngs_modulus) and self.youngs_modulus > 0):
            raise CaseError(f"youngs_modulus: {self.youngs_modulus} Pa is not a positive modulus")
        if not -1 < self.poissons_ratio <= 0.5:
            raise CaseError(
                f"poissons_ratio: {self.poissons_ratio} is not possible; give a value above -1 and "
                "at most 0.5"
            )
        if self.density is not None and not (math.isfinite(self.density) and self.density > 0):
            raise CaseError(f"density: {self.density} kg/m³ is not a positive density")

    @property
    def mass(self) -> float | None:
        """Mass of the sphere (kg); inf for a wall, None if the density is not given."""
        if math.isinf(self.radius):
            return math.inf
        if self.density is None:
            return None
        return 4 / 3 * math.pi * self.radius**3 * self.density

    def _summary(self) -> list[str]:
        size = "flat" if math.isinf(self.radius) else f"R {quantity(self.radius, 'm')}"
        density = "" if self.density is None else f", ρ {self.density:.4g} kg/m³"
        E = quantity(self.youngs_modulus, "Pa")
        return [f"{size}, E {E}, ν {self.poissons_ratio:.4g}{density}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


@typed
@dataclass(frozen=True)
class Pair:
    """Two bodies in normal contact.

    Attributes:
        first: One body.
        second: The other body; the same object for two equal spheres.
    """

    first: Body
    second: Body

    @property
    def flat(self) -> bool:
        """Whether both bodies are flat, which a periodic contact requires."""
        return math.isinf(self.first.radius) and math.isinf(self.second.radius)

    @property
    def radius(self) -> float:
        """Reduced radius R* (m) with 1/R* = 1/R₁ + 1/R₂; inf if both bodies are flat."""
        if self.flat:
            return math.inf
        return 1 / (1 / self.first.radius + 1 / self.second.radius)

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E* (Pa) with 1/E* = (1 − ν₁²)/E₁ + (1 − ν₂²)/E₂."""
        return 1 / sum(
            (1 - body.poissons_ratio**2) / body.youngs_modulus for body in (self.first, self.second)
        )

    @property
    def tangential_modulus(self) -> float:
        """Tangential modulus G* (Pa) with 1/G* = (2 − ν₁)/(4 G₁) + (2 − ν₂)/(4 G₂).

        G = E/(2 + 2ν) is the shear modulus of a body.
        """
        return 1 / sum(
            (2 - body.poissons_ratio) * (1 + body.poissons_ratio) / (2 * body.youngs_modulus)
            for body in (self.first, self.second)
        )

    @property
    def shear_compliances(self) -> tuple[float, float]:
        """Compliances α and β of the surfaces under a tangential point force Q (SI, 1/Pa).

        At the distance r, the surfaces move relative to each other by β Q/r on the line of action
        of the force and by α Q/r on the line perpendicular to it: α = Σ (1 − ν)/(2πG) and
        β = Σ 1/(2πG) with the shear moduli G of the bodies.
        """
        # Poisson's ratio and 1/(2πG) of each body, where G is its shear modulus.
        parts = [
            (body.poissons_ratio, (1 + body.poissons_ratio) / (math.pi * body.youngs_modulus))
            for body in (self.first, self.second)
        ]
        return sum((1 - nu) * one for nu, one in parts), sum(one for _, one in parts)

    @property
    def mass(self) -> float | None:
        """Reduced mass m* (kg) with 1/m* = 1/m₁ + 1/m₂.

        The result is inf if both bodies are flat, and None if the density of a sphere is missing.
        """
        if self.flat:
            return math.inf
        if self.first.mass is None or self.second.mass is None:
            return None
        return 1 / (1 / self.first.mass + 1 / self.second.mass)

    def _reduced(self) -> str:
        mass = "" if self.mass is None else f", m* {quantity(self.mass, 'kg')}"
        E = quantity(self.contact_modulus, "Pa")
        if self.flat:
            return f"flat bodies, E* {E}"
        return f"R* {quantity(self.radius, 'm')}, E* {E}{mass}"

    def _summary(self) -> list[str]:
        bodies = {"first": self.first, "second": self.second}
        return [
            self._reduced(),
            *(f"{name}: {body._summary()[0]}" for name, body in bodies.items()),
        ]

    __repr__ = summary_text
    _repr_html_ = summary_html
