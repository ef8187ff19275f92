"""The form on the page of `restitution app`; each of its fields edits one key of a case file."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, get_args

from restitution.case.bodies import FROM_LIBRARY
from restitution.case.materials import Material, materials
from restitution.case.quantities import unit_factors
from restitution.collision import UnloadingMethod
from restitution.contact.contact import Adhesion, Approach, Plasticity
from restitution.contact.detachment import Detachment
from restitution.dem.export import CODES
from restitution.display import quantity
from restitution.surfaces.extend import Extension
from restitution.surfaces.generate import RoughnessKind

Choice = tuple[str, str]  # the value in the case file, and its label in the form

_GENERATED = get_args(RoughnessKind)


@dataclass(frozen=True)
class Field:
    """A field of the form, which edits the key `key` of the case file.

    `unit` is the SI unit of the quantity. If `low` and `high` are given, they are the ends of a
    slider, in this unit. If `when` is given, the field is shown only while the key `when[0]` has
    one of the values `when[1:]`; the value "" stands for a missing key. If the case lacks `key`
    when the field first appears, `key` is set to `initial`. If `more` is true, the field is placed
    in the section "More" of its group. This section is open if one of its fields has a value.
    """

    key: str
    label: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    logarithmic: bool = True
    whole: bool = False
    choices: tuple[Choice, ...] = ()
    when: tuple[str, ...] = ()
    initial: str | float | None = None
    hint: str = ""
    more: bool = False


@dataclass(frozen=True)
class Group:
    """Fields under one heading."""

    title: str
    fields: tuple[Field, ...]
    closed: bool = False


def form() -> dict[str, Any]:
    """Return as JSON data the groups of fields, the units, the DEM codes and the materials."""
    return {
        "groups": [asdict(group) for group in _groups()],
        "units": unit_factors(),
        "codes": CODES,
        "library": {key: _library_values(each) for key, each in materials().items()},
    }


def _library_values(material: Material) -> dict[str, str]:
    """The values that `material` supplies to a body, written as in a case file."""
    found = ((key, unit, getattr(material, key)) for key, unit in FROM_LIBRARY.items())
    return {
        key: quantity(each.value, unit) if unit == "Pa" else f"{each.value:g} {unit}".strip()
        for key, unit, each in found
        if each is not None
    }


def _named(values: tuple[str, ...], without: str = "") -> tuple[Choice, ...]:
    first = (("", without),) if without else ()
    return (*first, *((value, value) for value in values))


def _groups() -> list[Group]:
    return [
        Group("First particle", _body("first")),
        Group(
            "Second particle",
            (
                Field("second", "Second particle", choices=_SECOND),
                *_body("second", when=("second", "own")),
            ),
        ),
        Group("Interface", _INTERFACE),
        Group("Surface", _SURFACE),
        Group("Grid", _GRID),
        Group("Range", _RANGE),
        Group("Unloading and title", _REST, closed=True),
    ]


_SECOND: tuple[Choice, ...] = (("", "the same as the first"), ("own", "its own values"))


def _body(name: str, when: tuple[str, ...] = ()) -> tuple[Field, ...]:
    library = tuple((key, each.name) for key, each in materials().items())
    flat = 'a length, or "flat" for a wall'
    E, H = (1e6, 1e12), (1e6, 1e11)
    return (
        Field(f"{name}.material", "Material", choices=(("", "own values"), *library), when=when),
        Field(f"{name}.radius", "Radius", "m", 1e-6, 1e-2, when=when, initial="flat", hint=flat),
        Field(f"{name}.youngs_modulus", "Young's modulus E", "Pa", *E, when=when, more=True),
        Field(
            f"{name}.poissons_ratio",
            "Poisson's ratio ν",
            "",
            0.0,
            0.5,
            logarithmic=False,
            when=when,
            more=True,
        ),
        Field(f"{name}.density", "Density", "kg/m^3", 100, 2e4, when=when, more=True),
        Field(f"{name}.yield_strength", "Yield strength Y", "Pa", *H, when=when, more=True),
        Field(f"{name}.hardness", "Hardness H", "Pa", *H, when=when, more=True),
    )


_INTERFACE = (
    Field(
        "interface.yield_strength",
        "Yield strength Y",
        "Pa",
        1e6,
        1e11,
        hint="from a tensile test; if empty, the Y of the softer body",
    ),
    Field(
        "interface.yield_pressure",
        "Constant yield pressure",
        "Pa",
        1e6,
        1e11,
        hint='replaces Y; a pressure, "2.8 Y", "hardness" (of the softer body) or "elastic"',
    ),
    Field(
        "interface.tangent_modulus",
        "Tangent modulus",
        "Pa",
        1e6,
        1e11,
        hint="slope of the stress-strain curve after yield",
        more=True,
    ),
    Field(
        "interface.plasticity",
        "Plasticity",
        choices=_named(get_args(Plasticity), "chosen from the values above"),
        more=True,
    ),
    Field(
        "interface.work_of_adhesion",
        "Work of adhesion w",
        "J/m^2",
        1e-4,
        1.0,
        hint="if empty, no adhesion",
    ),
    Field(
        "interface.friction",
        "Coefficient of friction µ",
        "",
        0.0,
        1.0,
        logarithmic=False,
        hint="for oblique impacts and exports",
        more=True,
    ),
    Field(
        "interface.adhesion",
        "Range of adhesion",
        choices=_named(get_args(Adhesion), "chosen from the grid"),
        more=True,
    ),
    Field(
        "interface.approach",
        "Approach",
        choices=_named(get_args(Approach), "equilibrium"),
        more=True,
    ),
    Field(
        "interface.detachment",
        "Detachment",
        choices=_named(get_args(Detachment), "crack-closure"),
        more=True,
    ),
)

_MADE = ("roughness.kind", *_GENERATED)
_READ = ("roughness.kind", "measured")
_ROUGH = ("roughness.kind", *_GENERATED, "measured")
_SURFACE = (
    Field(
        "roughness.kind",
        "Roughness",
        choices=(("", "smooth"), *_named(_GENERATED), ("measured", "measured: a scan")),
    ),
    Field("roughness.file", "Scan", when=_READ, hint="drop a file onto the page"),
    Field("roughness.rms", "Rq", "m", 1e-9, 1e-5, when=_MADE, initial="0.1 um"),
    Field(
        "roughness.correlation_length",
        "Correlation length",
        "m",
        1e-8,
        1e-4,
        when=("roughness.kind", "exponential", "gaussian"),
        initial="2 um",
    ),
    Field(
        "roughness.hurst",
        "Hurst exponent",
        "",
        0.05,
        0.99,
        logarithmic=False,
        when=("roughness.kind", "self-affine"),
        initial=0.8,
    ),
    Field(
        "roughness.rolloff",
        "Roll-off wavelength",
        "m",
        1e-8,
        1e-4,
        when=("roughness.kind", "self-affine"),
        initial="10 um",
    ),
    Field("roughness.shortest", "Shortest wavelength", "m", 1e-9, 1e-5, when=_MADE, more=True),
    Field("roughness.seed", "Seed", "", 0, 100, False, True, when=_MADE, initial=1),
    Field("roughness.channel", "Channel of the file", whole=True, when=_READ, more=True),
    Field(
        "roughness.size",
        "Edge lengths",
        "m",
        when=_READ,
        hint="if the file lacks them, or is wrong",
        more=True,
    ),
    Field(
        "roughness.height_unit",
        "Unit of the heights",
        choices=_named(("um", "nm", "mm", "m", "pm"), "as in the file, or m"),
        when=_READ,
        more=True,
    ),
    Field(
        "roughness.detrend",
        "Subtract",
        choices=_named(("center", "tilt", "curvature"), "nothing"),
        when=_READ,
        initial="curvature",
    ),
    Field(
        "roughness.undefined",
        "Missing pixels",
        choices=_named(("interpolate",), "refuse"),
        when=_READ,
        more=True,
    ),
    Field(
        "roughness.outliers",
        "Outlier threshold",
        "",
        3,
        30,
        when=_READ,
        hint="in standard deviations",
        more=True,
    ),
    Field(
        "roughness.extend",
        "Extend the scan",
        choices=_named(get_args(Extension), "no"),
        when=_READ,
        more=True,
    ),
    Field(
        "roughness.seed",
        "Seed of the twin",
        "",
        0,
        100,
        False,
        True,
        when=("roughness.extend", "twin"),
        initial=1,
    ),
    Field(
        "roughness.realisations",
        "Surfaces",
        "",
        1,
        16,
        False,
        True,
        when=_ROUGH,
        hint="the curve is the mean over them; while a slider moves, only the first is computed",
    ),
)

_GRID = (
    Field("grid.nodes", "Nodes", "", 64, 1024, True, True, hint="along each edge"),
    Field("grid.spacing", "Spacing", "m", 1e-9, 1e-5),
    Field("grid.refine", "Refine", hint='1, 2, 4, …, or "auto"'),
)


def _span(
    table: str, words: str, unit: str, ends: tuple[float, float], initial: tuple[str, str]
) -> tuple[Field, ...]:
    when = ("depths", table)
    listed = "velocity" if table == "impact" else "values"
    return (
        Field(f"{table}.from", f"{words} from", unit, *ends, when=when, initial=initial[0]),
        Field(f"{table}.to", f"{words} to", unit, *ends, when=when, initial=initial[1]),
        Field(f"{table}.steps", "Steps", "", 2, 48, False, True, when=when, initial=24),
        Field(
            f"{table}.scale",
            "Spacing of the steps",
            choices=_named(("linear",), "logarithmic"),
            when=when,
            more=True,
        ),
        Field(
            f"{table}.{listed}",
            "Values",
            unit,
            when=when,
            hint='separated by commas; used instead of "from", "to" and "Steps"',
            more=True,
        ),
    )


_RANGE = (
    Field(
        "depths",
        "Depths given as",
        choices=(
            ("indentation", "indentations (fastest)"),
            ("impact", "impact velocities"),
            ("load", "loads"),
        ),
    ),
    *_span("indentation", "Indentation", "m", (1e-10, 1e-4), ("20 nm", "2 um")),
    *_span("impact", "Velocity", "m/s", (1e-4, 10.0), ("10 mm/s", "0.3 m/s")),
    Field(
        "impact.angle",
        "Angles of impact",
        "rad",
        when=("depths", "impact"),
        hint="from the normal, separated by commas; adds depths for the normal velocities V cos θ",
        more=True,
    ),
    Field(
        "impact.spin",
        "Spin before impact",
        "rad/s",
        when=("depths", "impact"),
        hint="one value for the first body, or two values for both bodies",
        more=True,
    ),
    *_span("load", "Load", "N", (1e-9, 1e2), ("1 mN", "0.3 N")),
)

_REST = (
    Field("title", "Title"),
    Field("unloading.curves", "Unloading curves", "", 0, 24, False, True),
    Field("unloading.steps", "Steps of each curve", "", 4, 64, False, True),
    Field(
        "unloading.method",
        "Unloading with adhesion",
        choices=_named(get_args(UnloadingMethod), "path"),
    ),
)
