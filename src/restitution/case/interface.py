"""The table `[interface]`: yielding, adhesion, friction."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Annotated, Any

from pydantic import Field, model_validator

from restitution.case.bodies import BodyTable
from restitution.case.models import (
    Adhesion,
    Approach,
    Detachment,
    Plasticity,
    plasticity_of,
)
from restitution.case.quantities import (
    Length,
    LengthOrZero,
    Pressure,
    SurfaceEnergy,
    Unit,
    YieldRule,
    read_yield_pressure,
)
from restitution.case.rulebook import Input, key
from restitution.case.schema import Table
from restitution.contact.contact import Yields
from restitution.contact.models import EQUILIBRIUM_SEPARATION
from restitution.contact.models import Plasticity as PlasticityModel
from restitution.contact.plasticity.cavity import FULL_CONSTRAINT
from restitution.errors import CaseError

MOST_FRICTION = 10.0  # largest coefficient of friction; a larger value must be a mistake
# Ratio of the strengths of two bodies below which both yield, and below which they are equal. The
# harder one stays elastic if it first yields (at 1.6 Y) above full plasticity of the softer one.
_BOTH_YIELD, _EQUAL = FULL_CONSTRAINT / 1.6, 1.1
_SHARED = 0.5  # part of an imprint in each body if both yield
# Models of plasticity that limit the contact pressure to a constant.
_CONSTANT_BOUND = ("equilibrium", "truncated")


@dataclass(frozen=True)
class Yielding:
    """The yield model of a contact.

    `source` says in words where the values come from. The other fields are the name of the model,
    pressures in Pa (of large contacts), the body that yields, and h* of the size effect (m).
    """

    source: str
    plasticity: Plasticity = "equilibrium"
    yield_pressure: float = math.inf
    yield_strength: float = math.inf
    tangent_modulus: float = 0.0
    yields: Yields | None = None
    size_effect: float = 0.0

    @property
    def hardness(self) -> float:
        """Pressure of a fully plastic contact (Pa); inf for elastic bodies."""
        return min(self.yield_pressure, FULL_CONSTRAINT * self.yield_strength)

    @property
    def model(self) -> PlasticityModel:
        """The model as a value."""
        return plasticity_of(
            self.plasticity,
            self.yield_pressure,
            self.yield_strength,
            self.tangent_modulus,
            self.size_effect * (_SHARED if self.yields == "both" else 1.0),
        )

    def arguments(self) -> dict[str, Any]:
        """The arguments of `Contact` that define its yield model."""
        return {"plasticity": self.model, "yields": self.yields}


class InterfaceTable(Table):
    """The table `[interface]`. By default, the softer body yields and the bodies do not adhere."""

    yield_strength: Pressure | None = key(
        None,
        "Y from a tensile test. The limit of the contact pressure starts at 1.6 Y and grows with "
        "deformation. If only the hardness of the softer body is known, it yields at this hardness",
        default="that of the softer body",
        page=Input(
            "Yield strength Y",
            hint="from a tensile test; if empty, the Y of the softer body",
            slider=(1e6, 1e11),
        ),
    )
    tangent_modulus: Pressure | None = key(
        None,
        "E_t, the slope of the tensile curve after yield, of metals that harden; with a strength Y",
        default='`"0 Pa"`',
        page=Input(
            "Tangent modulus",
            hint="slope of the stress-strain curve after yield",
            slider=(1e6, 1e11),
            more=True,
        ),
    )
    yield_pressure: Annotated[float | YieldRule | None, Unit("Pa", read_yield_pressure)] = key(
        None,
        "a constant limit p_y of the contact pressure instead of a yield strength: a pressure, "
        'or for the softer body `"2.8 Y"`, `"1.6 Y"` (its hardness if Y is unknown) or '
        '`"hardness"`; see [which to use](materials.md). `"elastic"` switches yielding off',
        page=Input(
            "Constant yield pressure",
            hint='replaces Y; a pressure, "2.8 Y", "hardness" (of the softer body) or "elastic"',
            slider=(1e6, 1e11),
        ),
    )
    plasticity: Plasticity | None = key(
        None,
        'with a yield pressure, `"truncated"` is the model of Thornton and Ning; see '
        "[method](method.md)",
        default='`"expanding-cavity"` with a yield strength, `"equilibrium"` with a yield pressure',
        page=Input("Plasticity", more=True, empty="chosen from the values above"),
    )
    size_effect: LengthOrZero | None = key(
        None,
        "h\\* of [Nix and Gao](size-effect.md): small contacts are harder, as a Berkovich indent "
        "of the depth h is √(1 + h\\*/h) times as hard as a large one",
        default='`"0 um"`',
        page=Input(
            "Size effect h*",
            hint="depth at which a Berkovich indent is √2 times as hard as the bulk",
            slider=(1e-8, 1e-5),
            more=True,
        ),
    )
    hardness_depth: Length | None = key(
        None,
        "with `size_effect`: the depth of the indents at which the yield strength or pressure was "
        "measured; the strength of large contacts is smaller by √(1 + h\\*/depth)",
        default="infinite: measured on large bodies",
        page=Input(
            "Depth of the hardness",
            hint="with a size effect; if empty, measured on large indents or in tension",
            slider=(1e-8, 1e-3),
            more=True,
        ),
    )
    work_of_adhesion: SurfaceEnergy | None = key(
        None,
        'w; see [adhesion](adhesion.md). `"library"` takes it from the [surface '
        "energies](materials.md#work-of-adhesion) of the two materials. Without this key, a "
        "warning states the velocity below which adhesion matters",
        default='`"0 J/m^2"`',
        page=Input(
            "Work of adhesion w", slider=(1e-4, 1.0), initial="0.05 J/m^2", switch="adhesion"
        ),
    )
    adhesion: Adhesion | None = key(
        None,
        'range of the attraction: `"cohesive"` (Lennard-Jones, with the range z₀ = '
        '`equilibrium_separation`) or `"jkr"` (zero range). The default is `"cohesive"` if cells '
        "are at most 0.3 times the smaller of E\\*z₀²/w and √(R\\*z₀), and otherwise "
        '`"jkr"`; see [adhesion](adhesion.md#the-range-of-the-attraction)',
        default="depends on the grid",
        page=Input("Range of adhesion", more=True, empty="chosen from the grid"),
    )
    approach: Approach = key(
        "equilibrium",
        "how adhesion acts during [loading](adhesion.md#three-ways-to-approach). "
        '`"hertzian"`: adhesion during unloading only; `"pull-increments"`: as in the paper',
        only=("adhesion", "", "jkr"),
        otherwise='approach: "{value}" belongs to adhesion = "jkr"; cohesive bodies always '
        "attract each other on approach, so leave approach out",
        page=Input("Approach", more=True, empty="equilibrium"),
    )
    detachment: Detachment = key(
        "crack-closure",
        "criterion for [releasing a node](adhesion.md#when-a-node-is-released). "
        '`"pohrt-popov"` is the criterion of the paper',
        only=("adhesion", "", "jkr"),
        otherwise='detachment: "{value}" belongs to adhesion = "jkr"; a cohesive contact has '
        "no detachment criterion, so leave detachment out",
        page=Input("Detachment", more=True, empty="crack-closure"),
    )
    equilibrium_separation: Length = key(
        EQUILIBRIUM_SEPARATION,
        'z₀, the range of the attraction with `adhesion = "cohesive"`, and in the Tabor parameter',
    )
    friction: Annotated[float, Field(ge=0, le=MOST_FRICTION)] | None = key(
        None,
        "coefficient of friction µ for [oblique impacts](oblique.md) and for exports to DEM "
        "codes; the normal contact does not depend on it",
        page=Input(
            "Coefficient of friction µ",
            hint="for oblique impacts and exports",
            slider=(0.0, 1.0),
            more=True,
        ),
    )

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
    def _one_size(self) -> InterfaceTable:
        if self.size_effect and self.plasticity == "truncated":
            raise ValueError(
                'size_effect: is not defined with plasticity = "truncated"; remove one of them'
            )
        if self.hardness_depth is not None and self.size_effect is None:
            raise ValueError(
                "hardness_depth: has no effect without size_effect (h* of the material); give it, "
                "or remove hardness_depth"
            )
        return self

    @model_validator(mode="after")
    def _one_attraction(self) -> InterfaceTable:
        if self.adhesion is not None and self.work_of_adhesion is None:
            raise ValueError(
                f'adhesion: "{self.adhesion}" needs a work_of_adhesion; give it, or remove the key'
            )
        if self.adhesion == "cohesive" and self.plasticity == "truncated":
            raise ValueError(
                'plasticity: "truncated" is not defined with adhesion = "cohesive"; use '
                '"equilibrium", or adhesion = "jkr"'
            )
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
        """The yield model of two bodies, of which the softer one yields.

        By default, its yield strength is used or, if this is unknown (glass), its hardness.
        """
        model = self._model(first, second)
        elastic = math.isinf(model.hardness)
        model = replace(model, yields=None if elastic else yielding_body(first, second))
        if not self.size_effect:
            return model
        if elastic:
            raise CaseError(
                "interface.size_effect: elastic bodies have no hardness; give a yield_pressure or "
                "yield_strength, or remove size_effect"
            )
        harder = math.sqrt(1 + self.size_effect / (self.hardness_depth or math.inf))
        return replace(
            model,
            yield_pressure=model.yield_pressure / harder,
            yield_strength=model.yield_strength / harder,
            size_effect=self.size_effect,
        )

    def _model(self, first: BodyTable, second: BodyTable) -> Yielding:
        if self.yield_pressure is not None or self.plasticity in _CONSTANT_BOUND:
            return self._at_a_pressure(first, second)
        if self.yield_strength is not None:
            return self._growing(self.yield_strength, "given")
        known = [
            (Y, f"Y of {_named(name, body)}, {body.strength_in_words}")
            for name, body in (("first", first), ("second", second))
            if (Y := body.yield_strength) is not None
        ]
        pressure = self._at_a_pressure(first, second)
        if known and pressure.yield_pressure >= (1 - 1e-12) * FULL_CONSTRAINT * min(known)[0]:
            return self._growing(*min(known))
        if self.plasticity is None and self.tangent_modulus is None:
            return pressure
        bodies = (("first", first), ("second", second))
        name, body = min(
            ((name, body) for name, body in bodies if not body.yield_strength),
            key=lambda named: named[1].hardness or math.inf,
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
        """The model with a constant yield pressure; by default 2.8 Y, or a hardness."""
        model = self.plasticity or "equilibrium"
        if isinstance(self.yield_pressure, float):
            source = "elastic" if math.isinf(self.yield_pressure) else "given"
            return Yielding(source, model, yield_pressure=self.yield_pressure)
        factor, quantity = self.yield_pressure or (FULL_CONSTRAINT, "yield_strength")
        pressures = []
        for name, body in (("first", first), ("second", second)):
            whose = f"of {_named(name, body)}"
            if quantity == "yield_strength" and body.yield_strength is not None:
                Y = body.yield_strength
                pressures.append(
                    (factor * Y, f"{factor:g} Y {whose}, Y = {body.strength_in_words}")
                )
            elif body.hardness is not None:
                pressures.append(
                    (body.hardness, f"hardness {whose}, {1e-6 * body.hardness:.6g} MPa")
                )
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
        pressure, source = min(pressures)
        return Yielding(source, model, yield_pressure=pressure)


def yielding_body(first: BodyTable, second: BodyTable) -> Yields | None:
    """The softer body, or both; None if unknown. A larger body has a smaller `model_error`."""
    if dict(first) == dict(second):
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
