"""Typed columns of tables of results."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Column:
    """A column: its header in CSV files, its variable in `results.nc`, unit, meaning and limits.

    Cells of a `flag` column are true or false, those of an `optional` column may be empty (NaN).
    """

    header: str
    variable: str
    unit: str
    meaning: str
    low: float = -math.inf
    high: float = math.inf
    optional: bool = False
    flag: bool = False

    def labelled(self, along: str | tuple[str, ...], values: object) -> tuple[object, ...]:
        """A variable of `results.nc` with the dimensions `along`."""
        return along, values, {"units": self.unit, "long_name": self.meaning}


def column(
    header: str, unit: str, meaning: str, variable: str = "", *, default: Any = None, **limits: Any
) -> Any:
    """Make a field of a `Record`; `variable` is the name of the field unless given.

    `limits` are `low`, `high` and `optional` of `Column`. An optional column is NaN by default.
    """
    if default is None and limits.get("optional"):
        default = math.nan
    given = {} if default is None else {"default": default}
    words = {"header": header, "unit": unit, "meaning": meaning, "variable": variable} | limits
    return field(metadata=words, **given)


def magnitude(header: str, unit: str, meaning: str, variable: str = "", **limits: Any) -> Any:
    return column(header, unit, meaning, variable, low=0.0, **limits)


@dataclass(frozen=True, kw_only=True)
class Record:
    """A row of a table of results, whose fields are made by `column`."""

    @classmethod
    def columns(cls) -> dict[str, Column]:
        """The columns by header, in the order of the fields."""
        kind: Any = cls
        return dict(_columns(kind))

    def cells(self) -> dict[str, Any]:
        """The values by header."""
        kind: Any = type(self)
        names = zip(_columns(kind), _names(kind), strict=True)
        return {header: getattr(self, name) for header, name in names}

    @classmethod
    def of_cells(cls, cells: Mapping[str, Any]) -> Self:
        """The inverse of `cells`; headers that are no columns are ignored."""
        kind: Any = cls
        names = zip(_columns(kind), _names(kind), strict=True)
        return cls(**{name: cells[header] for header, name in names if header in cells})


@cache
def _names(kind: Any) -> tuple[str, ...]:
    return tuple(part.name for part in dataclasses.fields(kind))


@cache
def _columns(kind: Any) -> dict[str, Column]:
    columns = {}
    for part in dataclasses.fields(kind):
        words = {**part.metadata}
        words["variable"] = words["variable"] or part.name
        columns[words["header"]] = Column(**words, flag=part.type == "bool")
    return columns


def array(records: Sequence[Record], name: str) -> Array:
    """Values of the field `name` of all `records`, shape (records,)."""
    return np.array([getattr(record, name) for record in records], dtype=float)
