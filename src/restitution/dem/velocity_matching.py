"""Write a script that finds one constant COR e for each pair of types in a DEM simulation.

The script runs the simulation, reads the impact velocities, and takes e from the laws.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from restitution.dem.export_common import Export
from restitution.laws.law import Law

SCRIPT = "match_velocity.py"
_ROUNDS = 6  # largest number of runs of the simulation
_TOLERANCE = 0.005  # change of e below which the script stops
_SAMPLES = 4  # number of table intervals between two neighbouring computed velocities


def matching_script(export: Export, command: str, fragment: str, matched: str) -> str:
    """Make the text of the script `match_velocity.py`, which belongs to `export`.

    `command` is the command that runs the code. `fragment` is the name of the exported file with
    the pairs, and `matched` is the name of the file that the script writes.
    """
    return export.render(
        SCRIPT,
        code=export.code,
        command=command,
        fragment=fragment,
        matched=matched,
        lowest=export.lowest,
        points=partial(law_points, lowest=export.lowest),
        rounds=_ROUNDS,
        tolerance=_TOLERANCE,
    )


def law_points(law: Law, lowest: float) -> list[tuple[float, float]]:
    """Tabulate e of `law` against velocity (m/s), finely enough for linear interpolation.

    Values of e below `lowest` are replaced by `lowest`.
    """
    V = law.column("velocity")
    fine = np.interp(
        np.arange((V.size - 1) * _SAMPLES + 1) / _SAMPLES, np.arange(V.size), np.log(V)
    )
    return [(v, max(law.at(v).restitution, lowest)) for v in np.exp(fine).tolist()]
