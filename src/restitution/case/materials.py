"""Library of materials: elasticity, density, yield strength and hardness, with their sources."""

from __future__ import annotations

import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Generic, Self, TypeVar

from pydantic import BeforeValidator, Field, model_validator

from restitution.case.quantities import Density, Pressure
from restitution.case.schema import Table
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError, did_you_mean, shown

Quantity = TypeVar("Quantity", bound=float)
PoissonsRatio = Annotated[float, Field(gt=-1, le=0.5)]
Text = Annotated[str, Field(min_length=1)]


class Property(Table, Generic[Quantity]):
    """One quantity of a material, in SI units.

    `low` and `high` are the lowest and the highest value found in the sources, for any grade of the
    material. `verified` means that `value` was read in the source or in a copy of it, or computed
    from values read there.
    """

    value: Quantity
    low: Quantity
    high: Quantity
    source: Text
    verified: bool

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.low <= self.value <= self.high:
            raise ValueError("value must lie between low and high")
        return self


class Material(Table):
    """A material: elasticity, true density and, if known, yield strength and hardness, in SI units.

    `yield_strength` is uniaxial. `hardness` is a mean contact pressure: force divided by projected
    area. `note` applies to all values of the material.
    """

    key: Text
    name: Text
    aliases: Annotated[tuple[Text, ...], BeforeValidator(tuple)]
    note: Text
    youngs_modulus: Property[Pressure]
    poissons_ratio: Property[PoissonsRatio]
    density: Property[Density]
    yield_strength: Property[Pressure] | None = None
    hardness: Property[Pressure] | None = None

    def _summary(self) -> list[str]:
        strengths = {"Y": self.yield_strength, "H": self.hardness}
        known = "".join(f", {k} {quantity(p.value, 'Pa')}" for k, p in strengths.items() if p)
        E, nu = quantity(self.youngs_modulus.value, "Pa"), self.poissons_ratio.value
        return [
            f"{self.key}: {self.name}",
            f"E {E}, ν {nu:.4g}, ρ {self.density.value:.4g} kg/m³{known}",
        ]

    __repr__ = __str__ = summary_text
    _repr_html_ = summary_html


def material(name: str) -> Material:
    """Look up a material of the library.

    Args:
        name: Key or alias, in upper or lower case.

    Returns:
        The material, with values in SI units and their spread and source.

    Raises:
        CaseError: The library has no material of this name.
    """
    known = {
        _plain(each): found
        for found in materials().values()
        for each in (found.key, *found.aliases)
    }
    if found := known.get(_plain(name)):
        return found
    hint = did_you_mean(_plain(name), known)
    raise CaseError(
        f"{shown(name)} is not a material of the library; {hint}{' ' if hint else ''}"
        f"known materials: {', '.join(materials())}"
    )


@cache
def materials() -> dict[str, Material]:
    """List the materials of the library.

    Returns:
        Materials by key, for example `materials()["steel"].youngs_modulus.value` (Pa).
    """
    text = (files("restitution.case") / "materials.toml").read_text("utf-8")
    return {
        key: Material.model_validate({"key": key, **content})
        for key, content in tomllib.loads(text).items()
    }


def _plain(name: str) -> str:
    """Convert `name` to the form of the keys: lower case, with hyphens."""
    return re.sub(r"[\s_-]+", "-", name.strip().lower())
