"""MercuryDPM: a `HertzianViscoelasticMindlinSpecies` for each type and for each pair of types.

`setEffectiveElasticModulusAndRestitutionCoefficient(E*, e)` takes the contact modulus E* and
converts e to the damping of Antypov & Elliott (EPL 94 (2011) 50004). Force and damping act until
the overlap is zero, so the force is tensile at the end of the contact. This description follows the
sources of MercuryDPM; the export was not tested in MercuryDPM.
"""

from __future__ import annotations

from dataclasses import dataclass

from restitution.dem.export_common import Export, number
from restitution.dem.pair import FRICTION, shear_modulus
from restitution.dem.pair_table import PairTable

CODE = "MercuryDPM"
SETTING = (
    "give it as an argument of addRestitutionSpecies, NAMES. Friction of these pairs is "
    f"{FRICTION}, a placeholder."
)
FILE = "restitution_mercury.h"
_ENDS = "the overlap is back to zero. The force is tensile shortly before, due to damping."


@dataclass(frozen=True)
class _Values:
    """E* and G* (Pa), e (a number or a name) and friction of the pair of types `i` ≤ `j`."""

    i: int
    j: int
    contact_modulus: float
    shear_modulus: float
    restitution: str
    friction: float


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """Notes and a header to include; names and texts. Raises `CaseError`, `DomainError`."""
    table.require_all(CODE)
    export = Export(table, velocity, CODE, 0.0, _ENDS, setting=SETTING)
    unset = table.missing_spheres()
    values = sorted([*_known(export), *(_unset(table, i, j) for i, j in unset)], key=_types)
    return {
        FILE: export.render(
            FILE,
            "//",
            friction_note=export.friction_note("//"),
            placeholder=FRICTION,
            unset=unset,
            alike=[pair for pair in values if pair.i == pair.j],
            unlike=[pair for pair in values if pair.i != pair.j],
        )
    } | export.notes()


def _known(export: Export) -> list[_Values]:
    return [
        _Values(
            pair.i,
            pair.j,
            pair.law.contact_modulus,
            pair.shear_modulus,
            number(pair.restitution),
            pair.friction,
        )
        for pair in export.pairs
    ]


def _unset(table: PairTable, i: int, j: int) -> _Values:
    bodies = table.particles[i - 1], table.particles[j - 1]
    E = 1 / sum((1 - body.poissons_ratio**2) / body.youngs_modulus for body in bodies)
    return _Values(i, j, E, shear_modulus(*bodies), f"e_{i}_{j}", FRICTION)


def _types(pair: _Values) -> tuple[int, int]:
    return pair.i, pair.j
