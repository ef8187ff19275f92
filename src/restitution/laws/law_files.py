"""Read and write restitution laws: `law.json`, with the tables `table.csv` and `laws.csv`."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from pydantic import ValidationError

from restitution.errors import CaseError, OutputError, first_problem
from restitution.laws.law import QUANTILES, STORED_LAW, Law, LawPoint
from restitution.losses.losses import NAMES
from restitution.results.checksums import check_file
from restitution.results.interruption import hold_signals
from restitution.results.writer import make_folder, replace_file, write_checksums, write_table

LAW_FILE = "law.json"
# In the folder of a mixture: the folder of its laws, and a copy of the input file.
LAWS, MIXTURE_FILE = "laws", "mixture.toml"


def write_law(law: Law, out: Path) -> list[Path]:
    """Write `law` into `out`, which must be new or empty. Raises `OutputError`."""
    make_folder(out)
    text = STORED_LAW.dump_json(law, indent=2).decode() + "\n"
    names = [LAW_FILE, "table.csv"]
    with hold_signals():
        replace_file(out / LAW_FILE, lambda to: to.write_text(text, encoding="utf-8"))
        write_table(out / "table.csv", law_rows(law))
        if law.laws:
            write_table(out / "laws.csv", _laws(law))
            names.append("laws.csv")
        write_checksums(out, names)
    return [out / name for name in names]


def read_law(folder: Path) -> Law:
    """Read a law from a folder of `restitution fit-law`, or from its file `law.json`.

    Raises `OutputError` if there is none or its checksum differs, and `CaseError` if the file is
    not a law of this version.
    """
    path = folder / LAW_FILE if folder.is_dir() else folder
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError):
        raise OutputError(
            f"{folder}: holds no law ({LAW_FILE}); give the folder that `restitution fit-law` wrote"
        ) from None
    check_file(path)
    try:
        return STORED_LAW.validate_json(text)
    except ValidationError as error:
        raise CaseError(
            f"{path}: is not a law of this version ({first_problem(error)}); run `restitution "
            "fit-law` again"
        ) from None


def read_laws(folders: Sequence[Path]) -> list[Law]:
    """Read the law of each `fit-law` folder, and all laws of each mixture folder."""
    laws: list[Law] = []
    for folder in folders:
        laws += map(read_law, _of_mixture(folder) if is_mixture(folder) else [folder])
    return laws


def is_mixture(folder: Path) -> bool:
    """Whether `folder` is the folder of a mixture, even of an incomplete one."""
    return (folder / MIXTURE_FILE).is_file()


def _of_mixture(folder: Path) -> list[Path]:
    if not (folder / LAWS).is_dir() or not (folder / "summary.json").is_file():
        raise OutputError(
            f"{folder}: the mixture is not complete; finish it with `restitution mixture MIXTURE "
            f"-o {folder} --resume`"
        )
    return sorted((folder / LAWS).iterdir())


def law_rows(law: Law) -> list[dict[str, float | str]]:
    """A table row for each point of `law`; every row repeats the values of the whole law."""
    V = law.column("velocity")
    fit = np.full(V.shape, math.nan) if law.fit is None else law.fit.restitution(V)
    return [
        {
            "velocity_m_per_s": point.velocity,
            "restitution": point.restitution,
            "restitution_error": point.error,
            "restitution_error_includes": law.conventions.restitution_error,
            "resolved": point.resolved,
            "quasi_static_restitution": _or_nan(point.quasi_static),
            **{f"{name}_factor": point.factors.get(name, math.nan) for name in NAMES},
            **_distribution(point),
            "compact_fit": fitted,
            "compact_fit_error": abs(fitted - point.restitution),
            "loading_work_J": point.loading_work,
            "max_indentation_m": point.indentation,
            "largest_force_N": point.force,
            "pull_off_force_N": _or_nan(point.pull_off_force),
            "pull_off_error_N": _or_nan(point.pull_off_error),
            "yield_velocity_smooth_m_per_s": _or_nan(law.yield_velocity),
            "sticking_velocity_smooth_m_per_s": _or_nan(law.smooth_sticking_velocity),
            "sticks_below_m_per_s": _or_nan(law.sticks_below),
            "sticks_below_error_m_per_s": _or_nan(law.sticks_below_error),
            "reduced_radius_m": law.radius,
            "reduced_mass_kg": law.mass,
            "contact_modulus_Pa": law.contact_modulus,
            "yield_pressure_Pa": _or_nan(law.yield_pressure),
            "yield_pressure_convention": law.conventions.yield_pressure,
            "end_of_contact": law.conventions.end_of_contact,
        }
        for point, fitted in zip(law.points, fit.tolist(), strict=True)
    ]


def _distribution(point: LawPoint) -> dict[str, float]:
    """The distribution of COR over places; no columns if it is unknown."""
    if point.deviation is None or point.quantiles is None:
        return {}
    return {"restitution_std": point.deviation} | {
        f"restitution_{q}": value for q, value in zip(QUANTILES, point.quantiles, strict=True)
    }


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
