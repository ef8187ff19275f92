"""MercuryDPM: `HertzianViscoelasticMindlinSpecies`, one for each type and one for each pair.

`setEffectiveElasticModulusAndRestitutionCoefficient(E*, e)` takes the modulus of the contact and
turns e into the damping of Antypov & Elliott (EPL 94 (2011) 50004); force and damping go on to
δ = 0, with a tension at the end (its sources, read; nothing was run).
"""

from __future__ import annotations

from restitution.dem.export_common import (
    FRICTION,
    PLACEHOLDER,
    Pair,
    commented,
    density_of,
    header,
    identifier,
    number,
    pairs_at,
)
from restitution.dem.pair_table import PairTable
from restitution.laws.law import Particle

CODE = "MercuryDPM"
FILE = "restitution_mercury.h"
_ENDS = "the overlap is back to zero. The damping pulls shortly before."
_WALL_DENSITY = 1000.0  # of a wall without a density in the case

_BEFORE = """
// Not compiled or run with MercuryDPM here: its sources were read. It needs a release that has
// setEffectiveElasticModulusAndRestitutionCoefficient; the older one without Effective means
// another modulus.
// {placeholder}
// Use, in setupInitialConditions: auto species = addRestitutionSpecies(*this);
// species[k - 1] is type k, for setSpecies of particles and walls.
#ifndef RESTITUTION_MERCURY_H
#define RESTITUTION_MERCURY_H

#include <array>

#include "DPMBase.h"
#include "Species/HertzianViscoelasticMindlinSpecies.h"

template <typename S>
void setRestitution(S& species, Mdouble modulus, Mdouble shearModulus, Mdouble restitution)
{{
    species.setEffectiveElasticModulusAndRestitutionCoefficient(modulus, restitution);
    species.setEffectiveShearModulus(shearModulus);
    species.setSlidingFrictionCoefficient({friction});
}}

inline std::array<HertzianViscoelasticMindlinSpecies*, {count}> addRestitutionSpecies(DPMBase& dpm)
{{
    std::array<HertzianViscoelasticMindlinSpecies*, {count}> species;
    HertzianViscoelasticMindlinSpecies type;
"""

_AFTER = """    return species;
}

#endif
"""


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The header to include, as text by file name. Raises `CaseError`, `DomainError`."""
    table.require_all(CODE)
    pairs = pairs_at(table, velocity, CODE, 0.0)
    head = header(table, pairs, velocity, code=CODE, ends=_ENDS)
    own = {pair.i: pair for pair in pairs if pair.i == pair.j}
    lines = [
        line
        for k, body in enumerate(table.particles, 1)
        for line in (_wall(k, body) if body.wall else _sphere(k, own[k]))
    ]
    lines += [_mixed(pair) for pair in pairs if pair.i != pair.j]
    before = _BEFORE.format(placeholder=PLACEHOLDER, friction=FRICTION, count=len(table.particles))
    code = "".join(f"    {line}\n" for line in lines)
    return {FILE: commented(head, "//") + before + code + _AFTER}


def _sphere(k: int, pair: Pair) -> list[str]:
    return [
        f"// type {k}: {identifier(pair.first, k)}",
        f"type.setDensity({number(density_of(pair.first))});",
        f"setRestitution(type, {_values(pair)});",
        f"species[{k - 1}] = dpm.speciesHandler.copyAndAddObject(type);",
    ]


def _wall(k: int, body: Particle) -> list[str]:
    E, nu = body.youngs_modulus, body.poissons_ratio
    own = f"{number(E / (2 * (1 - nu**2)))}, {number(E / (4 * (2 - nu) * (1 + nu)))}, 1.0"
    return [
        f"// type {k}: {identifier(body, k)}, a wall; "
        + ("e without meaning" if body.density else "density and e without meaning"),
        f"type.setDensity({number(body.density or _WALL_DENSITY)});",
        f"setRestitution(type, {own});",
        f"species[{k - 1}] = dpm.speciesHandler.copyAndAddObject(type);",
    ]


def _mixed(pair: Pair) -> str:
    mixed = f"*dpm.speciesHandler.getMixedObject(species[{pair.i - 1}], species[{pair.j - 1}])"
    return f"setRestitution({mixed}, {_values(pair)});"


def _values(pair: Pair) -> str:
    values = pair.law.contact_modulus, pair.shear_modulus, pair.restitution
    return ", ".join(map(number, values))
