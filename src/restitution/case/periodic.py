"""Which cases can be periodic."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

from restitution.case.roughness import GeneratedRoughness

if TYPE_CHECKING:
    from restitution.case.case import Case


def require_possible(case: Case) -> None:
    """Raise `ValueError` if `case`, whose grid is periodic, has a key that excludes this."""
    for name, body in (("first", case.first), ("second", case.second)):
        if body is not None and body.radius is not None:
            raise ValueError(f'{name}.radius: must be "flat" if the grid is periodic')
    if case.impact is not None:
        raise ValueError(
            "[impact]: the bodies of a periodic contact have no mass; give [indentation], [load] "
            "or [pressure]"
        )
    if "unloading" in case.model_fields_set:
        raise ValueError("[unloading]: a periodic case writes no unloading curves; leave it out")
    if case.interface.adhesive_energy > 0:
        raise ValueError("interface.work_of_adhesion: a periodic contact has no adhesion")
    yielding = case.yielding()
    if yielding.plasticity != "equilibrium":
        raise ValueError(
            "interface.yield_pressure: is missing; a periodic contact needs a constant pressure "
            '(such as "2.8 Y" or "hardness"), or "elastic"'
        )
    assert case.grid is not None  # it is periodic
    if not isinstance(case.grid.refine, int):
        raise ValueError("grid.refine: must be one number if the grid is periodic")
    if not case.roughness:
        raise ValueError("roughness: is missing; two flat bodies without it touch everywhere")
    if case.realisations > 1:
        raise ValueError("roughness.realisations: a periodic case has one surface; leave it out")
    for part in case.roughness:
        if isinstance(part, GeneratedRoughness) and not part.periodic:
            raise ValueError("roughness.periodic: must be true if the grid is periodic")
    series = case.pressure
    if series is not None and math.isfinite(yielding.hardness):
        highest = max(series.series())
        if highest >= yielding.hardness:
            raise ValueError(
                f"pressure: {1e-6 * highest:.4g} MPa is not below the yield pressure, "
                f"{1e-6 * yielding.hardness:.4g} MPa"
            )
