"""Read the tables of stored results as text and as numbers, and report damaged files."""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

from restitution.curve.columns import Column
from restitution.errors import OutputError, one_line
from restitution.results.schema import ALL_COLUMNS, PERIODIC_FILE


def is_periodic(folder: Path) -> bool:
    return (folder / PERIODIC_FILE).is_file()


def has_maps(folder: Path) -> bool:
    return (folder / "maps.nc").is_file()


def require_restitution(folder: Path) -> None:
    if is_periodic(folder):
        raise OutputError(
            f"{folder}: holds the results of a periodic contact, which has no restitution; "
            "`restitution report` shows them, and `restitution compare-theory` compares the "
            "contact area with theory"
        )


def damaged(path: Path, why: object) -> OutputError:
    return OutputError(f"{path}: is damaged ({one_line(str(why))}); compute it again")


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Convert errors of the system and of decoders to `OutputError` while `path` is read."""
    try:
        yield
    except FileNotFoundError:
        raise OutputError(
            f"{path}: does not exist; give a results folder that a command wrote with -o"
        ) from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (ValueError, csv.Error, RecursionError) as error:
        raise damaged(path, error) from None


def read_cells(path: Path, required: Iterable[str]) -> list[dict[str, str]]:
    """Read the rows of a table that must have the columns `required`. Raises `OutputError`."""
    with reading(path), open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, strict=True)
        rows = list(reader)
        columns = list(reader.fieldnames or ())
    missing = [name for name in required if name not in columns]
    if missing:
        raise damaged(path, f"column {missing[0]} is missing")
    if len(set(columns)) < len(columns):
        raise damaged(path, "two columns have the same name")
    for line, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise damaged(path, f"line {line} does not have {len(columns)} cells")
    return rows


def read_numbers(
    path: Path,
    line: int,
    cells: Mapping[str, str],
    columns: Mapping[str, Column] = ALL_COLUMNS,
) -> dict[str, Any]:
    """Convert the cells of one row to numbers, for all `columns` that are present in the row."""
    numbers = {
        name: _number(path, f"line {line}: {name}", column, cells[name])
        for name, column in columns.items()
        if name in cells
    }
    if numbers.get("loading_work_J", 0.0) > 0:  # an impact, which has a COR
        for name in ("restitution", "restitution_error", "model_error"):
            if math.isnan(numbers.get(name, 0.0)):
                raise damaged(path, f"line {line}: {name} has no value")
    return numbers


def _number(path: Path, where: str, column: Column, text: str) -> float | bool:
    if column.flag:
        if text not in ("true", "false"):
            raise damaged(path, f"{where} is {text!r}, not true or false")
        return text == "true"
    value = math.nan
    with suppress(ValueError):
        value = float(text)
    if text and math.isnan(value):
        raise damaged(path, f"{where} is {text!r}, not a number")
    check_number(path, where, column, value)
    return int(text) if text.isascii() and text.isdigit() else value


def check_number(path: Path, where: str, column: Column, value: float) -> None:
    if math.isnan(value):
        if not column.optional:
            raise damaged(path, f"{where} has no value")
        return
    if math.isinf(value) or not column.low <= value <= column.high:
        raise damaged(path, f"{where} is {value:g}")
