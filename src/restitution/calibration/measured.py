"""Measured coefficients of restitution: a CSV file with a row for each impact velocity."""

from __future__ import annotations

import csv
import math
import stat
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.errors import CaseError, shown

Array = NDArray[np.float64]

VELOCITY, RESTITUTION = "velocity_m_per_s", "restitution"
# Columns with the standard deviation of COR. If the file has both, the first one is used.
DEVIATIONS = ("restitution_std", "restitution_error")
_BOUNDS = 1e-9, 1e4  # range of velocities (m/s), as in a case file
_LARGEST = 2**24  # largest size of a file (bytes)


@dataclass(frozen=True)
class Measured:
    """Measured COR at impact velocities (m/s, increasing), shape (points,).

    `deviation` contains the standard deviations of `restitution`, or None if the file has no such
    column.
    """

    velocity: Array
    restitution: Array
    deviation: Array | None


def read_measured(path: Path) -> Measured:
    """Read a table of measured COR. Raises a `CaseError` that names file, line and column.

    Columns that `Measured` does not need are ignored.
    """
    rows = _rows(path)
    columns = list(rows[0][1]) if rows else []
    deviation = next((name for name in DEVIATIONS if name in columns), None)
    found = []
    for line, row in rows:
        V = _number(path, line, row, VELOCITY)
        if not _BOUNDS[0] <= V <= _BOUNDS[1]:
            raise _wrong(
                path, line, VELOCITY, row, f"is not a velocity of {_BOUNDS[0]:g} to 10000 m/s"
            )
        e = _number(path, line, row, RESTITUTION)
        if not 0 <= e <= 1:
            raise _wrong(path, line, RESTITUTION, row, "is outside 0 to 1")
        std = math.nan
        if deviation is not None:
            std = _number(path, line, row, deviation)
            if not 0 < std < 1:
                raise _wrong(
                    path, line, deviation, row, "is not a standard deviation between 0 and 1"
                )
        found.append((V, e, std))
    if not found:
        raise CaseError(f"{path}: has no rows; write a row for each impact velocity")
    V, e, std = np.array(sorted(found)).T
    return Measured(V, e, None if deviation is None else std)


def _rows(path: Path) -> list[tuple[int, dict[str, str]]]:
    """Read the rows of the file with their line numbers. Check that no needed column is missing."""
    try:
        kind = path.stat()
        if stat.S_ISDIR(kind.st_mode):
            raise CaseError(f"{path}: is a folder; give a CSV file, such as table.csv of a law")
        if not stat.S_ISREG(kind.st_mode) or kind.st_size > _LARGEST:
            raise CaseError(
                f"{path}: is not a regular file, or has more than {_LARGEST} bytes; give a CSV "
                "file with a row for each impact velocity"
            )
        with open(path, newline="", encoding="utf-8-sig") as file:
            reader = csv.DictReader(file, strict=True, skipinitialspace=True)
            reader.fieldnames = [name.strip() for name in reader.fieldnames or ()]
            columns = list(reader.fieldnames)
            rows = [(reader.line_num, row) for row in reader if any(map(_filled, row.values()))]
    except OSError as error:
        raise CaseError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (UnicodeDecodeError, csv.Error) as error:
        raise CaseError(f"{path}: is not a CSV file in UTF-8 ({error})") from None
    for name, meaning in ((VELOCITY, "impact velocities in m/s"), (RESTITUTION, "e, 0 to 1")):
        if name not in columns:
            has = ", ".join(shown(column) for column in columns[:6]) or "none"
            raise CaseError(
                f"{path}: the column {name} ({meaning}) is missing; the first line names the "
                f"columns, separated by commas, and this file has {has}"
            )
        if columns.count(name) > 1:
            raise CaseError(f"{path}: has two columns {name}; remove one of them")
    return rows


def _filled(cell: object) -> bool:
    return bool(cell.strip()) if isinstance(cell, str) else bool(cell)


def _number(path: Path, line: int, row: dict[str, str], column: str) -> float:
    try:
        value = float(row[column])
    except (ValueError, TypeError):
        value = math.nan
    if not math.isfinite(value):
        unit = " in m/s, without the unit" if column == VELOCITY else ""
        raise _wrong(path, line, column, row, f"is not a number; write a number{unit}")
    return value


def _wrong(path: Path, line: int, column: str, row: dict[str, str], why: str) -> CaseError:
    return CaseError(f"{path}: line {line}: {column} = {shown(row[column] or '')} {why}")
