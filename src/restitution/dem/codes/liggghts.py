"""LIGGGHTS: `pair_style gran model hertz tangential history`.

Each property is given for every type or for every pair of types; walls are types, too. LIGGGHTS
computes the E* of a pair from the E and ν of its two types. So the types get the E and ν of the
materials, and E*, m* and R* agree with the law. Force and damping (Tsuji's form with the
coefficient of Antypov & Elliott) act until the overlap is zero. The force is therefore tensile at
the end of the contact. The option `limitForce on` would cut off this tension.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from restitution.dem.export_common import SCRIPT, STEPS, Export
from restitution.dem.pair import FRICTION, ExportedPair
from restitution.dem.pair_table import PairTable
from restitution.dem.text import number

CODE = "LIGGGHTS"
LOWEST = 0.0501  # LIGGGHTS stops with "0.05 < coefficientRestitution <= 1 required"
FRAGMENT, COLLISION = "restitution.liggghts", "collision.in.liggghts"
_ENDS = (
    "the overlap is back to zero. The force is tensile shortly before, due to damping; do not add "
    "`limitForce on`, which cuts off the tension and raises e (from 0.3 to 0.397)."
)
_TANGENTIAL = (
    "LIGGGHTS uses the full tangential stiffness of a contact that sticks. Impacts "
    "that slide are exact, but impacts that stick return too much tangential velocity "
    "(docs/oblique.md)."
)
SETTING = (
    "define NAMES, such as `variable e_1_1 index 0.9`, before you include this file (otherwise "
    f"LIGGGHTS stops). Friction of these pairs is {FRICTION}, a placeholder."
)
# Upper and lower limit of E (Pa). LIGGGHTS needs an additional command to accept other values.
_HARD, _SOFT = 1e9, 5e6


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The input files for LIGGGHTS; names and texts. Raises `CaseError`, `DomainError`."""
    table.require_all(CODE)
    export = Export(table, velocity, CODE, LOWEST, _ENDS, setting=SETTING)
    given = {(p.i, p.j): p.restitution for p in export.pairs}
    files = inputs(export, given, {"cohesion": ""})
    script = export.matching_script("liggghts -in my.in", FRAGMENT, "matched.liggghts")
    return files | {SCRIPT: script} | export.notes()


def inputs(
    export: Export, given: Mapping[tuple[int, int], float], values: Mapping[str, Any]
) -> dict[str, str]:
    """The pairs, with the coefficients of restitution `given` to LIGGGHTS, and the collision.

    `values` go to both templates; `cohesion` among them is the cohesion model, or empty.
    """
    table, pairs = export.table, export.pairs
    unset = table.missing_spheres()
    return {
        FRAGMENT: export.render(
            FRAGMENT,
            given=given,
            **values,
            hardness=_hardness(table),
            restitution=by_types(
                table, pairs, lambda p: f"${{e_{p.i}_{p.j}}}", "1", "${{e_{}_{}}}"
            ),
            friction=by_types(
                table, pairs, lambda p: number(p.friction), number(FRICTION), number(FRICTION)
            ),
            friction_note=export.friction_note("#", _TANGENTIAL),
        ),
        COLLISION: export.render(
            COLLISION,
            **values,
            fragment=FRAGMENT,
            unset=unset,
            size=table.largest_radius,
            steps=STEPS,
            hardness=_hardness(table),
        ),
    }


def _hardness(table: PairTable) -> str:
    E = [body.youngs_modulus for body in table.particles]
    if max(E) > _HARD:
        return "hard_particles yes"
    return "soft_particles yes" if min(E) < _SOFT else ""


def by_types(
    table: PairTable,
    pairs: list[ExportedPair],
    entry: Callable[[ExportedPair], str],
    walls: str,
    spheres: str,
) -> list[list[str]]:
    """A symmetric matrix over all types, with `entry` of each pair and `walls` for pairs of walls.

    `spheres` is the text for a pair of spheres that has no law, with braces for its types.
    """
    known = {(p.i, p.j): entry(p) for p in pairs}
    known |= {(i, j): spheres.format(i, j) for i, j in table.missing_spheres()}
    numbers = range(1, len(table.particles) + 1)
    return [[known.get((min(i, j), max(i, j)), walls) for j in numbers] for i in numbers]
