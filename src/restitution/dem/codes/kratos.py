"""Kratos DEM: `DEM_D_Hertz_viscous_Coulomb` for each pair of materials.

Kratos computes the E* of a pair from the E and ν of its materials, also of the wall. In Kratos
10.4 this law returns the e that it is given, within 2e-4. `DEM_D_Linear_Simple_Coulomb` ignores e,
and the laws with JKR and DMT lose no energy by adhesion (evidence/codes).
"""

from __future__ import annotations

from restitution.dem.export_common import Export
from restitution.dem.pair_table import PairTable

CODE = "Kratos"
LOWEST = 0.05  # smallest e that was tried
MATERIALS, MODULE = "MaterialsDEM.json", "restitution_kratos.py"
COLLISION, PACKING = "collision_kratos.py", "packing_kratos.py"
SETTING = (
    "copy a relation in MaterialsDEM.json and change its types and its e. Kratos stops at the "
    "first contact of two types without a relation."
)
NOTE = (
    "Kratos: keep NeighbourSearchFrequency = 1 (restitution_kratos.py); with its default of 50 "
    "steps contacts begin too late, and 0.5 became 1.13 with 100 steps per contact."
)
_ENDS = (
    "the overlap is back to zero. The force is tensile shortly before, due to damping. Time step: "
    "1/50 of the elastic contact time returns 0.499 to 0.501 for 0.5, 1/10 returns 0.497 to 0.515."
)
_STEPS = 500  # number of time steps in the contact of the test collision
_PACKING_STEPS = 25
_GRAINS = 200


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Materials, settings, a test collision and a packing; names and texts.

    Raises `CaseError`, `DomainError`. There is no packing without laws between spheres or without
    a wall.
    """
    table.require_all(CODE)
    export = Export(table, velocity, CODE, LOWEST, _ENDS, setting=SETTING)
    files = {
        MATERIALS: export.render(MATERIALS, about=export.lines()),
        MODULE: export.render(MODULE, friction_note=export.friction_note("#")),
        COLLISION: export.render(COLLISION, steps=_STEPS),
    }
    if table.walls and not table.walls_only:
        files[PACKING] = export.render(
            PACKING,
            floor=len(table.spheres) + 1,
            count=_GRAINS,
            steps=_PACKING_STEPS,
        )
    return files | export.notes()
