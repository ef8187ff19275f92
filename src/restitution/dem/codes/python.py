"""Python (NumPy, also JAX and Numba): the contact of the export to C, on arrays of contacts."""

from __future__ import annotations

from restitution.dem.codes.c import contents, portable
from restitution.dem.pair_table import PairTable

CODE = "Python"
MODULE, DRIVER = "restitution_contact.py", "collide.py"


def write(table: PairTable, velocity: float | None) -> dict[str, str]:
    """The module, its driver and notes; names and texts. Raises `CaseError`, `DomainError`."""
    export = portable(table, velocity, CODE)
    return {
        MODULE: export.render(MODULE, **contents(export, "#")),
        DRIVER: export.render(DRIVER),
    } | export.notes()
