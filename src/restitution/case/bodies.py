"""The tables `[first]` and `[second]`: radius and material of a body."""

from __future__ import annotations

import math
from typing import Annotated, Any, Self

from pydantic import (
    BeforeValidator,
    Field,
    ModelWrapValidatorHandler,
    PrivateAttr,
    model_validator,
)

from restitution.case.hardness import converted, ratio_of, strength
from restitution.case.materials import Material, PoissonsRatio, Property, material, materials
from restitution.case.quantities import (
    Density,
    Length,
    Pressure,
    Time,
)
from restitution.case.rulebook import Input, key, rules
from restitution.case.schema import Table
from restitution.contact.bodies import Body, Pair
from restitution.losses.half_space import HalfSpace
from restitution.losses.losses import Losses
from restitution.losses.plate import Plate
from restitution.losses.viscosity import Friction, Viscosity

_REQUIRED = ("youngs_modulus", "poissons_ratio")  # keys that every body needs


class BodyTable(Table):
    """The tables `[first]` and `[second]`; a name such as "steel" stands for a wall of steel."""

    material: str | None = key(
        None,
        "a name in the [library](materials.md), which provides the following keys if left out",
        page=Input(
            "Material",
            empty="own values",
            choices=lambda: {key: one.name for key, one in materials().items()},
        ),
    )
    radius: Annotated[
        Length | None, BeforeValidator(lambda value: None if value == "flat" else value)
    ] = key(
        ...,
        'radius of the particle itself (not the reduced radius R*), or `"flat"` for a wall; '
        "one body must be a sphere, unless the grid is periodic",
        page=Input(
            "Radius", hint='a length, or "flat" for a wall', slider=(1e-6, 1e-2), initial="flat"
        ),
    )
    youngs_modulus: Pressure = key(
        ..., "Young's modulus E", page=Input("Young's modulus E", slider=(1e6, 1e12), more=True)
    )
    poissons_ratio: PoissonsRatio = key(
        ..., "Poisson's ratio ν", page=Input("Poisson's ratio ν", slider=(0.0, 0.5), more=True)
    )
    density: Density | None = key(
        None,
        "needed to compute impact velocities; a wall does not need it",
        page=Input("Density", slider=(100, 2e4), more=True),
    )
    yield_strength: Pressure | None = key(
        None,
        'yield strength Y from a tensile test, or `"H/2.8"` from the [hardness](materials.md) of a '
        "metal. The keys of `[interface]` below say how it is used",
        page=Input(
            "Yield strength Y",
            hint='of a tensile test, or "H/2.8" of the hardness',
            slider=(1e6, 1e11),
            more=True,
        ),
    )
    hardness: Pressure | None = key(
        None,
        "indentation hardness, used where the yield strength is unknown",
        page=Input("Hardness H", slider=(1e6, 1e11), more=True),
    )
    thickness: Length | None = key(
        None,
        "of a wall, for the [bending waves](losses.md) that the impact sends into it; the wall "
        "needs a density",
        default="infinite",
        page=Input("Thickness", hint="of a wall; if empty, thick", slider=(1e-4, 1.0), more=True),
    )
    loss_tangent: Annotated[float, Field(ge=0, le=1)] | None = key(
        None,
        "tan δ, [internal friction](losses.md) at the frequency 1/(2T) of an impact of duration T",
        default="0",
        page=Input("Loss tangent tan δ", slider=(0.0, 1.0), more=True),
    )
    relaxation_time: Time | None = key(
        None,
        "viscosity over modulus, instead of `loss_tangent`",
        default='`"0 s"`',
        page=Input("Relaxation time", slider=(1e-9, 1.0), more=True),
    )

    _ratio: float | None = PrivateAttr(default=None)
    _given: frozenset[str] = PrivateAttr(default=frozenset())

    @model_validator(mode="wrap")
    @classmethod
    def _with_given(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Remember the keys that are given: their values have no spread, even if the library's."""
        table = cls._with_strength(value, handler)
        if isinstance(value, dict):
            table._given = frozenset(key for key, of in value.items() if of is not None)
        return table

    @classmethod
    def _with_strength(cls, value: Any, handler: ModelWrapValidatorHandler[Self]) -> Self:
        """Read `yield_strength = "H/2.8"`, and remember the ratio."""
        if not isinstance(value, dict) or (ratio := ratio_of(value.get("yield_strength"))) is None:
            return handler(value)
        hardness, name = value.get("hardness"), value.get("material")
        if hardness is None and isinstance(name, str) and (known := material(name).hardness):
            hardness = f"{known.value!r} Pa"
        table = handler({**value, "yield_strength": converted(hardness, ratio)})
        table._ratio = ratio
        return table

    @model_validator(mode="before")
    @classmethod
    def _with_material(cls, value: Any) -> Any:
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
            key: supplied.value if not unit else f"{supplied.value!r} {unit}"
            for key, unit in FROM_LIBRARY.items()
            if (supplied := getattr(known, key)) is not None
        }
        return {**taken, **table, "material": known.key}

    @model_validator(mode="after")
    def _with_losses(self) -> Self:
        if self.thickness is not None and self.radius is not None:
            raise ValueError(
                "thickness: belongs to a wall, but this body is a sphere; remove thickness, or "
                'write radius = "flat"'
            )
        if self.loss_tangent is not None and self.relaxation_time is not None:
            raise ValueError(
                "loss_tangent, relaxation_time: both describe the internal friction; remove one"
            )
        if self.thickness is not None and self.density is None:
            raise ValueError("density: is missing; give it, because thickness needs the mass")
        return self

    @property
    def friction(self) -> Friction:
        """Internal friction of the body."""
        return Friction(self.relaxation_time or 0.0, self.loss_tangent or 0.0)

    def body(self) -> Body:
        """Make the body that this table describes."""
        radius = math.inf if self.radius is None else self.radius
        return Body(radius, self.youngs_modulus, self.poissons_ratio, self.density)

    def from_library(self) -> dict[str, Property[Any]]:
        """Return the values taken from the library or converted, with their spread and source."""
        values: dict[str, Property[Any]] = {}
        if self.material is not None:
            known = material(self.material)
            values = {
                key: supplied
                for key in FROM_LIBRARY
                if key not in self._given
                and (supplied := getattr(known, key))
                and supplied.value == getattr(self, key)
            }
        if self._ratio is not None and self.hardness is not None:
            known_hardness = values.get("hardness")
            spread = (known_hardness.low, known_hardness.high) if known_hardness else None
            own = strength(self.hardness, self._ratio, spread)
            values |= {"yield_strength": own} if own.value == self.yield_strength else {}
        return values

    @property
    def strength_in_words(self) -> str:
        """The yield strength, and how it follows from the hardness."""
        words = f"{1e-6 * (self.yield_strength or math.nan):.6g} MPa"
        known = self.from_library().get("yield_strength")
        return f"{words} ({known.conversion})" if known and known.conversion else words


# Keys of a body that the materials library can supply, with their SI units.
FROM_LIBRARY = {
    rule.name: rule.unit.si if rule.unit else ""
    for rule in rules(BodyTable)
    if rule.name in Material.model_fields
}


def losses_of(pair: Pair, *tables: BodyTable) -> Losses:
    """Losses of `pair`, whose bodies are `tables`: none of two flat ones, which have no impact.

    A wall without density has no waves.
    """
    if pair.flat:
        return Losses()
    wall = next((table for table in tables if table.radius is None), None)
    plate = waves = None
    if wall is not None and wall.density is not None:
        material = wall.youngs_modulus, wall.poissons_ratio, wall.density
        waves = HalfSpace(*material)
        plate = None if wall.thickness is None else Plate(wall.thickness, *material)
    bodies = tuple(
        (
            table.friction,
            pair.contact_modulus * (1 - table.poissons_ratio**2) / table.youngs_modulus,
        )
        for table in tables
    )
    viscous = any(friction != Friction() for friction, _ in bodies)
    return Losses(plate, waves, Viscosity(bodies) if viscous else None)
