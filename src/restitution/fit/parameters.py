"""The free parameters of a fit: keys of a case file whose values are scaled."""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from restitution.case.quantities import scaled
from restitution.errors import CaseError, shown
from restitution.sweeps.sweep import coordinate, put

Array = NDArray[np.float64]

_TABLES = ("first", "second", "interface", "roughness")
# Keys whose values are choices, not physical quantities. They cannot be fitted.
_CHOICES = {"seed", "realisations", "place", "channel", "crop", "outliers"}


@dataclass(frozen=True)
class Parameter:
    """A free key; its first guess as `written` ("0.1 um"), and as `value` in the SI unit `unit`."""

    key: str
    written: str | float
    value: float
    unit: str

    def scaled(self, factor: float, digits: int = 17) -> str | float:
        if isinstance(self.written, str):
            return scaled(self.written, factor, digits)
        return float(f"{self.written * factor:.{digits}g}")

    def text(self, factor: float) -> str:
        return str(self.scaled(factor, 4))


def with_factors(
    content: Mapping[str, Any],
    parameters: Sequence[Parameter],
    factors: Array,
    digits: int = 17,
) -> dict[str, Any]:
    case = copy.deepcopy(dict(content))
    for parameter, factor in zip(parameters, factors.tolist(), strict=True):
        put(case, parameter.key, parameter.scaled(factor, digits))
    return case


def free_parameters(content: Mapping[str, Any], names: Sequence[str]) -> tuple[Parameter, ...]:
    """Find parameters by whole keys ("roughness.rms") or by last parts ("rms") that are unique.

    Raises `CaseError` for any other name, and for a value that is not a positive quantity.
    """
    values = dict(_values(content))
    keys = [_key(name, values) for name in names]
    if not keys:
        raise CaseError("--free: names no key; give one or more, such as yield_strength,rms")
    for key in keys:
        if keys.count(key) > 1:
            raise CaseError(f"--free: {key} is named twice; name it once")
    return tuple(_parameter(key, values[key]) for key in keys)


def _values(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, Any]]:
    """Yield dotted keys, with the number of a [[roughness]] table: "roughness.1.rms"."""
    for name, value in table.items():
        if isinstance(value, dict):
            yield from _values(value, f"{before}{name}.")
        elif isinstance(value, list) and value and all(isinstance(part, dict) for part in value):
            for number, part in enumerate(value, 1):
                yield from _values(part, f"{before}{name}.{number}.")
        else:
            yield before + name, value


def _key(name: str, values: Mapping[str, Any]) -> str:
    keys = [key for key in values if name in (key, key.rpartition(".")[2])]
    if len(keys) > 1:
        raise CaseError(f"--free: {name} may mean {' or '.join(keys)}; name the whole key")
    if keys:
        return keys[0]
    last = name.rpartition(".")[2]
    if last == "rms" and values.get("roughness.kind") == "measured":
        raise CaseError(
            f"--free: {name}: the roughness of this case is a scan, whose heights are known; "
            "remove this key from --free, or use a generated roughness"
        )
    positive = [key for key, value in values.items() if _reason(key, value) is None]
    raise CaseError(
        f"--free: {shown(name)[1:-1]} is not a key of the case; add it to the case with a first "
        f"guess, or free one of {', '.join(positive)}"
    )


def _parameter(key: str, written: Any) -> Parameter:
    if (reason := _reason(key, written)) is not None:
        raise CaseError(f"--free: {key} {reason}")
    (value,), attributes = coordinate([written])
    return Parameter(key, written, float(value), attributes.get("units", "1"))


def _reason(key: str, written: Any) -> str | None:
    """Why `key` cannot be free; None if it can."""
    table, _, last = key.partition(".")
    if table not in _TABLES or _CHOICES & set(last.split(".")):
        return f"cannot be free; only values of {', '.join(f'[{name}]' for name in _TABLES)} can"
    if isinstance(written, list):
        return f"= {shown(written)} is a list; write one value for both axes to free it"
    (value,), _ = coordinate([written])
    if isinstance(value, str) or isinstance(written, bool):
        return f"= {shown(written)} is not a number or quantity; write one as the first guess"
    if not value > 0:
        return f"= {shown(written)} is not positive; write a positive first guess"
    return None
