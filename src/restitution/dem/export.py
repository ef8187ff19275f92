"""Export laws as the input of a DEM code, or as one table."""

from __future__ import annotations

import math
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from types import ModuleType

from restitution.dem.export_common import unset_pairs
from restitution.dem.pair import pull_off_force
from restitution.dem.pair_table import PairTable, pair_table
from restitution.dem.units import NAMES, SI, units_of
from restitution.errors import CaseError, OutputError
from restitution.laws.law import Law
from restitution.laws.law_files import law_rows
from restitution.results.writer import replace_file, table_text, writing

ADHESIVE = ("lammps-adhesive", "liggghts-adhesive", "yade-adhesive")
"""Variants with adhesive contact models; at least one pair must have adhesion."""
CODES = (
    *("lammps", "liggghts", "yade", "mercurydpm", "edem", "kratos", "mujoco", "drake"),
    *ADHESIVE,
    *("c", "python", "csv"),
)
WHOLE = ("c", "python", "csv")
"""The codes whose files contain e at every computed velocity."""
IN_UNITS = ("lammps", "lammps-adhesive")
"""The codes with a choice of units."""
TABLE = "restitution.csv"
# Columns that have the same value at every velocity of a law.
_WHOLE = (
    "yield_velocity_smooth_m_per_s",
    "sticking_velocity_smooth_m_per_s",
    "sticks_below_m_per_s",
    "reduced_radius_m",
    "reduced_mass_kg",
    "contact_modulus_Pa",
    "yield_pressure_Pa",
    "yield_pressure_convention",
    "end_of_contact",
    "restitution_error_includes",
)


def export(
    laws: Sequence[Law],
    code: str,
    velocity: float | None,
    *,
    size: float = 1.0,
    units: str = SI.name,
) -> dict[str, str]:
    """The text of each input file of `code` (one of `CODES`) for the pairs of `laws`, by file name.

    All codes except `WHOLE` take one e for each pair, which holds at `velocity` (m/s). Particles
    are coarse-grained, `size` times as large as the computed ones. `units` (of `units.NAMES`) are
    those of the commands for `IN_UNITS`. Raises `CaseError` if the velocity or a law is missing, or
    if the code does not accept a value; `DomainError` for a velocity outside the computed ones.
    """
    _check(code, size, units)
    table = pair_table(laws, size)
    if code == "csv":
        return {TABLE: _table(table, velocity)}
    if velocity is None and code not in WHOLE:
        law = laws[0]
        raise CaseError(
            f"velocity: {code} takes one coefficient of restitution for each pair, valid at one "
            f'velocity; give this velocity with --velocity, from "{law.lowest:.3g} m/s" to '
            f'"{law.highest:.3g} m/s"'
        )
    system = units_of(units)
    given = () if system is SI else (system,)
    texts: dict[str, str] = _module(code).write(table, velocity, *given)
    return texts


def _check(code: str, size: float, units: str) -> None:
    if not (math.isfinite(size) and size > 0):
        raise CaseError(f"size: {size:g} is not a positive number, such as 10")
    if size != 1 and code == "csv":
        raise CaseError(
            "size: the table is that of the computed particles, which coarse-grained ones share; "
            "leave out --size"
        )
    if units != SI.name and units in NAMES and code not in IN_UNITS:
        raise CaseError(
            f"units: the files for {code} are in SI units, because only LAMMPS has others; leave "
            f"out --units, or use --to {' or '.join(IN_UNITS)}"
        )


def limit(code: str) -> str:
    """The conditions under which `code` returns the exported e; empty if there are none."""
    if code == "csv":
        return ""
    return str(getattr(_module(code), "NOTE", ""))


def unset(laws: Sequence[Law], code: str) -> list[str]:
    """The pairs of spheres without a law, and how the user gives `code` their e."""
    if code == "csv":
        return []
    module = _module(code)
    return unset_pairs(pair_table(laws), module.CODE, getattr(module, "SETTING", ""))


def write_export(texts: dict[str, str], out: Path) -> list[Path]:
    """Write `texts` (by file name) into `out`; nothing is overwritten. Raises `OutputError`."""
    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
        there = [name for name in texts if (out / name).exists()]
    if there:
        raise OutputError(
            f"{out / there[0]}: already exists and is not overwritten; name another folder with -o"
        )
    for name, text in texts.items():
        replace_file(out / name, lambda to, text=text: to.write_text(text, encoding="utf-8"))  # type: ignore[misc]
    return [out / name for name in texts]


def _module(code: str) -> ModuleType:
    return import_module(f"restitution.dem.codes.{code.replace('-', '_')}")


def _table(table: PairTable, velocity: float | None) -> str:
    rows: list[dict[str, float | str]] = []
    for i, j, law in table.pairs():
        pair: dict[str, float | str] = {
            "type_1": i,
            "type_2": j,
            "first": str(law.first),
            "second": str(law.second),
            "friction": math.nan if law.friction is None else law.friction,
        }
        points = law_rows(law)
        if velocity is None:
            rows += [pair | row for row in points]
        else:
            estimate = law.at(velocity)
            pair |= {
                "velocity_m_per_s": velocity,
                "restitution": estimate.restitution,
                "restitution_error": estimate.error,
                "resolved": estimate.resolved,
                "pull_off_force_N": pull_off_force(law, velocity),
            }
            rows.append(pair | {key: points[0][key] for key in _WHOLE})
    return table_text(rows)
