"""Measured coefficients of restitution: a CSV file with a row for each impact velocity."""

from __future__ import annotations

import csv
import math
import stat
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError, shown

Array = NDArray[np.float64]

VELOCITY, RESTITUTION = "velocity_m_per_s", "restitution"
_NEEDED = {VELOCITY: "impact velocities in m/s", RESTITUTION: "e, 0 to 1"}
# Columns with the standard deviation of COR. If the file has both, the first one is used.
DEVIATIONS = ("restitution_std", "restitution_error")
# For each column: the test of a value, and the message if it fails. The range of velocities is that
# of a case file.
_ACCEPTED: dict[str, tuple[Callable[[float], bool], str]] = {
    VELOCITY: (lambda V: 1e-9 <= V <= 1e4, "is not a velocity of 1e-09 to 10000 m/s"),
    RESTITUTION: (lambda e: e >= 0, "is negative"),
    **dict.fromkeys(
        DEVIATIONS, (lambda std: 0 < std < 1, "is not a standard deviation between 0 and 1")
    ),
}
_ABOVE = 3  # standard deviations by which COR may exceed 1: cutting it at 1 would bias the fit
ASSUMED = 0.02
"""Standard deviation of COR that is assumed at first if the table has none."""
_LARGEST = 2**24  # largest size of a file (bytes)


@dataclass(frozen=True)
class Measured:
    """Measured COR at increasing impact velocities (m/s), shape (points,), with its deviation."""

    velocity: Array
    restitution: Array
    deviation: Array | None


def read_measured(path: Path) -> Measured:
    """Read a table of measured COR. Raises a `CaseError` that names file, line and column."""
    rows = rows_of(path, _NEEDED)
    if not rows:
        raise CaseError(f"{path}: has no rows; write a row for each impact velocity")
    deviations = [name for name in DEVIATIONS if name in rows[0][1]]
    columns = [VELOCITY, RESTITUTION, *deviations[:1]]
    points = []
    for line, row in rows:
        values = [_number(path, line, row, column) for column in columns]
        _check_restitution(path, line, row, values)
        points.append(values)
    V, e, *std = np.array(sorted(points)).T
    return Measured(V, e, std[0] if std else None)


def rows_of(path: Path, needed: Mapping[str, str]) -> list[tuple[int, dict[str, str]]]:
    """The rows of a CSV file with the numbers of their lines.

    `needed` has the columns that it must have, and what they mean. Raises `CaseError`.
    """
    try:
        kind = path.stat()
        if stat.S_ISDIR(kind.st_mode):
            raise CaseError(
                f"{path}: is a folder; give a CSV file, such as the table.csv that "
                "`restitution fit-law` writes"
            )
        if not stat.S_ISREG(kind.st_mode) or kind.st_size > _LARGEST:
            raise CaseError(
                f"{path}: is not a regular file, or has more than {_LARGEST} bytes; give a CSV "
                "file with a row for each impact velocity"
            )
        with open(path, newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, strict=True, skipinitialspace=True)
            columns = reader.fieldnames = [name.strip() for name in reader.fieldnames or ()]
            rows = [
                (reader.line_num, row)
                for row in reader
                if any(str(cell or "").strip() for cell in row.values())
            ]
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise CaseError(f"{path}: is not a CSV file in UTF-8 ({error})") from None
    for name, meaning in needed.items():
        if name not in columns:
            has = ", ".join(shown(column) for column in columns[:6]) or "none"
            raise CaseError(
                f"{path}: the column {name} ({meaning}) is missing; write the names of the columns "
                f"into the first line, separated by commas (this file has {has})"
            )
        if columns.count(name) > 1:
            raise CaseError(f"{path}: has more than one column {name}; keep only one")
    return rows


def _number(path: Path, line: int, row: dict[str, str], column: str) -> float:
    try:
        value = float(row[column])
    except (ValueError, TypeError):
        value = math.nan
    if not math.isfinite(value):
        unit = " in m/s, without the unit" if column == VELOCITY else ""
        raise wrong_cell(path, line, column, row, f"is not a number; write a number{unit}")
    accepts, wrong = _ACCEPTED[column]
    if not accepts(value):
        raise wrong_cell(path, line, column, row, wrong)
    return value


def _check_restitution(path: Path, line: int, row: dict[str, str], values: list[float]) -> None:
    _, e, *given = values
    std = given[0] if given else ASSUMED
    if e <= 1 + _ABOVE * std:
        return
    limit = f"is above {1 + _ABOVE * std:.4g}, which is 1 and {_ABOVE} standard deviations of "
    how = (
        f"{std:g}; correct the value or its standard deviation"
        if given
        else f"{std:g}, assumed because the column {DEVIATIONS[0]} is missing; add this column, or "
        "correct the value"
    )
    raise wrong_cell(path, line, RESTITUTION, row, limit + how)


def wrong_cell(path: Path, line: int, column: str, row: dict[str, str], why: str) -> CaseError:
    """An error that names a cell."""
    return CaseError(f"{path}: line {line}: {column} = {shown(row[column] or '')} {why}")
