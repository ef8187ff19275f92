"""Write a script that matches the constant e of a DEM code to the velocities of a simulation."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from restitution.dem.export_common import Pair, render
from restitution.laws.law import Law

SCRIPT = "match_velocity.py"
_ROUNDS = 6  # largest number of runs of the simulation
_TOLERANCE = 0.005  # change of e below which the script stops
_SAMPLES = 4  # number of intervals of the exported table between two computed velocities


@dataclass(frozen=True)
class Target:
    """A DEM code, the command that runs it, and the files of its export.

    `fragment` is the exported file, `matched` the file with the matched e, and `lowest` the
    smallest e that the code accepts.
    """

    code: str
    command: str
    fragment: str
    matched: str
    lowest: float


def matching_script(target: Target, pairs: list[Pair], comments: str) -> str:
    """Make the text of `match_velocity.py` for the fragment of `target`."""
    return render(
        SCRIPT,
        comments=comments,
        code=target.code,
        command=target.command,
        fragment=target.fragment,
        matched=target.matched,
        lowest=target.lowest,
        pairs=pairs,
        points=lambda law: law_points(law, target.lowest),
        rounds=_ROUNDS,
        tolerance=_TOLERANCE,
    )


def law_points(law: Law, lowest: float) -> list[tuple[float, float]]:
    """Tabulate velocity (m/s) and e (at least `lowest`), finely enough for linear interpolation."""
    V = law.column("velocity")
    fine = np.interp(
        np.arange((V.size - 1) * _SAMPLES + 1) / _SAMPLES, np.arange(V.size), np.log(V)
    )
    return [(v, max(law.at(v).restitution, lowest)) for v in np.exp(fine).tolist()]
