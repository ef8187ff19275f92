"""Library of materials: elasticity, density, strength and surface energy, with their sources.

The work of adhesion of two materials follows from their surface energies γ₁ and γ₂ by the geometric
mean, w = 2 √(γ₁ γ₂) (L. A. Girifalco, R. J. Good, J. Phys. Chem. 61, 904, 1957,
doi:10.1021/j150553a013). It is 2 γ for equal materials, and too large for a polar material on one
that is not polar.
"""

from __future__ import annotations

import math
import re
import tomllib
from functools import cache
from importlib.resources import files
from typing import Annotated, Any, Generic, Self, TypeVar

from pydantic import BeforeValidator, Field, model_validator

from restitution.arguments import typed
from restitution.case.quantities import Density, Length, Pressure, SurfaceEnergy
from restitution.case.schema import Table
from restitution.display import quantity, summary_html, summary_text
from restitution.errors import CaseError, did_you_mean, shown

Quantity = TypeVar("Quantity", bound=float)
PoissonsRatio = Annotated[float, Field(gt=-1, le=0.5)]
Text = Annotated[str, Field(min_length=1)]
LIBRARY = "library"  # value of work_of_adhesion that asks for the value of the library
_PLAIN = ("", "kg/m³")  # units that take no SI prefix
_FEW = 4  # largest number of materials that a message suggests
_ALIKE = 0.8  # least similarity of a suggested name: 0.77 would suggest halite for calcite


class Property(Table, Generic[Quantity]):
    """One quantity of a material, in SI units.

    `low` and `high` are the extremes in the sources, for any grade. `verified` means that `value`
    was read in the source, or computed from values read there. `conversion` says how `value`
    follows from another quantity.
    """

    value: Quantity
    low: Quantity
    high: Quantity
    source: Text
    verified: bool
    conversion: str = ""

    @model_validator(mode="after")
    def _ordered(self) -> Self:
        if not self.low <= self.value <= self.high:
            raise ValueError("value must lie between low and high")
        return self


class SurfaceProperty(Property[SurfaceEnergy]):
    """A surface energy (J/m²); `conditions` states the surface, the humidity and the method."""

    conditions: Text


class SizeProperty(Property[Length]):
    """h* of the size effect (m); `conditions` states how the metal was treated, and its H₀."""

    conditions: Text


class Material(Table):
    """A material, in SI units; a property that was found in no source is None.

    `yield_strength` is uniaxial. `hardness` is a mean contact pressure: force divided by projected
    area. `density` is the true density. `note` applies to all values of the material.
    """

    key: Text
    name: Text
    aliases: Annotated[tuple[Text, ...], BeforeValidator(tuple)]
    note: Text
    youngs_modulus: Property[Pressure] | None = None
    poissons_ratio: Property[PoissonsRatio] | None = None
    density: Property[Density] | None = None
    yield_strength: Property[Pressure] | None = None
    hardness: Property[Pressure] | None = None
    surface_energy: SurfaceProperty | None = None
    size_effect: SizeProperty | None = None

    def _summary(self) -> list[str]:
        known = {
            "E": (self.youngs_modulus, "Pa"),
            "ν": (self.poissons_ratio, ""),
            "ρ": (self.density, "kg/m³"),
            "Y": (self.yield_strength, "Pa"),
            "H": (self.hardness, "Pa"),
            "γ": (self.surface_energy, "J/m²"),
            "h*": (self.size_effect, "m"),
        }
        values = (f"{symbol} {_shown(p.value, unit)}" for symbol, (p, unit) in known.items() if p)
        return [f"{self.key}: {self.name}", ", ".join(values)]

    __repr__ = __str__ = summary_text
    _repr_html_ = summary_html


@typed
def material(name: str) -> Material:
    """Look up a material of the library.

    Args:
        name: Key or alias, in upper or lower case.

    Returns:
        The material, with values in SI units and their spread and source.

    Raises:
        CaseError: The library has no material of this name.
    """
    known = _by_word()
    if entry := known.get(_plain(name)):
        return entry
    hint = _mentions(_plain(name)) or did_you_mean(_plain(name), known, _ALIKE)
    raise CaseError(
        f"{shown(name)} is not a material of the library; {hint}{' ' if hint else ''}"
        f"known materials: {', '.join(materials())}"
    )


@cache
def _by_word() -> dict[str, Material]:
    return {
        _plain(word): entry
        for entry in materials().values()
        for word in (entry.key, *entry.aliases)
    }


def work_of_adhesion(first: str, second: str) -> Property[float]:
    """Work of adhesion (J/m²) of two materials of the library, from their surface energies.

    Args:
        first: Key or alias of the first material.
        second: Key or alias of the second material.

    Returns:
        The value with its spread and source; `verified` if both surface energies are.

    Raises:
        CaseError: The library lacks a material, or its surface energy.
    """
    pair = material(first), material(second)
    energies = []
    for one in pair:
        if one.surface_energy is None:
            raise CaseError(
                f"the library has no surface energy of {one.key}; give a work of adhesion such as "
                f'"0.05 J/m^2" (surface energies are known of {", ".join(adhesive())})'
            )
        energies.append(one.surface_energy)
    value, low, high = (
        2 * math.sqrt(getattr(energies[0], end) * getattr(energies[1], end))
        for end in ("value", "low", "high")
    )
    distinct = {one.key: energy for one, energy in zip(pair, energies, strict=True)}
    sources = "; ".join(f"{k}: {e.source} ({e.conditions})" for k, e in distinct.items())
    return Property[float](
        value=value,
        low=low,
        high=high,
        source=f"2 sqrt(gamma_1 gamma_2); {sources}",
        verified=all(energy.verified for energy in energies),
    )


def with_library_adhesion(case: Any) -> Any:
    """Replace `work_of_adhesion = "library"` in the tables of a case by the value of its materials.

    Raises:
        ValueError: A body names no material, or the library has no surface energy of it.
    """
    interface = case.get("interface") if isinstance(case, dict) else None
    if not isinstance(interface, dict) or interface.get("work_of_adhesion") != LIBRARY:
        return case
    names = {
        name: table if isinstance(table, str) else _material_of(table)
        for name in ("first", "second")
        if (table := case.get(name)) is not None
    }
    for name, known in names.items():
        if not isinstance(known, str):
            raise ValueError(
                f'interface.work_of_adhesion: "library" needs {name}.material; name a material, or '
                'give a work of adhesion such as "0.05 J/m^2"'
            )
    if "first" not in names:
        return case  # the missing table is reported later
    try:
        w = work_of_adhesion(names["first"], names.get("second", names["first"]))
    except CaseError as error:
        raise ValueError(f"interface.work_of_adhesion: {error}") from None
    return {**case, "interface": {**interface, "work_of_adhesion": f"{w.value!r} J/m^2"}}


def _material_of(table: Any) -> Any:
    return table.get("material") if isinstance(table, dict) else getattr(table, "material", None)


def adhesive() -> list[str]:
    """Keys of the materials whose surface energy is known."""
    return [key for key, one in materials().items() if one.surface_energy is not None]


@typed
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


def _mentions(word: str) -> str:
    pattern = re.compile(rf"(?<![a-z]){re.escape(word)}(?![a-z])")
    in_names, in_notes = (
        [key for key, one in materials().items() if pattern.search(_plain(getattr(one, field)))]
        for field in ("name", "note")
    )
    if 0 < len(in_names) <= _FEW:
        return f"did you mean {' or '.join(map(shown, in_names))}?"
    if 0 < len(in_notes) <= _FEW:
        return f"it is mentioned under {' and '.join(map(shown, in_notes))};"
    return ""


def _shown(value: float, unit: str) -> str:
    return f"{value:.4g} {unit}".strip() if unit in _PLAIN else quantity(value, unit)


def _plain(name: str) -> str:
    """Convert `name` to the form of the keys: lower case, with hyphens."""
    return re.sub(r"[\s_-]+", "-", name.strip().lower())
