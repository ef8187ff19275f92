"""MercuryDPM: a `HertzianViscoelasticMindlinSpecies` for each type and for each pair of types.

`setEffectiveElasticModulusAndRestitutionCoefficient(E*, e)` takes the contact modulus E* and
converts e to the damping of Antypov & Elliott (EPL 94 (2011) 50004). Force and damping act until
the overlap is zero, so the force is tensile at the end of the contact. This description follows the
sources of MercuryDPM; the export was not tested in MercuryDPM.

`LinearPlasticViscoelasticFrictionSpecies` is the law of Luding (2008), with adhesion. If it was
fitted to all laws, a second header has it: its e depends on the velocity, and contacts pull.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.export_common import NOT_RUN, Export
from restitution.dem.own_laws import OwnLaw, constant, fitted
from restitution.dem.pair import FRICTION, ExportedPair, shear_modulus
from restitution.dem.pair_table import PairTable
from restitution.dem.text import commented, number, wrapped

CODE = "MercuryDPM"
SETTING = (
    "give it as an argument of addRestitutionSpecies, NAMES. Friction of these pairs is "
    f"{FRICTION}, a placeholder."
)
FILE, PLASTIC = "restitution_mercury.h", "restitution_mercury_plastic.h"
_LAW = "luding"
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
    export = Export(
        table,
        velocity,
        CODE,
        0.0,
        _ENDS,
        setting=SETTING,
        accuracy=NOT_RUN.format(CODE),
        own=own_laws,
    )
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
        ),
        **_plastic(export),
        **export.notes(),
    }


def _plastic(export: Export) -> dict[str, str]:
    """The header of plastic species, if all pairs have their fit."""
    table, pairs = export.table, export.pairs
    if table.walls_only or any(pair.fitted(_LAW) is None for pair in pairs):
        return {}
    # Walls never touch each other: they take the values of their first pair.
    first = [
        next(p for p in pairs if k in (p.i, p.j) and (p.i == p.j or k > len(table.spheres)))
        for k in range(1, len(table.particles) + 1)
    ]
    said = []
    for pair in pairs:
        fit = pair.fitted(_LAW)
        if fit is not None:
            note = f"; {fit.note}" if fit.note else ""
            stiffest = fit.parameters["limit_stiffness_N_per_m"]
            step = math.pi * math.sqrt(pair.law.mass / stiffest) / 50
            said.append(
                f"Pair {pair.i} {pair.j}: e(V) is off by up to {fit.worst:.2g}{note}; it "
                f"needs time steps of at most {step:.2g} s, 1/50 of pi (m*/k2)^(1/2)."
            )
    return {
        PLASTIC: export.render(
            PLASTIC,
            "//",
            own=first,
            unlike=[pair for pair in pairs if pair.i != pair.j],
            misfits=commented(wrapped(said), "//"),
            friction_note=export.friction_note("//"),
        )
    }


def own_laws(pair: ExportedPair) -> list[OwnLaw]:
    """The laws e(V) that MercuryDPM has for `pair`."""
    return [*constant(pair), *fitted(pair, _LAW, PLASTIC)]


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
