"""Read stored results, and refuse damaged ones: a damaged file must not pass for numbers.

Every reader of `curve.csv`, `summary.json`, `results.nc` and `table.csv` is here. Files are
compared with their checksums where there are any, and their content with what a run can write.
"""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

import xarray as xr
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeInt, ValidationError

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.errors import CaseError, OutputError, one_line
from restitution.results.checksums import check_file
from restitution.results.interruption import hold_signals
from restitution.results.schema import COLUMNS, FLAGS, OPTIONAL, RANGES, SPREAD_COLUMNS, STATUS


@dataclass(frozen=True)
class Curve:
    """The rows of a curve: as numbers (NaN where empty, flags 0 or 1), and as the file has them."""

    rows: list[dict[str, float]]
    cells: list[dict[str, str]]


@dataclass(frozen=True)
class StoredRun:
    """One run, ensemble or convergence: its curve, its summary and the text of its case."""

    curve: Curve
    summary: dict[str, Any]
    case: str


@dataclass(frozen=True)
class StoredCase:
    """One case of a study: its folder's name, how it ended, its swept values and its curve."""

    name: str
    status: str
    reason: str
    swept: dict[str, str]
    curve: Curve


class _Model(BaseModel):
    model_config = ConfigDict(extra="allow", strict=True)
    plasticity: str
    adhesion: str
    nodes: Annotated[list[int], Field(min_length=2, max_length=2)]
    spacing: Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]


class _Trust(BaseModel):
    model_config = ConfigDict(extra="allow", strict=True)
    largest_residual: FiniteFloat


class _Summary(BaseModel):
    """What readers take from `summary.json`."""

    model_config = ConfigDict(extra="allow", strict=True)
    title: str
    status: str
    reason: str
    depths_asked: NonNegativeInt
    depths_computed: NonNegativeInt
    warnings: list[str]
    model: _Model
    conventions: dict[str, str]
    derived: dict[str, FiniteFloat | None]
    trust: _Trust
    convolutions: NonNegativeInt
    versions: dict[str, str]


def damaged(path: Path, why: object) -> OutputError:
    """The refusal of a file that is not as it was written."""
    return OutputError(f"{path}: is damaged ({one_line(str(why))}); compute it again")


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn what the system and decoders raise for an unreadable `path` into `OutputError`."""
    try:
        yield
    except FileNotFoundError:
        raise OutputError(f"{path}: does not exist; name the folder of -o of a command") from None
    except OSError as error:
        raise OutputError(f"{path}: cannot be read ({error.strerror or error})") from None
    except (ValueError, csv.Error, RecursionError) as error:
        raise damaged(path, error) from None


def read_text(path: Path) -> str:
    """The text of a file of results. Raises `OutputError`."""
    with reading(path):
        text = path.read_text(encoding="utf-8")
    check_file(path)
    return text


def read_json(path: Path) -> dict[str, Any]:
    """The content of a JSON file that holds a table of names. Raises `OutputError`."""
    with reading(path):
        content = json.loads(read_text(path))
    if not isinstance(content, dict):
        raise damaged(path, "no table of names and values")
    return content


def read_run(folder: Path) -> StoredRun:
    """The results of a run, ensemble or convergence in `folder`. Raises `OutputError`."""
    summary, curve = read_summary(folder), read_curve(folder)
    path = folder / "results.nc"
    with _opened(path) as stored:
        case, rows = stored.attrs.get("case"), stored.sizes.get("indentation_max")
    if not isinstance(case, str):
        raise damaged(path, "the attribute case is missing")
    computed = summary["depths_computed"]
    if not len(curve.rows) == rows == computed:
        raise OutputError(
            f"{folder}: curve.csv has {len(curve.rows)} depths, results.nc {rows}, and the run "
            f"computed {computed}; a file is damaged: run the case again"
        )
    return StoredRun(curve, summary, case)


def stored_case(folder: Path, text: str) -> Case:
    """The case whose text was stored with the results in `folder`. Raises `OutputError`."""
    try:
        return parse_case(text)
    except CaseError as error:
        raise damaged(folder / "results.nc", f"its case: {error}") from None


def read_summary(folder: Path) -> dict[str, Any]:
    """The `summary.json` of a run, with what readers need. Raises `OutputError`."""
    path = folder / "summary.json"
    content = read_json(path)
    try:
        _Summary.model_validate_json(json.dumps(content))
    except ValidationError as error:
        first = error.errors()[0]
        raise damaged(path, f"{'.'.join(map(str, first['loc']))}: {first['msg']}") from None
    return content


def read_curve(folder: Path) -> Curve:
    """The `curve.csv` of a run. Raises `OutputError`."""
    path = folder / "curve.csv"
    cells = _cells(path)
    curve = Curve([_numbers(path, line, row) for line, row in enumerate(cells, 2)], cells)
    check_file(path)
    return curve


def read_results(folder: Path) -> xr.Dataset:
    """The `results.nc` of a run, in memory. Raises `OutputError`."""
    path = folder / "results.nc"
    results = read_netcdf(path)
    for column, (name, _, _) in COLUMNS.items():
        if name not in results or results[name].dims != ("indentation_max",):
            raise damaged(path, f"{name} is missing")
        for value in results[name].values.tolist():
            _check_number(path, name, column, float(value))
    for name in ("case", "derived_reduced_radius_m", "derived_contact_modulus_Pa"):
        if name not in results.attrs:
            raise damaged(path, f"the attribute {name} is missing")
    return results


def read_netcdf(path: Path) -> xr.Dataset:
    """A netCDF file, in memory. Raises `OutputError`."""
    with _opened(path) as stored:
        return stored.load()


def read_study(folder: Path) -> list[StoredCase]:
    """The cases in the `table.csv` of a study. Raises `OutputError`."""
    path = folder / "table.csv"
    found: dict[str, StoredCase] = {}
    for line, cells in enumerate(_cells(path, "case", "status", "reason"), 2):
        swept = dict(list(cells.items())[: list(cells).index("indentation_m")])
        status = cells["status"]
        if status not in STATUS:
            raise damaged(path, f"line {line}: status is {status!r}")
        name = cells["case"]
        case = found.setdefault(
            name, StoredCase(name, status, cells["reason"], swept, Curve([], []))
        )
        if (case.status, case.swept) != (status, swept):
            raise damaged(path, f"line {line}: the rows of {name} differ in status or swept values")
        if status == "complete":
            case.curve.rows.append(_numbers(path, line, cells))
            case.curve.cells.append(cells)
    check_file(path)
    if not found:
        raise damaged(path, "it has no rows")
    return list(found.values())


def _cells(path: Path, *more: str) -> list[dict[str, str]]:
    """The rows of a table with the columns of a curve and `more`."""
    with reading(path), open(path, newline="", encoding="utf-8") as file:
        reader = csv.DictReader(file, strict=True)
        rows = list(reader)
        columns = list(reader.fieldnames or ())
    missing = [name for name in (*COLUMNS, *more) if name not in columns]
    if missing:
        raise damaged(path, f"column {missing[0]} is missing")
    if len(set(columns)) < len(columns):
        raise damaged(path, "two columns have one name")
    for line, row in enumerate(rows, 2):
        if None in row or None in row.values():
            raise damaged(path, f"line {line} has not {len(columns)} cells")
    return rows


def _numbers(path: Path, line: int, cells: Mapping[str, str]) -> dict[str, float]:
    """The values of the columns of a curve in one row."""
    found = {}
    for column in (*COLUMNS, *(name for name in SPREAD_COLUMNS if name in cells)):
        text, where = cells[column], f"line {line}: {column}"
        if column in FLAGS:
            if text not in ("true", "false"):
                raise damaged(path, f"{where} is {text!r}, not true or false")
            found[column] = float(text == "true")
            continue
        try:
            found[column] = float(text) if text else math.nan
        except ValueError:
            raise damaged(path, f"{where} is {text!r}, not a number") from None
        if text and math.isnan(found[column]):
            raise damaged(path, f"{where} is {text!r}, not a number")
        _check_number(path, where, column, found[column])
    return found


def _check_number(path: Path, where: str, column: str, value: float) -> None:
    if math.isnan(value):
        if column not in OPTIONAL:
            raise damaged(path, f"{where} has no value")
        return
    low, high = RANGES.get(column, (-math.inf, math.inf))
    if math.isinf(value) or not low <= value <= high:
        raise damaged(path, f"{where} is {value:g}")


@contextmanager
def _opened(path: Path) -> Iterator[xr.Dataset]:
    """A netCDF file, with signals held back: they would leave the library's locks taken."""
    with reading(path):
        open(path, "rb").close()  # says why, where the library does not
    check_file(path)
    try:
        with hold_signals(), xr.open_dataset(path, engine="netcdf4") as stored:
            yield stored
    except MemoryError:
        raise
    except Exception as error:  # a damaged file may raise anything
        raise damaged(path, f"{type(error).__name__}: {error}") from None
