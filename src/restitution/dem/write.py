"""A law as files: `law.json` (all of it), `table.csv` and `laws.csv`."""

from __future__ import annotations

import math
from pathlib import Path

from restitution.dem.law import LAW_FILE, Law
from restitution.errors import OutputError
from restitution.studies.interruption import hold_signals
from restitution.studies.results import replace_file, write_checksums, write_table, writing


def write_law(law: Law, out: Path) -> list[Path]:
    """Write every file of `law` into `out`, which must be new or empty. Raises `OutputError`."""
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
        if any(out.iterdir()):
            raise OutputError(
                f"{out}: this folder is not empty, and nothing in it is overwritten; name another"
            )
    text = law.model_dump_json(indent=2) + "\n"
    names = [LAW_FILE, "table.csv"]
    with hold_signals():
        replace_file(out / LAW_FILE, lambda to: to.write_text(text, encoding="utf-8"))
        write_table(out / "table.csv", table(law))
        if law.laws:
            write_table(out / "laws.csv", _laws(law))
            names.append("laws.csv")
        write_checksums(out, names)
    return [out / name for name in names]


def table(law: Law) -> list[dict[str, float | str]]:
    """The points, with what belongs to the whole law in every row, so that a row stands alone."""
    fit = [math.nan] * len(law.points)
    if law.fit is not None:
        fit = [float(e) for e in law.fit.restitution(law.column("velocity"))]
    return [
        {
            "velocity_m_per_s": point.velocity,
            "restitution": point.restitution,
            "restitution_error": point.error,
            "restitution_error_is": law.conventions.restitution_error,
            "resolved": point.resolved,
            "compact_fit": fitted,
            "compact_fit_error": abs(fitted - point.restitution),
            "loading_work_J": point.loading_work,
            "indentation_m": point.indentation,
            "largest_force_N": point.force,
            "pull_off_force_N": _or_nan(point.pull_off_force),
            "yield_velocity_smooth_m_per_s": _or_nan(law.yield_velocity),
            "sticking_velocity_smooth_m_per_s": _or_nan(law.sticking_velocity),
            "sticks_below_m_per_s": _or_nan(law.sticks_below),
            "reduced_radius_m": law.radius,
            "reduced_mass_kg": law.mass,
            "contact_modulus_Pa": law.contact_modulus,
            "yield_pressure_Pa": _or_nan(law.yield_pressure),
            "yield_pressure_is": law.conventions.yield_pressure,
            "end_of_contact": law.conventions.end_of_contact,
        }
        for point, fitted in zip(law.points, fit, strict=True)
    ]


def _laws(law: Law) -> list[dict[str, float | str]]:
    return [
        {
            "velocity_m_per_s": point.velocity,
            "restitution": point.restitution,
            "restitution_error": point.error,
            **{other.name: _or_nan(other.restitution[k]) for other in law.laws},
        }
        for k, point in enumerate(law.points)
    ]


def _or_nan(value: float | None) -> float:
    return math.nan if value is None else value
