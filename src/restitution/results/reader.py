"""Read stored tables and files, compare them with their checksums, and reject damaged ones."""

from __future__ import annotations

import json
import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
import xarray as xr
from pydantic import BaseModel, ConfigDict, Field, FiniteFloat, NonNegativeInt, ValidationError

from restitution.case.case import Case
from restitution.case.case_file import parse_case
from restitution.curve.columns import Column
from restitution.curve.curve import Curve, UnloadingCurve
from restitution.curve.oblique import MeanObliquePoint, ObliquePoint
from restitution.curve.point import MeanPoint, Point
from restitution.display import counted, quantity, summary_html, summary_text
from restitution.errors import CaseError, OutputError, first_problem
from restitution.repeated.points import RepeatedImpact, RunInPoint
from restitution.results.checksums import check_file
from restitution.results.coordinates import with_coordinates
from restitution.results.schema import (
    ALL_COLUMNS,
    ALL_OBLIQUE_COLUMNS,
    COLUMNS,
    COVERAGE_FILE,
    IMPACT_COLUMNS,
    IMPACTS_FILE,
    OBLIQUE_COLUMNS,
    OBLIQUE_FILE,
    RUN_IN_COLUMNS,
    SEQUENCE,
    STATUS,
)
from restitution.results.stored_files import (
    opened,
    read_json,
    read_maps,
    read_netcdf,
    read_text,
    stored_file,
)
from restitution.results.tables import (
    check_number,
    damaged,
    read_cells,
    read_numbers,
    require_restitution,
)

Oblique = tuple[ObliquePoint, ...]
LATER = frozenset(
    {
        "pull_off_error_N",
        "adhesive_spacing_m",
        "restitution_with_losses",
        "plate_factor",
        "waves_factor",
        "viscosity_factor",
        "loss_error",
    }
)
"""Columns that older tables lack; they are read as empty."""
REQUIRED = tuple(name for name in COLUMNS if name not in LATER)


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
class RunResults:
    """The results of one run or convergence study in `folder`, or in memory (`folder` is None).

    Each file is read on first use; a missing or damaged file raises `OutputError`.
    """

    folder: Path | None

    @classmethod
    def in_memory(cls, **results: Any) -> Self:
        """`results` by the names of the attributes that else read them."""
        made = cls(None)
        vars(made).update(results)  # `cached_property` looks here first
        return made

    @cached_property
    def curve(self) -> Curve:
        rows = _read_rows(self._file("curve.csv"), REQUIRED, ALL_COLUMNS)
        return Curve(tuple(map(_point, rows)))

    @cached_property
    def summary(self) -> dict[str, Any]:
        path = self._file("summary.json")
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
        if self.folder is None:
            return _smooth(self.dataset)
        with opened(self._netcdf) as stored:
            return _smooth(stored).load()

    @cached_property
    def maps(self) -> xr.Dataset:
        """The maps of every depth (`maps.nc`), which a case with maps = "all" stores."""
        return read_maps(self._file("maps.nc").parent)

    @cached_property
    def case_text(self) -> str:
        return self._case_and_depths[0]

    @cached_property
    def case(self) -> Case:
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
    def oblique(self) -> Oblique:
        """The oblique impacts, from `oblique.csv`; empty without this file."""
        path = self._file(OBLIQUE_FILE)
        if not path.exists():
            return ()
        rows = _read_rows(path, OBLIQUE_COLUMNS, ALL_OBLIQUE_COLUMNS)
        kind = MeanObliquePoint if "realisations" in rows[0] else ObliquePoint
        return tuple(map(kind.of_cells, rows))

    @cached_property
    def run_in(self) -> tuple[RunInPoint, ...]:
        """COR at each velocity and coverage, from `coverage.csv`; empty without this file."""
        path = self._file(COVERAGE_FILE)
        if not path.exists():
            return ()
        return tuple(map(RunInPoint.of_cells, _read_rows(path, RUN_IN_COLUMNS, RUN_IN_COLUMNS)))

    @cached_property
    def impacts(self) -> tuple[tuple[RepeatedImpact, ...], ...]:
        """The impacts of each sequence, from `impacts.csv`; empty without this file."""
        path = self._file(IMPACTS_FILE)
        if not path.exists():
            return ()
        columns = {SEQUENCE.header: SEQUENCE} | IMPACT_COLUMNS
        rows = _read_rows(path, columns, columns)
        sequences: dict[float, list[RepeatedImpact]] = {}
        for row in rows:
            sequences.setdefault(row[SEQUENCE.header], []).append(RepeatedImpact.of_cells(row))
        return tuple(map(tuple, sequences.values()))

    def _file(self, name: str) -> Path:
        return stored_file(self.folder, name)

    @property
    def _netcdf(self) -> Path:
        return self._file("results.nc")

    @cached_property
    def _case_and_depths(self) -> tuple[str, int | None]:
        if self.folder is None:
            return self.dataset.attrs["case"], self.dataset.sizes["indentation_max"]
        with opened(self._netcdf) as stored:
            case, depths = stored.attrs.get("case"), stored.sizes.get("indentation_max")
        if not isinstance(case, str):
            raise damaged(self._netcdf, "the attribute case is missing")
        return case, depths

    def check(self) -> None:
        """Raise `OutputError` unless curve, summary and dataset have the same number of depths."""
        computed, rows = self.summary["depths_computed"], len(self.curve.points)
        _, depths = self._case_and_depths
        if not rows == depths == computed:
            raise OutputError(
                f"{self.folder}: curve.csv has {rows} depths, results.nc {depths}, and the run "
                f"computed {computed}; a file is damaged: run the case again"
            )

    def _summary(self) -> list[str]:
        try:
            points, summary = self.curve.points, self.summary
        except OutputError as error:
            return [str(error)]
        e = [point.restitution for point in points if not math.isnan(point.restitution)]
        span = f" to {quantity(max(p.indentation for p in points), 'm')}" if points else ""
        span += f", COR {min(e):.4f} to {max(e):.4f}" if e else ""
        warned = counted(len(summary["warnings"]), "warning")
        return [
            f'"{summary["title"]}", {summary["status"]}, {warned}; {self.folder or "in memory"}',
            f"{len(points)} of {counted(summary['depths_asked'], 'depth')}{span}",
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
        cases: dict[str, StoredCase] = {}
        for line, cells in enumerate(read_cells(path, (*REQUIRED, "case", "status", "reason")), 2):
            swept = dict(list(cells.items())[: list(cells).index("max_indentation_m")])
            name, status = cells["case"], cells["status"]
            if status not in STATUS:
                raise damaged(path, f"line {line}: status is {status!r}")
            case = cases.get(name) or StoredCase(name, status, cells["reason"], swept, Curve())
            if (case.status, case.swept) != (status, swept):
                raise damaged(
                    path, f"line {line}: the rows of {name} differ in status or swept values"
                )
            if status == "complete":
                point = _point(as_now(read_numbers(path, line, cells)))
                case = replace(case, curve=Curve((*case.curve.points, point)))
            cases[name] = case
        check_file(path)
        if not cases:
            raise damaged(path, "it has no rows")
        return list(cases.values())

    @cached_property
    def text(self) -> str:
        return read_text(self.folder / "study.toml")

    @cached_property
    def dataset(self) -> xr.Dataset:
        """The whole content of `study.nc`, loaded into memory."""
        return with_coordinates(read_netcdf(self.folder / "study.nc"))

    def run(self, name: str) -> RunResults:
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


def _smooth(results: xr.Dataset) -> xr.Dataset:
    return results[[name for name in results if str(name).startswith("smooth_")]]


def _point(row: Mapping[str, Any]) -> Point:
    return (MeanPoint if "realisations" in row else Point).of_cells(row)


def _read_rows(
    path: Path, required: Iterable[str], columns: Mapping[str, Column]
) -> list[dict[str, Any]]:
    cells = read_cells(path, required)
    rows = [as_now(read_numbers(path, line, row, columns)) for line, row in enumerate(cells, 2)]
    check_file(path)
    return rows


def as_now(row: dict[str, Any]) -> dict[str, Any]:
    """Bring a row of an older table up to date."""
    if "adhesion_resolved" not in row:
        return row
    resolved = row["resolved"] and row["adhesion_resolved"]  # `resolved` left adhesion out
    missing = dict.fromkeys(LATER - row.keys(), math.nan)
    return row | missing | {"resolved": resolved}


def dataset_as_now(results: xr.Dataset) -> xr.Dataset:
    depths = results.sizes.get("indentation_max", 0)
    for column in (COLUMNS[name] for name in LATER if COLUMNS[name].variable not in results):
        results[column.variable] = column.labelled("indentation_max", np.full(depths, np.nan))
    if {"resolved", "adhesion_resolved"} <= set(results):
        results["resolved"] = results["resolved"] & results["adhesion_resolved"]
    return results
