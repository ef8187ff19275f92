"""Write a results folder.

Rows are appended to `curve.csv` and `unloading.csv` one by one, so that they survive if the run is
stopped. The other files are written at the end or on interruption, under a temporary name, and then
renamed. Signals are delayed while a file is written.
"""

from __future__ import annotations

import csv
import importlib.metadata
import io
import json
import math
import os
import platform
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from itertools import zip_longest
from pathlib import Path
from typing import IO, Any

import numpy as np
import xarray as xr

from restitution.contact.jkr.unloading_curve import complete_curve
from restitution.contact.state import State
from restitution.curve.columns import Column, Record
from restitution.curve.curve import Curve
from restitution.curve.oblique import ObliquePoint
from restitution.curve.periodic import PeriodicPoint
from restitution.curve.point import Point
from restitution.errors import OutputError, one_line
from restitution.repeated.points import RepeatedImpact, RunInPoint
from restitution.results.checksums import CHECKSUMS, checksums
from restitution.results.coordinates import with_coordinates
from restitution.results.interruption import hold_signals
from restitution.results.reader import EnsembleResults, RunResults
from restitution.results.schema import (
    COLUMNS,
    COVERAGE_FILE,
    IMPACTS_FILE,
    LOCK,
    OBLIQUE_FILE,
    SEQUENCE,
    UNLOADING_COLUMNS,
)

_BLOCK = 1 << 16  # bytes written to find out whether the disk is full


def versions() -> dict[str, str]:
    packages = ("restitution", "numpy", "scipy", "ducc0", "xarray", "netCDF4")
    python = {"python": platform.python_version()}
    return {name: importlib.metadata.version(name) for name in packages} | python


class ResultsFolder:
    """The results of one run so far, in a folder or, if `path` is None, in memory only."""

    def __init__(self, path: Path | None) -> None:
        self.path = path
        self.curve = Curve()
        self.periodic: list[PeriodicPoint] = []
        self.unloading: list[tuple[float, list[tuple[float, float]]]] = []
        self.oblique: tuple[ObliquePoint, ...] = ()
        self.run_in: tuple[RunInPoint, ...] = ()
        self.impacts: tuple[tuple[RepeatedImpact, ...], ...] = ()
        self.dataset, self.summary = xr.Dataset(), dict[str, Any]()
        self._new = path is not None and make_folder(path)
        self._curve: IO[str] = io.StringIO()
        self._unloading: IO[str] = io.StringIO()

    @property
    def rows(self) -> list[dict[str, Any]]:
        """The rows of `curve.csv` or `periodic.csv`, with their headers as keys."""
        return [point.cells() for point in self.periodic or self.curve.points]

    def part(self, name: str) -> ResultsFolder:
        return ResultsFolder(None if self.path is None else self.path / name)

    @contextmanager
    def tables(self) -> Iterator[None]:
        """Open `curve.csv` and `unloading.csv` for `add` and `add_unloading`."""
        if self.path is None:
            yield
            return
        with (
            writing(self.path),
            open(self.path / "curve.csv", "w", newline="") as curve,
            open(self.path / "unloading.csv", "w", newline="") as unloading,
        ):
            self._curve, self._unloading = curve, unloading
            _write_row(curve, list(COLUMNS))
            _write_row(unloading, list(UNLOADING_COLUMNS))
            yield

    def add(self, point: Point) -> None:
        with hold_signals():
            _write_row(self._curve, [format_cell(value) for value in point.cells().values()])
            self.curve = Curve((*self.curve.points, point))

    def put_curve(self, points: Sequence[Point]) -> None:
        self.curve = Curve(tuple(points))
        self.put_table("curve.csv", points)

    def put_oblique(self, points: Sequence[ObliquePoint]) -> None:
        self.oblique = tuple(points)
        if points:
            self.put_table(OBLIQUE_FILE, points)

    def put_run_in(
        self, points: Sequence[RunInPoint], impacts: tuple[tuple[RepeatedImpact, ...], ...]
    ) -> None:
        """Keep and write COR at each coverage, and the impacts of each sequence."""
        self.run_in, self.impacts = tuple(points), impacts
        self.put_table(COVERAGE_FILE, points)
        rows = (
            {SEQUENCE.header: float(number)} | impact.cells()
            for number, sequence in enumerate(impacts, 1)
            for impact in sequence
        )
        self.put_table(IMPACTS_FILE, list(rows))

    def put_table(self, name: str, points: Sequence[Record | Mapping[str, Any]]) -> None:
        """Write a table, completely or not at all."""
        if self.path is not None:
            rows = [p.cells() if isinstance(p, Record) else p for p in points]
            write_table(self.path / name, rows)

    def add_unloading(self, path: Sequence[State], touch: float = 0.0) -> None:
        """Append one unloading curve, from its deepest state to separation, to `unloading.csv`.

        `touch` (m) is added to the indentations, as in `Point.of`.
        """
        deepest = path[0].indentation + touch
        points = [(indentation + touch, force) for indentation, force in complete_curve(path)]
        with hold_signals():
            for point in points:
                _write_row(self._unloading, [repr(v) for v in (deepest, *point)])
            self.unloading.append((deepest, points))

    @property
    def results(self) -> RunResults:
        kind = EnsembleResults if "realisations" in self.summary else RunResults
        if self.path is not None:
            return kind(self.path)
        return kind.in_memory(
            curve=self.curve,
            summary=self.summary,
            dataset=self.dataset,
            oblique=self.oblique,
            run_in=self.run_in,
            impacts=self.impacts,
        )

    def discard(self) -> None:
        """Remove the empty tables, and the folder if it is new, so that another run can use it."""
        if self.path is None:
            return
        for name in ("curve.csv", "unloading.csv"):
            (self.path / name).unlink(missing_ok=True)
        if self._new:
            self.path.rmdir()

    def write(self, dataset: xr.Dataset, summary: dict[str, Any]) -> None:
        """Write `results.nc`, `summary.json` and the checksums of all files.

        If `results.nc` cannot be written, `summary.json` records the failure.
        """
        self.dataset = with_coordinates(dataset)
        self.summary = json.loads(json.dumps(summary))  # as it will be read
        if self.path is None:
            return
        maps = {"height", "pressure", "plastic_displacement"} & set(dataset)
        packed = {str(name): {"zlib": True, "complevel": 1} for name in maps}
        with hold_signals():
            try:
                write_netcdf(self.path / "results.nc", self.dataset, packed)
            except OutputError as error:
                failed = {**summary, "status": "failed", "reason": one_line(str(error))}
                with suppress(OutputError):
                    write_json(self.path / "summary.json", failed)
                raise
            write_json(self.path / "summary.json", summary)
            tables = sorted(
                path.name for path in self.path.iterdir() if path.suffix in (".csv", ".npz")
            )
            more = ["maps.nc"] if (self.path / "maps.nc").is_file() else []
            write_checksums(self.path, [*tables, *more, "results.nc", "summary.json"])


def make_folder(path: Path, remedy: str = "move it away") -> bool:
    """Make the folder `path`, which must be empty, and return whether it is new.

    The error advises to name another folder, or to do what `remedy` says.
    """
    with writing(path):
        new = not path.exists()
        path.mkdir(parents=True, exist_ok=True)
        if any(file.name != LOCK for file in path.iterdir()):
            raise OutputError(
                f"{path}: this folder is not empty, and nothing in it is overwritten; name another "
                f"folder with -o, or {remedy}"
            )
    return new


def require_new_file(path: Path | None) -> None:
    if path is not None and path.exists():
        raise OutputError(f"{path}: already exists and is not overwritten; name another file")


def write_checksums(folder: Path, names: Sequence[str]) -> None:
    replace_file(
        folder / CHECKSUMS, lambda to: to.write_text(checksums(folder, names), encoding="utf-8")
    )


def write_netcdf(
    path: Path, dataset: xr.Dataset, encoding: Mapping[str, Any] | None = None
) -> None:
    def write(to: Path) -> None:
        try:
            dataset.to_netcdf(to, engine="netcdf4", encoding=encoding or {})
        except (RuntimeError, OSError) as error:
            # The netCDF library hides the reason, such as a full disk. Writing to the file again
            # raises the error of the operating system.
            with open(to, "ab") as file:
                file.write(bytes(_BLOCK))
            raise OSError(f"{path.name}: {error}") from error

    replace_file(path, write)


def write_json(path: Path, content: Mapping[str, Any]) -> None:
    text = json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    replace_file(path, lambda to: to.write_text(text, encoding="utf-8"))


def write_table(path: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    text = table_text(rows)
    replace_file(path, lambda to: to.write_text(text, encoding="utf-8", newline=""))


def table_text(rows: Sequence[Mapping[str, Any]]) -> str:
    text = io.StringIO()
    if rows:
        table = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        table.writeheader()
        table.writerows({key: format_cell(value) for key, value in row.items()} for row in rows)
    return text.getvalue()


def replace_file(path: Path, write: Callable[[Path], object]) -> None:
    """Let `write` fill a temporary file, and rename it to `path`; signals wait meanwhile."""
    temporary = path.with_name(f".{path.name}.part")
    with hold_signals(), writing(path.parent):
        try:
            write(temporary)
            os.replace(temporary, path)
        except BaseException:
            with suppress(OSError):  # frees the disk space even if a library has the file open
                os.truncate(temporary, 0)
            raise
        finally:
            temporary.unlink(missing_ok=True)


def results_dataset(folder: ResultsFolder, deepest: State) -> xr.Dataset:
    """The content of `results.nc`, with units: curve, unloading curves and maps."""
    data = curve_variables(folder.curve.points) | oblique_variables(folder.oblique)
    if folder.unloading:
        depths, curves = zip(*folder.unloading, strict=True)
        # Pad shorter curves with NaN.
        steps = np.array(list(zip_longest(*curves, fillvalue=(math.nan, math.nan))))
        indentation, force = steps.transpose(2, 1, 0)
        along = ("unloading", "unloading_step")
        data["unloading_from"] = (
            "unloading",
            np.array(depths),
            {"units": "m", "long_name": "maximum indentation"},
        )
        data["unloading_indentation"] = (along, indentation, {"units": "m"})
        data["unloading_force"] = (along, force, {"units": "N"})
    return dataset_with_maps(
        data,
        deepest,
        pressure="contact pressure at the deepest indentation",
        lowering="lowering of the surface by yielding",
    )


def dataset_with_maps(
    data: Mapping[str, Any], deepest: State, *, pressure: str, lowering: str
) -> xr.Dataset:
    grid = deepest.contact.grid
    coordinates = {"x": ("x", grid.x, {"units": "m"}), "y": ("y", grid.y, {"units": "m"})}
    maps = (
        (("height", "m", "composite roughness"), deepest.contact.surface.height),
        (("pressure", "Pa", pressure), deepest.pressure),
        (("plastic_displacement", "m", lowering), deepest.plastic_displacement),
    )
    labelled = {
        name: (("x", "y"), values, {"units": unit, "long_name": words})
        for (name, unit, words), values in maps
    }
    return xr.Dataset({**data, **labelled}, coordinates)


def curve_variables(points: Sequence[Record], along: str = "indentation_max") -> dict[str, Any]:
    """The variables of `results.nc` for the points of a curve, with the dimension `along`."""
    return {
        column.variable: column.labelled(along, values) for column, values in _by_column(points)
    }


def _by_column(points: Sequence[Record]) -> Iterator[tuple[Column, np.ndarray[Any, Any]]]:
    if points:
        rows = [point.cells() for point in points]
        for header, column in points[0].columns().items():
            yield column, np.array([row[header] for row in rows])


def status_attributes(summary: Mapping[str, Any]) -> dict[str, str]:
    """The attributes of `results.nc` that state how the run ended."""
    return {
        "title": summary["title"],
        "status": summary["status"],
        "warnings": "\n".join(summary["warnings"]),
    }


def case_attributes(summary: Mapping[str, Any], text: str) -> dict[str, str]:
    """The attributes of `results.nc` that describe the case; `text` is its file."""
    groups = ("model", "conventions", "derived", "surface", "surface_statistics", "versions")
    entries = {
        f"{group}_{key}": str(value) for group in groups for key, value in summary[group].items()
    }
    return {"case": text, **entries}


def oblique_variables(points: Sequence[ObliquePoint]) -> dict[str, Any]:
    """The variables of `results.nc` for oblique impacts, by velocity and angle; NaN in between."""
    if not points:
        return {}
    (velocity, V), (angle, theta), *others = _by_column(points)
    axes = velocity, angle
    ticks, at = zip(*(np.unique(of, return_inverse=True) for of in (V, theta)), strict=True)
    along = tuple(axis.variable for axis in axes)
    data = {
        axis.variable: axis.labelled(axis.variable, values)
        for axis, values in zip(axes, ticks, strict=True)
    }
    for column, known in others:
        values = np.full([tick.size for tick in ticks], np.nan)
        values[at] = known
        data[column.variable] = column.labelled(along, values)
    return data


def format_cell(value: float | str) -> str:
    """Format a cell of a table: "true" or "false", "" for NaN, or a number with all digits."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return value
    return "" if math.isnan(value) else repr(value)


def _write_row(file: IO[str], values: list[str]) -> None:
    csv.writer(file, lineterminator="\n").writerow(values)
    file.flush()


@contextmanager
def writing(path: Path) -> Iterator[None]:
    """Convert `OSError` to an `OutputError` that names `path` and the remedy."""
    try:
        yield
    except OSError as error:
        reason = error.strerror or str(error)
        raise OutputError(
            f"{path}: cannot be written ({reason}); name another folder with -o, or free disk space"
        ) from error
