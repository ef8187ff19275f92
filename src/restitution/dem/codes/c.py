"""C (C99, C++17): the whole law as a contact of one header (docs/any-code.md).

The force follows the stored loading curve, and an unloading curve F = (F_m + F_c) sⁿ − F_c with s
from 1 at the largest indentation to 0 at separation, whose exponent gives the work that the law
returns. A leapfrog with the forces F_k at the indentations δ_k does exactly the work
Σ ½(F_k + F_k₊₁)(δ_k₊₁ − δ_k) on the bodies. The contact adds up this sum, so it knows the energy of
the impact without the masses, loses the part that the law loses, and returns no more than the rest,
with any time step.
"""

from __future__ import annotations

import math
from typing import Any

from restitution.dem.contact_table import contact_table
from restitution.dem.export_common import Export
from restitution.dem.pair import STIFFNESS_SHARE
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, wrapped

CODE = "C"
HEADER, DRIVER = "restitution_contact.h", "collide.c"
ENDS = "the force is back to zero; with adhesion, after pull-off."
NOTES = (
    "Leapfrog, velocity Verlet or symplectic Euler must move the bodies.",
    "Below the computed velocities a dry pair has the e of the lowest one, and a pair with "
    "adhesion loses the energy that it loses there; above them e is that of the highest one. "
    "`outside` of the contact is then -1 or 1.",
)
TANGENTIAL = (
    f"The tangential stiffness is {STIFFNESS_SHARE} times that of a contact that sticks, because "
    "the edge of a contact slides first (docs/oblique.md)."
)


def write(table: PairTable, velocity: float | None) -> dict[str, str]:
    """The header, its driver and notes; names and texts. Raises `CaseError`, `DomainError`."""
    export = portable(table, velocity, CODE)
    shared = contents(export, "//")
    return {
        HEADER: export.render(HEADER, "//", **shared),
        DRIVER: export.render(DRIVER, "//"),
    } | export.notes()


def portable(table: PairTable, velocity: float | None, code: str) -> Export:
    """An export of whole laws; without `velocity`, the driver has one from their middle."""
    if velocity is None:
        laws = table.laws.values()
        low, high = max(law.lowest for law in laws), min(law.highest for law in laws)
        velocity = math.sqrt(low * high)
    return Export(
        table,
        velocity,
        code,
        0.0,
        ENDS,
        whole=True,
        adhesive=True,
        steps=20,
        accuracy="In a contact, e is within 0.5 % of the law with 20 or more steps.",
    )


def contents(export: Export, sign: str) -> dict[str, Any]:
    """What both portable templates are filled with; comments begin with `sign`."""
    return {
        "pairs_and_tables": [(pair, contact_table(pair.law)) for pair in export.pairs],
        "share": STIFFNESS_SHARE,
        "notes": commented(wrapped(NOTES), sign),
        "friction_note": export.friction_note(sign, TANGENTIAL),
    }
