"""Physical quantities in a case file: texts with a number and a unit, converted to SI units."""

from __future__ import annotations

import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from functools import lru_cache, partial
from typing import Annotated, Any, Literal, NamedTuple

import pint
from pydantic import GetCoreSchemaHandler
from pydantic_core import core_schema

from restitution.errors import shown

# A quantity is one number followed by a unit. The unit is an expression of names, powers, * and /.
# Arithmetic with numbers is excluded, so that a case file cannot start long calculations in the
# unit parser. A digit directly after a name is a power: "g/cm3" is g/cm^3.
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"[^\W\d]+(?:\s*(?:\^|\*\*)\s*-?\d|\d)?"
_POWER = re.compile(r"(?<=[^\W\d])(\d)")
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*((?:{_UNIT})(?:\s*[*/·]\s*{_UNIT})*)\s*", re.UNICODE)

_STRENGTHS = re.compile(r"\s*(\d+(?:\.\d*)?|\.\d+)\s*(?:\*\s*)?Y\s*")
# A factor, and the strength of a body that it multiplies.
YieldRule = tuple[float, Literal["yield_strength", "hardness"]]
# Largest number of characters of a quantity. The patterns and the unit parser would need too much
# time for longer texts.
LONGEST = 100


class Quantity(NamedTuple):
    """A physical quantity of the case file."""

    name: str
    example: str
    usual: str  # usual units; suggested for a unit that differs only in capital letters
    # Plausible range (SI). A value outside has a wrong unit, and could make formulas overflow.
    bounds: tuple[float, float] = (-math.inf, math.inf)


QUANTITIES = {  # by SI unit
    "m": Quantity("a length", "0.25 um", "m cm mm um µm nm pm", (1e-12, 1e3)),
    "Pa": Quantity("a pressure", "750 MPa", "Pa kPa MPa GPa N/mm^2 N/mm2", (1.0, 1e15)),
    "kg/m^3": Quantity("a density", "7850 kg/m^3", "kg/m^3 kg/m3 g/cm^3 g/cm3", (1e-2, 1e6)),
    "N": Quantity("a force", "0.1 N", "N kN mN uN µN nN", (1e-15, 1e12)),
    "J/m^2": Quantity(
        "a work of adhesion", "0.09 J/m^2", "J/m^2 J/m2 mJ/m^2 mJ/m2 N/m mN/m", (1e-9, 1e4)
    ),
    "rad": Quantity("an angle", "30 deg", "deg rad"),
    "rad/s": Quantity("a spin", "100 rad/s", "rad/s deg/s rpm"),
    "s": Quantity("a time", "10 us", "s ms us µs ns", (1e-15, 1e6)),
    "m/s": Quantity("a velocity", "0.5 m/s", "m/s cm/s mm/s um/s km/h", (1e-9, 1e4)),
}
# Names of units of angle; the unit of a spin must contain one of them.
_TURNS = ("radian", "degree", "turn", "revolution")
# Errors that pint raises for a text that is not a unit: AssertionError for "¼", KeyError for "m⁰".
_UNIT_ERRORS = (pint.PintError, ValueError, TypeError, AttributeError, AssertionError, KeyError)


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    return pint.UnitRegistry(cache_folder=None)


def unit_factors() -> dict[str, dict[str, float]]:
    """The usual units of each SI unit, in this unit: `unit_factors()["m"]["um"]` is 1e-6."""
    return {
        si: {name: read_quantity(f"1 {name}", si) for name in kind.usual.split()}
        for si, kind in QUANTITIES.items()
    }


def read_quantity(value: object, unit: str) -> float:
    """Convert `value`, such as "500 um", to the SI `unit`. Raises `ValueError`."""
    example = f'write for example "{QUANTITIES[unit].example}"'
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        raise ValueError(f"{shown(value)} has no unit; {example}")
    if not isinstance(value, str):
        raise ValueError(f"{shown(value)} is not a text with a number and a unit; {example}")
    match = _QUANTITY.fullmatch(value) if len(value) <= LONGEST else None
    if match is None:
        missing = len(value) <= LONGEST and re.fullmatch(rf"\s*{_NUMBER}\s*", value)
        problem = "has no unit" if missing else "is not one number followed by a unit"
        raise ValueError(f"{shown(value)} {problem}; {example}")
    name = match[2].replace("·", "*").replace("^", "**")
    try:
        quantity = _registry().Quantity(1.0, _POWER.sub(r"**\1", name))
        factor = float(quantity.m_as(unit))
    except _UNIT_ERRORS as error:
        known = isinstance(error, pint.DimensionalityError)
        problem = f"is not {QUANTITIES[unit].name}" if known else "has an unknown unit"
        remedy = _other_case(match[2], unit) or example
        raise ValueError(f"{shown(value)} {problem}; {remedy}") from None
    if unit == "rad/s" and not any(word in str(quantity.units) for word in _TURNS):
        # In pint, 1 Hz is 1 rad/s, but most users mean one turn per second.
        raise ValueError(f"{shown(value)} is not a spin, because its unit has no angle; {example}")
    result = _product(match[1], factor)
    if not math.isfinite(result):
        raise ValueError(f"{shown(value)} is not a finite number; {example}")
    return result


def _product(number: str, factor: float) -> float:
    """Multiply as decimals, so that "10 um" is 1e-05 m, and not 9.999999999999999e-06 m."""
    decimal = f"{factor:.12g}"  # the factor of g/cm^3 is 999.9999999999999 in pint
    if not math.isclose(float(decimal), factor, rel_tol=1e-15):
        decimal = repr(factor)
    return float(Decimal(number) * Decimal(decimal))


def scaled(value: str, factor: float, digits: int = 17) -> str:
    """Multiply the quantity `value`, such as "500 um", by `factor`; keep its unit."""
    match = _QUANTITY.fullmatch(value)
    assert match is not None  # `read_quantity` accepted this value
    return f"{float(match[1]) * factor:.{digits}g} {match[2]}"


def _other_case(name: str, unit: str) -> str | None:
    """Suggest a usual unit if `name` differs from it only in capital letters ("gpa")."""
    usual = QUANTITIES[unit].usual.split()
    alike = (word for word in usual if word.lower() == name.lower() and word != name)
    return next((f"did you mean {word}?" for word in alike), None)


def read_positive(value: Any, unit: str, *, or_zero: bool = False) -> float:
    """As `read_quantity`, for plausible values above zero or, with `or_zero`, zero."""
    result = read_quantity(value, unit)
    if or_zero and result == 0:
        return 0.0
    if result < 0 and or_zero:
        raise ValueError(f"{shown(value)} must not be negative")
    if result <= 0:
        raise ValueError(f"{shown(value)} must be greater than zero")
    low, high = QUANTITIES[unit].bounds
    if not low <= result <= high:
        match = _QUANTITY.fullmatch(value)
        hint = _other_case(match[2], unit) if match else None
        raise ValueError(
            f"{shown(value)} is outside the plausible range ({low:g} to {high:g} {unit}); "
            f"check the unit{f': {hint}' if hint else ''}"
        )
    return result


def read_impact_angle(value: Any) -> float:
    """Convert an angle of impact, measured from the normal, to rad; require 0 ≤ angle < 90°."""
    result = read_quantity(value, "rad")
    if not 0 <= result < math.pi / 2 * (1 - 1e-12):
        raise ValueError(
            f"{shown(value)} is not an angle of impact; give an angle from the normal of at least "
            "0 and less than 90 degrees"
        )
    return result


def read_yield_pressure(value: Any, unit: str) -> float | YieldRule:
    """A pressure (inf for "elastic") or a rule: "2.8 Y" gives (2.8, "yield_strength")."""
    if value == "elastic":
        return math.inf
    if value == "hardness":
        return 1.0, "hardness"
    short = isinstance(value, str) and len(value) <= LONGEST
    if not (short and (match := _STRENGTHS.fullmatch(value))):
        return read_positive(value, unit)
    if not 0.5 <= (factor := float(match[1])) <= 10:
        raise ValueError(
            f"{shown(value)} is not a plausible contact pressure; the factor of Y must be from 0.5 "
            "to 10 (usually 1.6 to 3)"
        )
    return factor, "yield_strength"


@dataclass(frozen=True)
class Unit:
    """Makes pydantic read texts such as "500 um" into numbers in the unit `si`."""

    si: str
    read: Callable[[Any, str], Any] = read_positive

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> core_schema.CoreSchema:
        return core_schema.no_info_before_validator_function(
            lambda value: self.read(value, self.si), handler(source)
        )


Length = Annotated[float, Unit("m")]
LengthOrZero = Annotated[float, Unit("m", partial(read_positive, or_zero=True))]
Pressure = Annotated[float, Unit("Pa")]
Density = Annotated[float, Unit("kg/m^3")]
SurfaceEnergy = Annotated[float, Unit("J/m^2", partial(read_positive, or_zero=True))]
Force = Annotated[float, Unit("N")]
Velocity = Annotated[float, Unit("m/s")]
Time = Annotated[float, Unit("s")]
Angle = Annotated[float, Unit("rad", read_quantity)]
ImpactAngle = Annotated[float, Unit("rad", lambda value, _: read_impact_angle(value))]
Spin = Annotated[float, Unit("rad/s", read_quantity)]
Position = Annotated[float, Unit("m", read_quantity)]
