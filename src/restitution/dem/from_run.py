"""A law from the stored results of a run, of an ensemble or of a convergence study."""

from __future__ import annotations

import csv
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import xarray as xr

from restitution.dem.compact import compact_fit
from restitution.dem.fitted import Begin, fitted_laws
from restitution.dem.law import LAW_FILE, Conventions, Law, Particle, Point
from restitution.errors import CaseError, OutputError
from restitution.studies.case import parse_case
from restitution.studies.particles import BodyTable

_Row = Mapping[str, str]


def law_of(out: Path, begin: Begin | None = None) -> Law:
    """The law of what was computed in the folder `out`, with its fits.

    `begin` is called before each fit (`fitted.Begin`). Raises as `bare_law`.
    """
    law = bare_law(out)
    return law.model_copy(update={"fit": compact_fit(law), "laws": fitted_laws(law, begin)})


def bare_law(out: Path) -> Law:
    """The law of what was computed in the folder `out`, without fits.

    An ensemble gives the law of its mean curve; the error of each point then includes the
    confidence interval of the mean, and that of a convergence study the error of its grid. Points
    whose impact velocity does not exist (adhesion has done more work than the approach) are left
    out. Raises `OutputError` where the folder holds no run, `CaseError` where it has no velocities.
    """
    rows, summary, text = _read(out)
    case = parse_case(text)
    derived, model = summary["derived"], summary["model"]
    if derived["reduced_mass_kg"] is None:
        raise CaseError(
            f"{out}: has no impact velocities, for a density is not given in its case; give "
            "first.density (and second.density) and run it again"
        )
    points = _points(rows)
    if not points:
        raise CaseError(f"{out}: has no depth that an impact reaches; compute deeper ones")
    warnings = list(summary["warnings"])
    if summary["status"] != "complete":
        warnings.insert(0, f"the run is not complete ({summary['status']}: {summary['reason']})")
    if case.interface.work_of_adhesion > 0 and case.unloading.method == "energy-estimate":
        warnings.append(
            'COR is an estimate (unloading.method = "energy-estimate"), and pull-off is not known'
        )
    if left := len(rows) - len(points):
        warnings.append(
            f"{left} of {len(rows)} depths are left out: no impact turns back there, because "
            "adhesion has done more work than the approach, or no force was found"
        )
    pair = case.pair()
    law = Law(
        title=case.title,
        first=_particle("first", case.first),
        second=_particle("second", case.second) if case.second else _particle("first", case.first),
        radius=pair.radius,
        contact_modulus=pair.contact_modulus,
        mass=derived["reduced_mass_kg"],
        yield_pressure=derived["yield_pressure_Pa"],
        work_of_adhesion=case.interface.work_of_adhesion,
        model={key: str(value) for key, value in model.items()},
        conventions=Conventions(
            **summary["conventions"],
            restitution_error=_error_is(rows, case.realisations, bool(case.roughness)),
        ),
        yield_velocity=derived["yield_velocity_m_per_s"],
        sticking_velocity=derived.get("sticking_velocity_m_per_s"),
        sticks_below=None,
        points=tuple(points),
        warnings=tuple(warnings),
        case=text,
        versions=summary["versions"],
    )
    if law.sticks_everywhere:
        warnings.append(
            f"the pair sticks at every velocity that was computed (up to {law.highest:.4g} m/s); "
            "where it begins to rebound is above"
        )
    return law.model_copy(
        update={"sticks_below": law.curve().begins(), "warnings": tuple(warnings)}
    )


def _read(out: Path) -> tuple[list[_Row], dict[str, Any], str]:
    if (out / "study.toml").is_file():
        raise OutputError(
            f"{out}: is a study of many cases, and a law is that of one pair; run the case by "
            "itself (`restitution run`) and name its folder"
        )
    if (out / LAW_FILE).is_file():
        raise OutputError(f"{out}: is a law already; name the folder of the run it was made of")
    if (out / "curve.csv").is_file() and not (out / "summary.json").is_file():
        raise OutputError(f"{out}: this run has not ended, or was killed; run it (again)")
    try:
        with open(out / "curve.csv", newline="", encoding="utf-8") as file:
            rows: list[_Row] = list(csv.DictReader(file))
        summary = json.loads((out / "summary.json").read_text(encoding="utf-8"))
        with xr.open_dataset(out / "results.nc", engine="netcdf4") as stored:
            text = str(stored.attrs["case"])
        whole = len(rows) == summary["depths_computed"]
    except (OSError, ValueError, KeyError):
        raise OutputError(
            f"{out}: holds no results of a run; name the folder of -o of `restitution run`"
        ) from None
    if not whole:
        raise OutputError(
            f"{out}: curve.csv has {len(rows)} depths, and the run computed "
            f"{summary['depths_computed']}; the file is damaged: run the case again"
        )
    return rows, summary, text


def _error_is(rows: list[_Row], surfaces: int, rough: bool) -> str:
    """What the error of a point includes, and what it does not."""
    included = ["numerical error"]
    missing: list[str] = []
    (included if rows[0].get("discretisation_error") else missing).append("error of the grid")
    if rough:
        if surfaces > 1:
            included.append(f"95 % interval of the mean of {surfaces} surfaces")
        else:
            missing.append("scatter from one surface to another")
    return ", ".join(included) + (f"; not the {' or the '.join(missing)}" if missing else "")


def _points(rows: list[_Row]) -> list[Point]:
    found: list[Point] = []
    for row in rows:
        velocity, work = _number(row, "impact_velocity_m_per_s"), _number(row, "loading_work_J")
        if not velocity > 0 or not work > 0 or (found and velocity <= found[-1].velocity):
            continue
        pull_off = _number(row, "pull_off_force_N")
        found.append(
            Point(
                velocity=velocity,
                restitution=_number(row, "restitution"),
                error=_error(row),
                ratio=_ratio(row, work),
                loading_work=work,
                indentation=_number(row, "indentation_m"),
                force=_number(row, "force_N"),
                pull_off_force=None if math.isnan(pull_off) else pull_off,
                resolved=row["resolved"] == "true" and row["adhesion_resolved"] != "false",
            )
        )
    return found


def _ratio(row: _Row, work: float) -> float:
    """W_u/W_l; of an ensemble, whose columns are means each, e² where it rebounds."""
    ratio, e = _number(row, "unloading_work_J") / work, _number(row, "restitution")
    return e * e if "restitution_std" in row and e > 0 else ratio


def _error(row: _Row) -> float:
    """Numerical error, and what is known of the error of the grid and of the mean of surfaces."""
    error = _number(row, "restitution_error")
    grid = _number(row, "discretisation_error")
    error += 0.0 if math.isnan(grid) else grid
    if "restitution_low" in row:
        e = _number(row, "restitution")
        ends = (_number(row, "restitution_low"), _number(row, "restitution_high"))
        error += max([abs(end - e) for end in ends if not math.isnan(end)], default=0.0)
    return error


def _number(row: _Row, name: str) -> float:
    return float(row.get(name) or "nan")


def _particle(name: str, body: BodyTable) -> Particle:
    return Particle(
        name=body.material or name,
        radius=body.radius,
        youngs_modulus=body.youngs_modulus,
        poissons_ratio=body.poissons_ratio,
        density=body.density,
    )
