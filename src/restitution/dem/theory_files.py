"""Theories as a table and as lines."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from restitution.dem.closed_forms import FORMS
from restitution.dem.theories import COMPUTED, Theory, theories
from restitution.errors import OutputError
from restitution.studies.case import Case
from restitution.studies.results import write_table, writing

Array = NDArray[np.float64]

_FINE = 600  # points of a line


def write_theories(velocities: Array, found: list[Theory], out: Path) -> Path:
    """Write `theory.csv` into `out`, new or empty, and return it. Raises `OutputError`."""

    with writing(out):
        out.mkdir(parents=True, exist_ok=True)
        if any(out.iterdir()):
            raise OutputError(
                f"{out}: this folder is not empty, and nothing in it is overwritten; name another"
            )
    rows = [
        {"velocity_m_per_s": float(V), **{each.name: float(each.restitution[k]) for each in found}}
        for k, V in enumerate(velocities)
    ]
    write_table(out / "theory.csv", rows)
    return out / "theory.csv"


def theory_lines(
    case: Case, velocities: Array, found: list[Theory]
) -> list[tuple[str, bool, Array, Array]]:
    """Name, whether it is a fit, velocities (m/s) and COR of each theory, but for computed points.

    Closed forms are evaluated at many velocities, others stand as they are.
    """
    closed: dict[str, Array] = {}
    V = velocities
    if velocities.size > 1:
        V = np.geomspace(velocities[0], velocities[-1], _FINE)
        closed = {each.name: each.restitution for each in theories(case, V)}
    return [
        (each.name, each.name not in FORMS, V, closed[each.name])
        if each.name in closed
        else (each.name, each.name not in FORMS, velocities, each.restitution)
        for each in found
        if each.name != COMPUTED
    ]
