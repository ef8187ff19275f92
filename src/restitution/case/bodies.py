"""The tables `[first]`, `[second]` and `[interface]`: materials, yielding, adhesion, friction."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator

from restitution.case.materials import PoissonsRatio, Property, material
from restitution.case.models import (
    Adhesion,
    Approach,
    Detachment,
    Plasticity,
    plasticity_of,
    require_cohesive,
)
from restitution.case.quantities import (
    LONGEST,
    Density,
    Length,
    Pressure,
    SurfaceEnergy,
    read_positive,
)
from restitution.case.schema import Table
from restitution.contact.bodies import Body
from restitution.contact.contact import Yields
from restitution.contact.models import EQUILIBRIUM_SEPARATION
from restitution.contact.models import Plasticity as PlasticityModel
from restitution.contact.plasticity.cavity import FULL_CONSTRAINT
from restitution.errors import CaseError, shown

# Keys of a body that the materials library can supply, with their SI units.
FROM_LIBRARY = {
    "youngs_modulus": "Pa",
    "poissons_ratio": "",
    "density": "kg/m^3",
    "yield_strength": "Pa",
    "hardness": "Pa",
}
_REQUIRED = ("youngs_modulus", "poissons_ratio")  # keys that every body needs
_STRENGTHS = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(?:\*\s*)?Y\s*")


class BodyTable(Table):
    """The tables `[first]` and `[second]`.

    Instead of a table, the case file can name a library material, as in `second = "steel"`. The
    body is then a flat wall of this material.
    """

    material: str | None = None
    radius: Annotated[
        Length | None, BeforeValidator(lambda value: None if value == "flat" else value)
    ]
    youngs_modulus: Pressure
    poissons_ratio: PoissonsRatio
    density: Density | None = None
    yield_strength: Pressure | None = None
    hardness: Pressure | None = None

    @model_validator(mode="before")
    @classmethod
    def _with_material(cls, value: Any) -> Any:
        """Fill in omitted keys with values from the materials library."""
        table = {"material": value, "radius": "flat"} if isinstance(value, str) else value
        if not isinstance(table, dict) or not isinstance(table.get("material"), str):
            return table
        known = material(table["material"])
        if lacking := [
            key for key in _REQUIRED if getattr(known, key) is None and table.get(key) is None
        ]:
            raise ValueError(
                f"{lacking[0]}: is missing, because the library found none for {known.key} in a "
                f"source; give {' and '.join(lacking)}"
            )
        taken = {
            key: found.value if not unit else f"{found.value!r} {unit}"
            for key, unit in FROM_LIBRARY.items()
            if (found := getattr(known, key)) is not None
        }
        return {**taken, **table, "material": known.key}

    def body(self) -> Body:
        """Make the body that this table describes."""
        radius = math.inf if self.radius is None else self.radius
        return Body(radius, self.youngs_modulus, self.poissons_ratio, self.density)

    def from_library(self) -> dict[str, Property[Any]]:
        """Return the values taken from the materials library, with their spread and source."""
        if self.material is None:
            return {}
        known = material(self.material)
        return {
            key: found
            for key in FROM_LIBRARY
            if (found := getattr(known, key)) and found.value == getattr(self, key)
        }


YieldRule = tuple[float, Literal["yield_strength", "hardness"]]
MOST_FRICTION = 10.0  # largest coefficient of friction; a larger value must be a mistake
# Ratio of the strengths of two bodies below which both yield, and below which they are equal.
_BOTH_YIELD, _EQUAL = FULL_CONSTRAINT / 1.6, 1.1
# Models of plasticity that limit the contact pressure to a constant.
_CONSTANT_BOUND = ("equilibrium", "truncated")


def _pressure_or_rule(value: Any) -> float | YieldRule:
    """Read the key `yield_pressure`: return a pressure in Pa, or a rule.

    The pressure is infinite for "elastic". A rule is a factor and the quantity that the factor
    multiplies. "2.8 Y" gives (2.8, "yield_strength"), and "hardness" gives (1.0, "hardness").
    """
    if value == "elastic":
        return math.inf
    if value == "hardness":
        return 1.0, "hardness"
    short = isinstance(value, str) and len(value) <= LONGEST
    if not (short and (match := _STRENGTHS.fullmatch(value))):
        return read_positive(value, "Pa")
    if not 0.5 <= (factor := float(match[1])) <= 10:
        raise ValueError(
            f"{shown(value)} is not a plausible contact pressure; the factor of Y must be from 0.5 "
            "to 10 (usually 1.6 to 3)"
        )
    return factor, "yield_strength"


@dataclass(frozen=True)
class Yielding:
    """The yield model of a contact.

    `source` says in words where the values come from. The other fields are the name of the model,
    pressures in Pa, and the body that yields.
    """

    source: str
    plasticity: Plasticity = "equilibrium"
    yield_pressure: float = math.inf
    yield_strength: float = math.inf
    tangent_modulus: float = 0.0
    yields: Yields | None = None

    @property
    def hardness(self) -> float:
        """Pressure of a fully plastic contact (Pa); inf for elastic bodies."""
        return min(self.yield_pressure, FULL_CONSTRAINT * self.yield_strength)

    @property
    def model(self) -> PlasticityModel:
        """The model as a value."""
        return plasticity_of(
            self.plasticity, self.yield_pressure, self.yield_strength, self.tangent_modulus
        )

    def arguments(self) -> dict[str, Any]:
        """The arguments of `Contact` that define its yield model."""
        return {"plasticity": self.model, "yields": self.yields}


class InterfaceTable(Table):
    """The table `[interface]`. By default, the softer body yields and the bodies do not adhere.

    `friction` is the coefficient of friction µ of oblique impacts.
    """

    yield_strength: Pressure | None = None
    tangent_modulus: Pressure | None = None
    yield_pressure: Annotated[float | YieldRule | None, BeforeValidator(_pressure_or_rule)] = None
    plasticity: Plasticity | None = None
    work_of_adhesion: SurfaceEnergy | None = None
    adhesion: Adhesion | None = None
    approach: Approach = "equilibrium"
    detachment: Detachment = "crack-closure"
    equilibrium_separation: Length = EQUILIBRIUM_SEPARATION
    friction: Annotated[float, Field(ge=0, le=MOST_FRICTION)] | None = None

    @model_validator(mode="after")
    def _one_model(self) -> InterfaceTable:
        keys = ("yield_strength", "tangent_modulus")
        growing = [key for key in keys if getattr(self, key) is not None]
        if self.yield_pressure is not None and growing:
            raise ValueError(
                f"yield_pressure, {growing[0]}: give only one of them; yield_pressure sets a "
                "constant limit of the contact pressure, and yield_strength (of a tensile test) "
                "sets a limit that grows with deformation"
            )
        if self.yield_pressure is not None and self.plasticity == "expanding-cavity":
            raise ValueError(
                'yield_pressure: is not used with plasticity = "expanding-cavity"; give '
                "yield_strength (of a tensile test) instead"
            )
        if growing and self.plasticity in _CONSTANT_BOUND:
            raise ValueError(
                f'{growing[0]}: is not used with plasticity = "{self.plasticity}"; give a '
                "yield_pressure (about 2.8 times the yield strength) instead"
            )
        return self

    @model_validator(mode="after")
    def _one_attraction(self) -> InterfaceTable:
        if self.adhesion is not None and self.work_of_adhesion is None:
            raise ValueError(
                f'adhesion: "{self.adhesion}" needs a work_of_adhesion; give it, or remove the key'
            )
        if self.adhesion == "cohesive":
            require_cohesive(self.approach, self.detachment, self.plasticity)
        return self

    @property
    def needs_jkr(self) -> bool:
        """Whether a value of another key, such as `approach`, needs `adhesion = "jkr"`."""
        return (
            self.approach != "equilibrium"
            or self.detachment != "crack-closure"
            or self.plasticity == "truncated"
        )

    @property
    def adhesive_energy(self) -> float:
        """The work of adhesion (J/m²); zero if the key is omitted."""
        return self.work_of_adhesion or 0.0

    def yielding(self, first: BodyTable, second: BodyTable) -> Yielding:
        """Choose the yield model of the contact between two bodies; the softer body yields.

        Keys of the table [interface] have priority over the following defaults. If the yield
        strength of the softer body is known, the pressure at which it yields grows with
        deformation. If only its hardness is known (as for glass), it yields at this hardness.
        Raises `CaseError` if a value that the model needs is unknown.
        """
        model = self._model(first, second)
        elastic = math.isinf(model.hardness)
        return replace(model, yields=None if elastic else yielding_body(first, second))

    def _model(self, first: BodyTable, second: BodyTable) -> Yielding:
        if self.yield_pressure is not None or self.plasticity in _CONSTANT_BOUND:
            return self._at_a_pressure(first, second)
        if self.yield_strength is not None:
            return self._growing(self.yield_strength, "given")
        known = [
            (Y, f"Y of {_named(name, body)}, {1e-6 * Y:.6g} MPa")
            for name, body in (("first", first), ("second", second))
            if (Y := body.yield_strength) is not None
        ]
        pressure = self._at_a_pressure(first, second)
        if known and pressure.yield_pressure >= (1 - 1e-12) * FULL_CONSTRAINT * min(known)[0]:
            return self._growing(*min(known))
        if self.plasticity is None and self.tangent_modulus is None:
            return pressure
        name, body = min(
            (each for each in (("first", first), ("second", second)) if not each[1].yield_strength),
            key=lambda each: each[1].hardness or math.inf,
        )
        raise CaseError(
            f"interface.yield_strength: is missing, and {_named(name, body)} has no "
            "yield_strength; give one of these two strengths, or give yield_pressure instead of "
            "plasticity and tangent_modulus"
        )

    def _growing(self, yield_strength: float, source: str) -> Yielding:
        return Yielding(
            source,
            "expanding-cavity",
            yield_strength=yield_strength,
            tangent_modulus=self.tangent_modulus or 0.0,
        )

    def _at_a_pressure(self, first: BodyTable, second: BodyTable) -> Yielding:
        """Make the model with a constant yield pressure.

        If the key `yield_pressure` is not a pressure, the yield pressure of the softer body is
        used. It is a multiple of the yield strength Y of this body, by default 2.8 Y. A body whose
        Y is unknown yields at its hardness.
        """
        model = self.plasticity or "equilibrium"
        if isinstance(self.yield_pressure, float):
            source = "elastic" if math.isinf(self.yield_pressure) else "given"
            return Yielding(source, model, yield_pressure=self.yield_pressure)
        factor, quantity = self.yield_pressure or (FULL_CONSTRAINT, "yield_strength")
        found = []
        for name, body in (("first", first), ("second", second)):
            of = f"of {_named(name, body)}"
            if quantity == "yield_strength" and body.yield_strength is not None:
                Y = body.yield_strength
                found.append((factor * Y, f"{factor:g} Y {of}, Y = {1e-6 * Y:.6g} MPa"))
            elif body.hardness is not None:
                found.append((body.hardness, f"hardness {of}, {1e-6 * body.hardness:.6g} MPa"))
            elif self.yield_pressure is None:
                raise CaseError(
                    "interface.yield_strength: is missing, and so are "
                    f"{name}.yield_strength and {name}.hardness; give one of them, or write "
                    'yield_pressure = "elastic" for bodies that do not yield'
                )
            else:
                raise CaseError(
                    f"interface.yield_pressure: needs {name}.{quantity}, which is not given"
                    + (f", and the library has none for {body.material}" if body.material else "")
                    + "; give it, or write yield_pressure as a pressure"
                )
        pressure, source = min(found)
        return Yielding(source, model, yield_pressure=pressure)


def yielding_body(first: BodyTable, second: BodyTable) -> Yields | None:
    """Say which body yields: the softer one, or both; None if a strength is unknown.

    The harder body stays elastic if it first yields (at 1.6 Y) above the pressure of full
    plasticity of the softer one. Below that, it counts as yielding if both are nearly equal, or if
    the softer body is the larger one, whose `model_error` is smaller.
    """
    if first == second:
        return "both"
    p, q = _full_pressure(first), _full_pressure(second)
    if p is None or q is None:
        return None
    softer: Yields = "first" if p < q else "second"
    ratio = max(p, q) / min(p, q)
    sizes = [body.radius or math.inf for body in (first, second)]
    larger = sizes[0] >= sizes[1] if softer == "first" else sizes[1] >= sizes[0]
    return "both" if ratio < (_BOTH_YIELD if larger else _EQUAL) else softer


def _full_pressure(body: BodyTable) -> float | None:
    if body.yield_strength is not None:
        return FULL_CONSTRAINT * body.yield_strength
    return body.hardness


def _named(name: str, body: BodyTable) -> str:
    return name + (f" ({body.material})" if body.material else "")
