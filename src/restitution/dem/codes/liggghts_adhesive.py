"""LIGGGHTS: `hertz` with the cohesion `sjkr` of the computed pull-off force, and damping for e.

`sjkr` adds the attraction k A to Hertz's force, where k is `cohesionEnergyDensity` and A = 2 pi R*
delta is the area of the overlap. The force is smallest at a small overlap, where it is the pull-off
force, and loses no energy by itself: sticking comes from the damping alone. The export fits the
parameter `coefficientRestitution` so that e and sticking are closest to the law, and states how far
they are off.
"""

from __future__ import annotations

import math

from restitution.dem.codes.liggghts import CODE, LOWEST, SETTING, by_types, inputs
from restitution.dem.damped_adhesion import (
    area_model,
    area_slope,
    fit_damping,
    known_pull_off,
    misfit,
    require_adhesion,
)
from restitution.dem.export_common import Export
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, number, wrapped

# Measured with lactose of 2 um from 1.2 times its sticking velocity on.
_ACCURACY = "Then e is within 0.01 of that with smaller steps."
_ENDS = "the overlap is back to zero. The force is tensile before, due to cohesion and damping."


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The input files; names and texts. Raises `CaseError` and `DomainError`."""
    table.require_all(CODE)
    require_adhesion(table.laws.values(), "liggghts")
    export = Export(
        table,
        velocity,
        CODE,
        0.0,
        _ENDS,
        constant=False,
        setting=SETTING,
        adhesive=True,
        accuracy=_ACCURACY,
    )
    given, densities, said = {}, {}, []
    for pair in export.pairs:
        i, j, law = pair.i, pair.j, pair.law
        if law.work_of_adhesion == 0:
            given[i, j], densities[i, j] = max(pair.restitution, LOWEST), 0.0
            continue
        force = known_pull_off(law, velocity)
        fit = fit_damping(area_model(law, force, LOWEST), law, force)
        s = fit.strength
        given[i, j] = max(math.exp(-math.pi * s / math.sqrt(1 - s**2)), LOWEST)
        densities[i, j] = area_slope(law, force) / (2 * math.pi * law.radius)
        said.append(f"Pair {i} {j}: {misfit(fit, law)}.")
    values = {
        "cohesion": " cohesion sjkr",
        "densities": by_types(table, export.pairs, lambda p: number(densities[p.i, p.j]), "0", "0"),
        "misfits": commented(wrapped(said), "#"),
    }
    return inputs(export, given, values) | export.notes()
