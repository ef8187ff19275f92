"""Read a study file, which is a case file with a table [sweep], and expand it into cases."""

from __future__ import annotations

import copy
import json
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any, Literal

import tomli_w

from restitution.case.case_file import naming, parse_case, parse_toml, read_text
from restitution.case.quantities import read_quantity
from restitution.errors import CaseError, shown

MOST_CASES = 100_000
# Units of quantities in a case file, and the same units in the notation of netCDF.
_UNITS = {
    "m": "m",
    "Pa": "Pa",
    "kg/m^3": "kg m-3",
    "N": "N",
    "J/m^2": "J m-2",
    "m/s": "m s-1",
    "s": "s",
    "rad": "rad",
    "rad/s": "rad s-1",
}
AS_WRITTEN = "as_written"
"""Name of the attribute with the values as written in the study file (a JSON list of texts)."""


@dataclass(frozen=True)
class SweptCase:
    """One case of a study: its number (from 1), its swept values, and the text of its file."""

    number: int
    values: Mapping[str, Any]
    text: str

    @property
    def name(self) -> str:
        """The name of the folder of this case."""
        return f"case-{self.number:05d}"


@dataclass(frozen=True)
class Study:
    """A checked study file, expanded into valid cases.

    `swept` maps each dotted key ("roughness.rms") to its values as written.
    """

    title: str
    text: str
    swept: Mapping[str, list[Any]]
    mode: Literal["grid", "paired"]
    cases: tuple[SweptCase, ...]

    @property
    def shape(self) -> tuple[int, ...]:
        """The number of values of each swept key; (number of cases,) if the values are paired."""
        if self.mode == "paired":
            return (len(self.cases),)
        return tuple(len(values) for values in self.swept.values())


def read_study(path: Path) -> Study:
    """Read and check a study file. Raises a `CaseError` that names the file and the key."""
    text = read_text(path)
    with naming(path):
        return parse_study(text)


def parse_study(text: str) -> Study:
    """Check the text of a study file and every case made from it. Raises `CaseError`."""
    content = parse_toml(text)
    sweep = content.pop("sweep", None)
    if not isinstance(sweep, dict):
        raise CaseError("the table [sweep] is missing; give the keys that vary, with their values")
    mode = sweep.pop("mode", "grid")
    if mode not in ("grid", "paired"):
        raise CaseError(f'sweep.mode: {shown(mode)} should be "grid" or "paired"')
    swept = dict(_paths(sweep))
    _check_values(swept, mode)
    # In the mode "grid" the last key varies fastest.
    rows = zip(*swept.values(), strict=True) if mode == "paired" else product(*swept.values())
    cases = []
    for number, row in enumerate(rows, 1):
        values = dict(zip(swept, row, strict=True))
        case = copy.deepcopy(content)
        for key, value in values.items():
            put(case, key, value)
        case_text = tomli_w.dumps(case)
        try:
            parse_case(case_text).require_impact()
        except CaseError as error:
            where = ", ".join(f"{key} = {shown(value)}" for key, value in values.items())
            raise CaseError(f"in the case with {where}: {error}") from None
        cases.append(SweptCase(number, values, case_text))
    return Study(str(content.get("title", "")), text, swept, mode, tuple(cases))


def _paths(table: Mapping[str, Any], before: str = "") -> Iterator[tuple[str, list[Any]]]:
    """Dotted keys and values; a key may be written with or without quotes."""
    for key, value in table.items():
        if isinstance(value, dict):
            yield from _paths(value, f"{before}{key}.")
        else:
            yield before + key, value


def _check_values(swept: Mapping[str, Any], mode: str) -> None:
    if not swept:
        raise CaseError(
            'sweep: is empty; give a key that varies: "roughness.rms" = ["0.1 um", "0.2 um"]'
        )
    for key, values in swept.items():
        if not isinstance(values, list) or not values:
            raise CaseError(f"sweep.{key}: {shown(values)} should be a list of values")
    lengths = {key: len(values) for key, values in swept.items()}
    if mode == "paired":
        if len(set(lengths.values())) > 1:
            listed = ", ".join(f"{key} {n}" for key, n in lengths.items())
            raise CaseError(
                f'sweep: mode = "paired" needs lists of equal length; the lengths are {listed}'
            )
    elif (count := math.prod(lengths.values())) > MOST_CASES:
        raise CaseError(f"sweep: gives {count} cases; reduce them to at most {MOST_CASES}")


def put(case: dict[str, Any], path: str, value: Any) -> None:
    """Set the key at the dotted `path` to `value`; a number selects one of several tables, from 1.

    Raises `CaseError` if the path leads through a value, or selects no table.
    """
    table: Any = case
    *way, last = path.split(".")
    for step in way:
        if isinstance(table, list):
            if not (step.isdigit() and 1 <= int(step) <= len(table)):
                raise CaseError(
                    f"sweep.{path}: {shown(step)} is not the number of a table (1 to {len(table)})"
                )
            table = table[int(step) - 1]
        else:
            table = table.setdefault(step, {})
        if not isinstance(table, (dict, list)):
            raise CaseError(f"sweep.{path}: {shown(step)} is a value, not a table")
    if isinstance(table, list):
        raise CaseError(
            f"sweep.{path}: there are {len(table)} tables; select one by its number, as in 1.{last}"
        )
    table[last] = value


def as_text(value: Any) -> str:
    """A swept value as written in the study file: "0.1 um", 3, true, [1, 2]."""
    if isinstance(value, str):
        return value
    return json.dumps(value, ensure_ascii=False, default=str)


def coordinate(values: Sequence[Any]) -> tuple[list[Any], dict[str, str]]:
    """Values and attributes of the coordinate of a swept key in `study.nc`.

    Quantities of one kind become numbers in SI units; all other values but numbers become text.
    """
    texts = [as_text(value) for value in values]
    attributes = {AS_WRITTEN: json.dumps(texts, ensure_ascii=False)}
    if all(isinstance(value, (int, float)) and not isinstance(value, bool) for value in values):
        return list(values), attributes
    for unit, written in _UNITS.items():
        try:
            return [read_quantity(value, unit) for value in values], {
                "units": written,
                **attributes,
            }
        except ValueError:
            continue
    return texts, attributes
