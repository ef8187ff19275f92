"""Physical quantities in a case file: texts with a number and a unit, converted to SI units."""

from __future__ import annotations

import math
import re
from decimal import Decimal
from functools import lru_cache
from typing import Annotated, Any, NamedTuple

import pint
from pydantic import BeforeValidator

from restitution.errors import shown

# A quantity is one number followed by a unit. The unit is an expression of names, powers, * and /.
# Arithmetic with numbers is excluded, so that a case file cannot start long calculations in the
# unit parser. A digit directly after a name is a power: "g/cm3" is g/cm^3.
_NUMBER = r"[-+]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"[^\W\d]+(?:\s*(?:\^|\*\*)\s*-?\d|\d)?"
_POWER = re.compile(r"(?<=[^\W\d])(\d)")
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*((?:{_UNIT})(?:\s*[*/·]\s*{_UNIT})*)\s*", re.UNICODE)

# Largest number of characters of a quantity. The patterns and the unit parser would need too much
# time for longer texts.
LONGEST = 100


class _Quantity(NamedTuple):
    """A physical quantity of the case file.

    `usual` lists the usual units. If a unit differs from one of them only in capital letters, the
    error message suggests the usual unit. `bounds` is the plausible range in SI units. A value
    outside this range almost certainly has a wrong unit, and could make formulas overflow or
    underflow.
    """

    name: str
    example: str
    usual: str
    bounds: tuple[float, float] = (-math.inf, math.inf)


_QUANTITIES = {  # by SI unit
    "m": _Quantity("a length", "0.25 um", "m cm mm um µm nm pm", (1e-12, 1e3)),
    "Pa": _Quantity("a pressure", "750 MPa", "Pa kPa MPa GPa N/mm^2 N/mm2", (1.0, 1e15)),
    "kg/m^3": _Quantity("a density", "7850 kg/m^3", "kg/m^3 kg/m3 g/cm^3 g/cm3", (1e-2, 1e6)),
    "N": _Quantity("a force", "0.1 N", "N kN mN uN µN nN", (1e-15, 1e12)),
    "J/m^2": _Quantity(
        "a work of adhesion", "0.09 J/m^2", "J/m^2 J/m2 mJ/m^2 mJ/m2 N/m mN/m", (1e-9, 1e4)
    ),
    "rad": _Quantity("an angle", "30 deg", "deg rad"),
    "rad/s": _Quantity("a spin", "100 rad/s", "rad/s deg/s rpm"),
    "m/s": _Quantity("a velocity", "0.5 m/s", "m/s cm/s mm/s um/s km/h", (1e-9, 1e4)),
}
# Names of units of angle; the unit of a spin must contain one of them.
_TURNS = ("radian", "degree", "turn", "revolution")
# Errors that pint raises for a text that is not a unit: AssertionError for "¼", KeyError for "m⁰".
_UNIT_ERRORS = (pint.PintError, ValueError, TypeError, AttributeError, AssertionError, KeyError)


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    return pint.UnitRegistry(cache_folder=None)


def unit_factors() -> dict[str, dict[str, float]]:
    """Return the factors that convert the usual units to each SI unit.

    For example, `unit_factors()["m"]["um"]` is 1e-6.
    """
    return {
        si: {name: read_quantity(f"1 {name}", si) for name in kind.usual.split()}
        for si, kind in _QUANTITIES.items()
    }


def read_quantity(value: object, unit: str) -> float:
    """Convert `value`, such as "500 um", to the SI `unit`. Raises `ValueError`."""
    example = f'write for example "{_QUANTITIES[unit].example}"'
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
        problem = f"is not {_QUANTITIES[unit].name}" if known else "has an unknown unit"
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
    usual = _QUANTITIES[unit].usual.split()
    alike = (each for each in usual if each.lower() == name.lower() and each != name)
    return next((f"did you mean {each}?" for each in alike), None)


def read_positive(value: Any, unit: str, *, or_zero: bool = False) -> float:
    """Convert as `read_quantity` does, and require a plausible positive value.

    `or_zero` also allows zero.
    """
    result = read_quantity(value, unit)
    if or_zero and result == 0:
        return 0.0
    if result < 0 and or_zero:
        raise ValueError(f"{shown(value)} must not be negative")
    if result <= 0:
        raise ValueError(f"{shown(value)} must be greater than zero")
    low, high = _QUANTITIES[unit].bounds
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


def _positive(unit: str, *, or_zero: bool = False) -> BeforeValidator:
    return BeforeValidator(lambda value: read_positive(value, unit, or_zero=or_zero))


Length = Annotated[float, _positive("m")]
Pressure = Annotated[float, _positive("Pa")]
Density = Annotated[float, _positive("kg/m^3")]
SurfaceEnergy = Annotated[float, _positive("J/m^2", or_zero=True)]
Force = Annotated[float, _positive("N")]
Velocity = Annotated[float, _positive("m/s")]
Angle = Annotated[float, BeforeValidator(lambda value: read_quantity(value, "rad"))]
ImpactAngle = Annotated[float, BeforeValidator(read_impact_angle)]
Spin = Annotated[float, BeforeValidator(lambda value: read_quantity(value, "rad/s"))]
Position = Annotated[float, BeforeValidator(lambda value: read_quantity(value, "m"))]
