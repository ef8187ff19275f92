"""One body of a restitution law, and when two bodies are one type."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Annotated

from pydantic import ConfigDict, Field
from pydantic.dataclasses import dataclass as checked_dataclass

from restitution.display import quantity
from restitution.errors import one_line

STRICT = ConfigDict(extra="forbid", allow_inf_nan=False)
_DIGITS = 1e-9  # largest relative difference of equal values of two bodies
_UNNAMED = ("first", "second")  # names of bodies whose case names no material

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1)]


@checked_dataclass(frozen=True, kw_only=True, config=STRICT)
class Particle:
    """One body of the pair, in SI units. `radius` is None for a flat wall.

    `name` is the material, or "first" or "second" if the case names none. `number_fraction` is the
    share of this size in the particles of its material.
    """

    name: str
    radius: Positive | None
    youngs_modulus: Positive
    poissons_ratio: Annotated[float, Field(gt=-1, le=0.5)]
    density: Positive | None
    number_fraction: Share | None = None
    yield_strength: Positive | None = None
    hardness: Positive | None = None

    @property
    def material(self) -> str | None:
        """The name of the material; None if the case names none."""
        return None if self.name in _UNNAMED else self.name

    @property
    def distinguishing(self) -> tuple[str | float | None, ...]:
        """Values that tell two bodies apart only if both bodies have them."""
        density = None if self.wall else self.density  # the density of a wall has no effect
        return self.material, density, self.yield_strength, self.hardness

    def may_equal(self, other: Particle) -> bool:
        """Whether no value of both bodies differs, except the number fraction."""
        ours = self.radius, self.youngs_modulus, self.poissons_ratio
        theirs = other.radius, other.youngs_modulus, other.poissons_ratio
        known = zip(self.distinguishing, other.distinguishing, strict=True)
        return all(map(_same, ours, theirs)) and all(
            _same(one, two) for one, two in known if one is not None and two is not None
        )

    def merged(self, other: Particle) -> Particle:
        """This body with the values of `other` where its own are unknown."""
        values = {
            key: value
            for key, value in vars(other).items()
            if value is not None and getattr(self, key) is None
        }
        return replace(self, **values)

    def described(self) -> str:
        """Name, size, and the values that tell bodies with equal elastic constants apart."""
        known = [
            f"{name} {quantity(value, 'Pa')}"
            for name, value in (("Y", self.yield_strength), ("H", self.hardness))
            if value is not None
        ]
        return ", ".join([str(self), *known])

    @property
    def wall(self) -> bool:
        """Whether the body is a flat wall."""
        return self.radius is None

    def __str__(self) -> str:
        """Name and size, for messages and comments."""
        # "um", because exports contain this text, and some DEM codes warn of non-ASCII comments.
        radius = quantity(self.radius, "m").replace("µ", "u")
        size = "flat" if self.radius is None else f"R = {radius}"
        return f"{one_line(self.name)} ({size})"


def _same(one: str | float | None, other: str | float | None) -> bool:
    if isinstance(one, float) and isinstance(other, float):
        return math.isclose(one, other, rel_tol=_DIGITS)
    return one == other
