"""LIGGGHTS: `pair_style gran model hertz tangential history`, properties by type and pair of types.

LIGGGHTS makes E* of a pair from the E and ν of its types, walls included, so those are the
materials' own; m* and R* are the law's. Force and damping (Tsuji's form, with the coefficient of
Antypov & Elliott) go on to δ = 0, with a tension at the end; `limitForce on` would cut it off.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable

from restitution.dem.export_common import (
    FRICTION,
    PLACEHOLDER,
    STEPS,
    TIME_STEP,
    Pair,
    commented,
    contact_time,
    density_of,
    header,
    number,
    pairs_at,
    summary,
)
from restitution.dem.pair_table import PairTable

CODE = "LIGGGHTS"
LOWEST = 0.0501  # "0.05 < coefficientRestitution <= 1 required"
FRAGMENT, COLLISION = "restitution.liggghts", "collision.in.liggghts"
_ENDS = (
    "the overlap is back to zero. The damping pulls shortly before; do not add `limitForce on`, "
    "which cuts that off and raises e (0.397 for 0.3)."
)
_HARD, _SOFT = 1e9, 5e6  # Pa; LIGGGHTS refuses E beyond unless told


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The fragment to include and a collision that shows its e, as texts by file name.

    Raises `CaseError`, `DomainError`.
    """
    table.require_all(CODE)
    pairs = pairs_at(table, velocity, CODE, LOWEST)
    head = header(table, pairs, velocity, code=CODE, ends=_ENDS)
    short = summary(pairs, velocity, code=CODE, ends=_ENDS, fragment=FRAGMENT)
    return {
        FRAGMENT: commented(head, "#") + _fragment(table, pairs),
        COLLISION: commented(short, "#") + _collision(table, pairs, velocity),
    }


def _fragment(table: PairTable, pairs: list[Pair]) -> str:
    bodies = table.particles
    e = {(p.i, p.j): p.restitution for p in pairs}
    walls = [
        "# Walls are types, too: "
        + ", ".join(str(k) for k, b in enumerate(table.particles, 1) if b.wall),
        "#   fix floor all wall/gran model hertz tangential history primitive type K zplane 0.0",
        "# Walls do not meet each other: their coefficient below is a 1 without meaning.",
    ]
    lines = [
        "",
        f"# To include after create_box with {len(bodies)} types (a particle of type 1 must",
        "# exist), `units si`, `atom_style granular`, `newton off`"
        + (f" and `{_range(table)}`." if _range(table) else "."),
        f"# {PLACEHOLDER}",
        *(walls if table.walls else ()),
        _property("youngsModulus peratomtype", (number(b.youngs_modulus) for b in bodies)),
        _property("poissonsRatio peratomtype", (number(b.poissons_ratio) for b in bodies)),
        _table(table, "coefficientRestitution", lambda i, j: number(e.get((i, j), 1.0))),
        _table(table, "coefficientFriction", lambda i, j: str(FRICTION)),
        "pair_style gran model hertz tangential history",
        "pair_coeff * *",
    ]
    return "\n".join(lines) + "\n"


def _range(table: PairTable) -> str:
    """The command that lets LIGGGHTS take these E, "" where it needs none."""
    E = [body.youngs_modulus for body in table.particles]
    if max(E) > _HARD:
        return "hard_particles yes"
    return "soft_particles yes" if min(E) < _SOFT else ""


def _property(what: str, values: Iterable[str]) -> str:
    return f"fix {what.split()[0]} all property/global {what} {' '.join(values)}"


def _table(table: PairTable, what: str, value: Callable[[int, int], str]) -> str:
    numbers = range(1, len(table.particles) + 1)
    rows = [" ".join(value(min(i, j), max(i, j)) for j in numbers) for i in numbers]
    return " &\n  ".join(
        [f"fix {what} all property/global {what} peratomtypepair {len(rows)}", *rows]
    )


def _collision(table: PairTable, pairs: list[Pair], velocity: float) -> str:
    count = len(table.spheres)
    size = max(body.radius or 0.0 for body in table.spheres)
    bodies = list(enumerate(table.particles, 1))
    lines = [
        "",
        "# One head-on collision of types I and J, I <= J"
        + (f"; J from {count + 1} on is a wall:" if table.walls else ":"),
        f"#   liggghts -in {COLLISION} -var V {number(velocity)} -var I {pairs[0].i} "
        f"-var J {pairs[0].j}",
        f"# Time step: 1/{STEPS} of {TIME_STEP}.",
        f"variable V index {number(velocity)}",
        f"variable I index {pairs[0].i}",
        f"variable J index {pairs[0].j}",
        *(f"variable radius_{k} equal {number(body.radius or 0)}" for k, body in bodies),
        *(f"variable density_{k} equal {number(density_of(b))}" for k, b in bodies if not b.wall),
        "# Elastic contact time (s) of the pairs at 1 m/s",
        *(f"variable contact_{p.i}_{p.j} equal {number(contact_time(p.law))}" for p in pairs),
        "variable contact equal v_contact_$I_$J*$V^(-0.2)",
        f"variable dt equal v_contact/{STEPS}",
        "variable Ri equal v_radius_$I",
        "variable Rj equal v_radius_$J",
        f"variable above equal v_Ri+5*$V*v_contact/{STEPS}",
        "variable below equal -v_Rj",
        "variable Di equal 2*v_Ri",
        "variable Dj equal 2*v_Rj",
        "variable rho_i equal v_density_$I",
        "variable down equal -$V",
        "variable half equal -$V/2",
        "",
        "units si",
        "atom_style granular",
        "atom_modify map array",
        "boundary f f f",
        "communicate single vel yes",
        "newton off",
        *filter(None, [_range(table)]),
        f"region box block {_box(size)} units box",
        f"create_box {len(bodies)} box",
        f"neighbor {number(0.1 * size)} bin",
        "neigh_modify delay 0",
        f"include {FRAGMENT}",
        "",
        "# LIGGGHTS wants a particle of type 1 to exist: this one rests aside.",
        f"create_atoms 1 single {number(2.5 * size)} 0 {number(2.5 * size)} units box",
        f"set atom 1 diameter {number(2 * (table.spheres[0].radius or 0))} density "
        f"{number(density_of(table.spheres[0]))}",
        "create_atoms $I single 0 0 ${above} units box",
        "set atom 2 diameter ${Di} density ${rho_i}",
        "group one id 2",
        "velocity one set 0 0 ${down} units box",
        "variable gap equal z[2]-v_Ri",
        "variable rebound equal vz[2]",
        *_spheres(count),
        *_walls(table),
        "timestep ${dt}",
        "fix move all nve/sphere",
        "thermo 100000000",
        "variable turn loop 10000",
        "label more",
        f"run {STEPS // 50}",
        'if "${gap} > 0 && ${rebound} > 0" then "jump SELF parted"',
        "next turn",
        "jump SELF more",
        "print 'the bodies did not part'",
        "quit",
        "label parted",
        "variable ratio equal ${rebound}/$V",
        'print "restitution = ${ratio}"',
    ]
    return "\n".join(lines) + "\n"


def _spheres(count: int) -> list[str]:
    return [
        f'if "$J > {count}" then "jump SELF ready"',
        "variable rho_j equal v_density_$J",
        "create_atoms $J single 0 0 ${below} units box",
        "set atom 3 diameter ${Dj} density ${rho_j}",
        "group two id 3",
        "velocity one set 0 0 ${half} units box",
        "variable up equal $V/2",
        "velocity two set 0 0 ${up} units box",
        "variable gap equal z[2]-z[3]-v_Ri-v_Rj",
        "variable rebound equal vz[2]-vz[3]",
        "label ready",
    ]


def _walls(table: PairTable) -> list[str]:
    if not table.walls:
        return []
    return [
        f'if "$J > {len(table.spheres)}" then &\n'
        '  "fix wall all wall/gran model hertz tangential history primitive type $J zplane 0.0"'
    ]


def _box(size: float) -> str:
    return " ".join(f"{number(-4 * size)} {number(4 * size)}" for _ in range(3))
