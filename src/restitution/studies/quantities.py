"""Dimensional values in a case file: a string with a number and a unit, read into SI."""

from __future__ import annotations

import math
import re
from functools import lru_cache
from typing import Annotated, Any

import pint
from pydantic import BeforeValidator

# One number, then one unit expression: names, powers, * and /. Nothing that could be arithmetic on
# numbers, so that a case file cannot make the unit parser compute.
_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_UNIT = r"[^\W\d]+(?:\s*(?:\^|\*\*)\s*-?\d)?"
_QUANTITY = re.compile(rf"\s*({_NUMBER})\s*((?:{_UNIT})(?:\s*[*/·]\s*{_UNIT})*)\s*", re.UNICODE)

_EXAMPLES = {
    "m": '"0.25 um"',
    "Pa": '"750 MPa"',
    "kg/m^3": '"7850 kg/m^3"',
    "N": '"0.1 N"',
}
_NAMES = {"m": "a length", "Pa": "a pressure", "kg/m^3": "a density", "N": "a force"}


@lru_cache(maxsize=1)
def _registry() -> pint.UnitRegistry[float]:
    return pint.UnitRegistry(cache_folder=None)


def read_quantity(value: object, unit: str) -> float:
    """Return `value`, such as "500 um", in the SI `unit`; raise `ValueError` in plain words."""
    example = f"write for example {_EXAMPLES[unit]}"
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        raise ValueError(f"{value} has no unit; {example}")
    if not isinstance(value, str):
        raise ValueError(f"{value!r} is not a text with a number and a unit; {example}")
    match = _QUANTITY.fullmatch(value)
    if match is None:
        missing = re.fullmatch(rf"\s*{_NUMBER}\s*", value)
        problem = "has no unit" if missing else "is not one number followed by a unit"
        raise ValueError(f'"{value}" {problem}; {example}')
    number, name = float(match[1]), match[2].replace("·", "*").replace("^", "**")
    try:
        factor = float(_registry().Quantity(1.0, name).m_as(unit))
    except pint.DimensionalityError:
        raise ValueError(f'"{value}" is not {_NAMES[unit]}; {example}') from None
    except (pint.PintError, ValueError, TypeError, AttributeError):
        raise ValueError(f'"{value}" has a unit that is not known; {example}') from None
    result = number * factor
    if not math.isfinite(result):
        raise ValueError(f'"{value}" is not a finite number; {example}')
    return result


def _positive(unit: str) -> BeforeValidator:
    def read(value: Any) -> float:
        result = read_quantity(value, unit)
        if result <= 0:
            raise ValueError(f'"{value}" must be greater than zero')
        return result

    return BeforeValidator(read)


Length = Annotated[float, _positive("m")]
Pressure = Annotated[float, _positive("Pa")]
Density = Annotated[float, _positive("kg/m^3")]
Force = Annotated[float, _positive("N")]
