"""The folder of a study: one folder for each case, and tables made anew from all cases.

A case is written to a temporary folder, which is then renamed: completely or not at all.
"""

from __future__ import annotations

import json
import math
import shutil
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from restitution.curve.curve import Curve
from restitution.errors import OutputError
from restitution.results.coordinates import with_coordinates
from restitution.results.interruption import hold_signals
from restitution.results.locking import locked
from restitution.results.reader import RunResults
from restitution.results.schema import ALL_COLUMNS, COLUMNS
from restitution.results.stored_files import read_json, read_text
from restitution.results.writer import (
    make_folder,
    replace_file,
    write_checksums,
    write_netcdf,
    write_table,
    writing,
)
from restitution.sweeps.executors import Outcome
from restitution.sweeps.sweep import Study, SweptCase, as_text, coordinate

FAILED, STUDY_FILE = "failed.json", "study.toml"


def prepare_folder(path: Path, name: str, text: str, *, resume: bool, what: str) -> None:
    """Prepare the folder `path` for a study or a mixture (`what`), whose file `name` holds `text`.

    Without `resume`, it must be new or empty; with `resume`, it must hold the same file. Raises
    `OutputError`.
    """
    held = path / name
    if not resume:
        make_folder(path, "continue with --resume" if held.is_file() else "move it away")
        replace_file(held, lambda to: to.write_text(text, encoding="utf-8"))
    elif not held.is_file():
        raise OutputError(f"{path}: holds no {what} to resume; leave out --resume to start one")
    elif read_text(held) != text:
        raise OutputError(
            f"{path}: holds another {what} (its {name} differs); name another folder with -o, or "
            f"give the file with which this {what} was started"
        )


class StudyFolder:
    """The folder of a study: `study.toml`, `cases/case-00001/` etc., `table.csv`, `study.nc`."""

    def __init__(self, path: Path, study: Study, *, resume: bool) -> None:
        """Prepare the folder for `study` (`prepare_folder`)."""
        self.path, self.study = path, study
        self._cases = path / "cases"
        prepare_folder(path, STUDY_FILE, study.text, resume=resume, what="study")
        with writing(path):
            self._cases.mkdir(parents=True, exist_ok=True)

    def locked(self) -> AbstractContextManager[None]:
        """Lock the folder. Raises `OutputError` if another process holds the lock."""
        return locked(self.path)

    def folder_of(self, case: SweptCase) -> Path:
        """The folder for the results of `case`."""
        return self._cases / case.name

    def clear(self) -> None:
        """Remove incomplete cases that a killed process left behind."""
        for left in self._cases.glob(".*"):
            shutil.rmtree(left, ignore_errors=True)

    def put(self, case: SweptCase, outcome: Outcome) -> None:
        """Store the outcome of a case. Raises `OutputError` if it cannot be written."""
        part, whole = self._cases / f".{case.name}", self.folder_of(case)
        files = outcome.files | {"case.toml": case.text.encode()}
        if outcome.reason:
            files[FAILED] = json.dumps({"reason": outcome.reason}, ensure_ascii=False).encode()
        with hold_signals(), writing(self.path):
            shutil.rmtree(part, ignore_errors=True)
            for name, content in files.items():
                file = part / name
                file.parent.mkdir(parents=True, exist_ok=True)
                file.write_bytes(content)
            shutil.rmtree(whole, ignore_errors=True)
            part.rename(whole)

    def reason(self, case: SweptCase) -> str | None:
        """Why a case failed; "" if it is complete, None if it is missing or damaged.

        A stored case whose text differs from `case` counts as missing.
        """
        folder = self.folder_of(case)
        try:
            if (folder / "case.toml").read_text(encoding="utf-8") != case.text:
                return None
            if (folder / FAILED).is_file():
                return str(read_json(folder / FAILED)["reason"]) or None
            run = RunResults(folder)
            run.check()
        except (OutputError, OSError, ValueError, KeyError):
            return None
        return "" if run.curve.points and run.summary["status"] == "complete" else None

    def write_tables(self) -> None:
        """Write `table.csv` and `study.nc` from the stored cases."""
        reasons = [self.reason(case) for case in self.study.cases]
        curves = [
            RunResults(self.folder_of(case)).curve if reason == "" else Curve()
            for case, reason in zip(self.study.cases, reasons, strict=True)
        ]
        write_table(self.path / "table.csv", self._rows(reasons, curves))
        write_netcdf(self.path / "study.nc", with_coordinates(self._dataset(reasons, curves)))
        write_checksums(self.path, ["study.nc", "study.toml", "table.csv"])

    def _rows(self, reasons: list[str | None], curves: list[Curve]) -> list[dict[str, Any]]:
        columns = next((curve.points[0].columns() for curve in curves if curve.points), COLUMNS)
        rows = []
        for case, reason, curve in zip(self.study.cases, reasons, curves, strict=True):
            swept = {key: as_text(value) for key, value in case.values.items()}
            end = {"case": case.name, "status": _status(reason), "reason": reason or ""}
            for row in curve.rows or [{}]:
                rows.append({**swept, **{name: row.get(name, "") for name in columns}, **end})
        return rows

    def _dataset(self, reasons: list[str | None], curves: list[Curve]) -> xr.Dataset:
        """Its dimensions are the swept keys (or the cases, if paired) and the depth."""
        study, rows_of = self.study, [curve.rows for curve in curves]
        paired, depths = study.mode == "paired", max(map(len, rows_of), default=0)
        dims = ("case",) if paired else tuple(study.swept)
        coordinates = {
            key: ("case" if paired else key, *coordinate(values))
            for key, values in study.swept.items()
        }
        data: dict[str, Any] = {}
        for name, column in ALL_COLUMNS.items():
            if not any(name in rows[0] for rows in rows_of if rows):
                continue
            values = np.full((len(study.cases), depths), np.nan)
            for line, rows in zip(values, rows_of, strict=True):
                line[: len(rows)] = [row.get(name, math.nan) for row in rows]
            data[column.variable] = column.labelled(
                (*dims, "depth"), values.reshape(*study.shape, depths)
            )
        data["status"] = dims, np.reshape([_status(reason) for reason in reasons], study.shape)
        attributes = {"title": study.title, "study": study.text}
        return xr.Dataset(data, coordinates, attributes)


def _status(reason: str | None) -> str:
    return {None: "missing", "": "complete"}.get(reason, "failed")
