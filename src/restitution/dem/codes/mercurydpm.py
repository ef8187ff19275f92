"""MercuryDPM: a `HertzianViscoelasticMindlinSpecies` for each type and for each pair of types.

`setEffectiveElasticModulusAndRestitutionCoefficient(E*, e)` takes the contact modulus E* and
converts e to the damping of Antypov & Elliott (EPL 94 (2011) 50004). Force and damping act until
the overlap is zero, so the force is tensile at the end of the contact. This description follows the
sources of MercuryDPM; the export was not tested in MercuryDPM.
"""

from __future__ import annotations

from restitution.dem.export_common import FRICTION, Export, commented
from restitution.dem.friction import friction_note
from restitution.dem.pair_table import PairTable

CODE = "MercuryDPM"
FILE = "restitution_mercury.h"
_ENDS = "the overlap is back to zero. The force is tensile shortly before, due to damping."


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Write a header to include; return its name and text. Raises `CaseError`, `DomainError`."""
    table.require_all(CODE)
    export = Export(table, velocity, CODE, 0.0, _ENDS)
    return {
        FILE: export.render(
            FILE,
            commented(export.header(), "//"),
            friction_note=friction_note(export.pairs, "//"),
            placeholder=FRICTION,
            alike=[pair for pair in export.pairs if pair.i == pair.j],
            unlike=[pair for pair in export.pairs if pair.i != pair.j],
        )
    }
