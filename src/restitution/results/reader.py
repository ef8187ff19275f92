"""Read stored tables and files, compare them with their checksums, and reject damaged ones."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeInt, ValidationError

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.display import counted, quantity, summary_html, summary_text
from restitution.errors import CaseError, OutputError, first_problem
from restitution.results.checksums import check_file
from restitution.results.coordinates import with_coordinates
from restitution.results.older import REQUIRED, as_now, dataset_as_now
from restitution.results.schema import (
    ALL_COLUMNS,
    COLUMNS,
    OBLIQUE_COLUMNS,
    OBLIQUE_FILE,
    OBLIQUE_SPREAD_COLUMNS,
    STATUS,
    Column,
)
from restitution.results.stored_files import opened, read_json, read_maps, read_netcdf, read_text
from restitution.results.tables import (
    check_number,
    damaged,
    read_cells,
    read_numbers,
    require_restitution,
)

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Curve:
    """The rows of a curve as numbers (NaN for empty cells, 0 or 1 for flags) and as text."""

    rows: list[dict[str, float]]
    cells: list[dict[str, str]]

    def _summary(self) -> list[str]:
        columns = f": {', '.join(list(self.rows[0])[:3])}, …" if self.rows else ""
        return [f"{counted(len(self.rows), 'row')}{columns}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


class _Stored(BaseModel):
    model_config = ConfigDict(extra="allow", strict=True)


class _Model(_Stored):
    plasticity: str
    adhesion: str
    nodes: Annotated[list[int], Field(min_length=2, max_length=2)]
    spacing: Annotated[list[FiniteFloat], Field(min_length=2, max_length=2)]


class _Diagnostics(_Stored):
    largest_residual: FiniteFloat


class _Summary(_Stored):
    """The keys of `summary.json` that this program reads."""

    title: str
    status: str
    reason: str
    depths_asked: NonNegativeInt
    depths_computed: NonNegativeInt
    warnings: list[str]
    model: _Model
    conventions: dict[str, str]
    derived: dict[str, FiniteFloat | None]
    diagnostics: _Diagnostics
    convolutions: NonNegativeInt
    versions: dict[str, str]


@dataclass(frozen=True)
class UnloadingCurve:
    """An unloading curve that begins at the depth `start` (m).

    `indentation` (m) and `force` (N) are its points, sorted by increasing indentation.
    """

    start: float
    indentation: Array
    force: Array

    def _summary(self) -> list[str]:
        return [f"{counted(self.force.size, 'point')} from {quantity(self.start, 'm')}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


@dataclass(frozen=True)
class RunResults:
    """The results of one run or convergence study in `folder`.

    Each file is read on first use; a missing or damaged file raises `OutputError`.
    """

    folder: Path

    @cached_property
    def curve(self) -> Curve:
        """The rows of `curve.csv`."""
        return _read_table(self.folder / "curve.csv", REQUIRED, ALL_COLUMNS)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """The content of `summary.json`."""
        path = self.folder / "summary.json"
        content = read_json(path)
        try:
            _Summary.model_validate_json(json.dumps(content))
        except ValidationError as error:
            raise damaged(path, first_problem(error)) from None
        return content

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The whole content of `results.nc`, loaded into memory."""
        results = dataset_as_now(read_netcdf(self._netcdf))
        for name, column in ((column.variable, column) for column in COLUMNS.values()):
            if name not in results or results[name].dims != ("indentation_max",):
                raise damaged(self._netcdf, f"{name} is missing")
            for value in results[name].values.tolist():
                check_number(self._netcdf, name, column, float(value))
        for name in ("case", "derived_reduced_radius_m", "derived_contact_modulus_Pa"):
            if name not in results.attrs:
                raise damaged(self._netcdf, f"the attribute {name} is missing")
        return with_coordinates(results)

    def smooth(self) -> xr.Dataset:
        """The smooth bodies' variables of `results.nc`, and all attributes of the file."""
        with opened(self._netcdf) as stored:
            return stored[[name for name in stored if str(name).startswith("smooth_")]].load()

    @cached_property
    def maps(self) -> xr.Dataset:
        """The maps of every depth (`maps.nc`), which a case with maps = "all" stores."""
        return read_maps(self.folder)

    @cached_property
    def case_text(self) -> str:
        """The text of the case file."""
        return self._case_and_depths[0]

    @cached_property
    def case(self) -> Case:
        """The case of the run, parsed from `case_text`."""
        try:
            return parse_case(self.case_text)
        except CaseError as error:
            raise damaged(self._netcdf, f"its case: {error}") from None

    @cached_property
    def unloading(self) -> tuple[UnloadingCurve, ...]:
        """The unloading curves, sorted by `start`; empty if none is stored."""
        results, curves = self.dataset, []
        if "unloading_from" not in results:
            return ()
        names = ("unloading_from", "unloading_indentation", "unloading_force")
        try:
            for start, x, F in zip(*(results[name].values for name in names), strict=True):
                known = np.isfinite(x)
                falls = known.any() and (np.diff(x[known]) < 0).all()
                if not falls or not np.isfinite(F[known]).all():
                    raise ValueError("an unloading curve has gaps, or its depths do not decrease")
                curves.append(UnloadingCurve(float(start), x[known][::-1], F[known][::-1]))
        except (KeyError, ValueError, IndexError, TypeError) as error:
            raise damaged(self._netcdf, f"{type(error).__name__}: {error}") from None
        return tuple(sorted(curves, key=lambda curve: curve.start))

    @cached_property
    def oblique(self) -> list[dict[str, float]]:
        """The rows of `oblique.csv`, one for each oblique impact; empty without this file."""
        path = self.folder / OBLIQUE_FILE
        if not path.exists():
            return []
        return _read_table(path, OBLIQUE_COLUMNS, OBLIQUE_COLUMNS | OBLIQUE_SPREAD_COLUMNS).rows

    @property
    def _netcdf(self) -> Path:
        return self.folder / "results.nc"

    @cached_property
    def _case_and_depths(self) -> tuple[str, int | None]:
        with opened(self._netcdf) as stored:
            case, depths = stored.attrs.get("case"), stored.sizes.get("indentation_max")
        if not isinstance(case, str):
            raise damaged(self._netcdf, "the attribute case is missing")
        return case, depths

    def check(self) -> None:
        """Raise `OutputError` unless curve, summary and dataset have the same number of depths."""
        computed, rows = self.summary["depths_computed"], len(self.curve.rows)
        _, depths = self._case_and_depths
        if not rows == depths == computed:
            raise OutputError(
                f"{self.folder}: curve.csv has {rows} depths, results.nc {depths}, and the run "
                f"computed {computed}; a file is damaged: run the case again"
            )

    def _summary(self) -> list[str]:
        try:
            rows, summary = self.curve.rows, self.summary
        except OutputError as error:
            return [str(error)]
        depths = [row["max_indentation_m"] for row in rows]
        e = [e for row in rows if not math.isnan(e := row["restitution"])]
        span = f" to {quantity(max(depths), 'm')}" if rows else ""
        span += f", COR {min(e):.4f} to {max(e):.4f}" if e else ""
        warned = counted(len(summary["warnings"]), "warning")
        return [
            f'"{summary["title"]}", {summary["status"]}, {warned}; {self.folder}',
            f"{len(rows)} of {counted(summary['depths_asked'], 'depth')}{span}",
        ]

    __repr__ = summary_text
    _repr_html_ = summary_html


@dataclass(frozen=True, repr=False)
class EnsembleResults(RunResults):
    """The results of one case on several surfaces; each row is a mean over the surfaces."""

    @property
    def surfaces(self) -> int:
        """Number of surfaces, including failed ones."""
        return len(self.summary["realisations"])


@dataclass(frozen=True)
class StoredCase:
    """One case of a study.

    Attributes:
        name: Name of the folder of the case.
        status: One of the values of `STATUS`.
        reason: Reason for a failure; otherwise empty.
        swept: The swept values, by key.
        curve: Curve of the case; empty unless the case is complete.
    """

    name: str
    status: str
    reason: str
    swept: dict[str, str]
    curve: Curve


@dataclass(frozen=True)
class StudyResults:
    """The results of a study in `folder`.

    Each file is read on first use; a missing or damaged file raises `OutputError`.
    """

    folder: Path

    @cached_property
    def cases(self) -> list[StoredCase]:
        """The cases in `table.csv`."""
        path = self.folder / "table.csv"
        found: dict[str, StoredCase] = {}
        for line, cells in enumerate(read_cells(path, (*REQUIRED, "case", "status", "reason")), 2):
            swept = dict(list(cells.items())[: list(cells).index("max_indentation_m")])
            status = cells["status"]
            if status not in STATUS:
                raise damaged(path, f"line {line}: status is {status!r}")
            name = cells["case"]
            case = found.setdefault(
                name, StoredCase(name, status, cells["reason"], swept, Curve([], []))
            )
            if (case.status, case.swept) != (status, swept):
                raise damaged(
                    path, f"line {line}: the rows of {name} differ in status or swept values"
                )
            if status == "complete":
                case.curve.rows.append(as_now(read_numbers(path, line, cells)))
                case.curve.cells.append(cells)
        check_file(path)
        if not found:
            raise damaged(path, "it has no rows")
        return list(found.values())

    @cached_property
    def text(self) -> str:
        """The text of the study file."""
        return read_text(self.folder / "study.toml")

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The whole content of `study.nc`, loaded into memory."""
        return with_coordinates(read_netcdf(self.folder / "study.nc"))

    def run(self, name: str) -> RunResults:
        """Return the results of the case `name`."""
        return RunResults(self.folder / "cases" / name)

    def _summary(self) -> list[str]:
        try:
            cases = self.cases
        except OutputError as error:
            return [str(error)]
        ends = Counter(case.status for case in cases)
        values = {key: len({case.swept[key] for case in cases}) for key in cases[0].swept}
        count = ", ".join(f"{number} {status}" for status, number in ends.items())
        keys = ", ".join(f"{key} ({counted(number, 'value')})" for key, number in values.items())
        return [f"{counted(len(cases), 'case')}, {count}; {self.folder}", f"swept: {keys}"]

    __repr__ = summary_text
    _repr_html_ = summary_html


def read_run(folder: Path) -> RunResults:
    """Open the results in `folder`, for one surface or an ensemble. Raises `OutputError`."""
    require_restitution(folder)
    run = RunResults(folder)
    return EnsembleResults(folder) if "realisations" in run.summary else run


def _read_table(path: Path, required: Iterable[str], columns: Mapping[str, Column]) -> Curve:
    """Read and check a table, which must have the columns `required`.

    The cells of `columns` are converted to numbers.
    """
    cells = read_cells(path, required)
    rows = [as_now(read_numbers(path, line, row, columns)) for line, row in enumerate(cells, 2)]
    check_file(path)
    return Curve(rows, cells)
