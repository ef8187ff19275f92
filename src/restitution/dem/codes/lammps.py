"""LAMMPS: `pair_style granular` with `hertz/material` and `damping coeff_restitution`.

LAMMPS takes the E and ν of a pair_coeff for both bodies, on walls, too: E* = E/2(1 − ν²),
G* = E/4(2 − ν)(1 + ν). Each pair gets the E and ν with its own E* and G*; LAMMPS' mixing of two
materials, which applies the ½ twice, is not used. Force and damping (Antypov & Elliott, EPL 94
(2011) 50004) go on to δ = 0, with a tension at the end; `limit_damping` would cut it off and
raise e, and `damping tsuji` has an error of √2 in released versions.
"""

from __future__ import annotations

from restitution.dem.codes.lammps_mdr import mdr_lines
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

CODE = "LAMMPS"
LOWEST = 0.001  # reproduced within 0.5 % with `STEPS` steps a contact
FRAGMENT, COLLISION = "restitution.lmp", "collision.in"
_ENDS = (
    "the overlap is back to zero. The damping pulls shortly before; do not add limit_damping, "
    "which cuts that off and raises e (0.808 for 0.8)."
)


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The fragment to include and a collision that shows its e, as texts by file name.

    Raises `CaseError`, `DomainError`.
    """
    walls_only = all(j > len(table.spheres) for _, j in table.laws)
    if not walls_only:
        table.require_spheres(CODE)
    pairs = pairs_at(table, velocity, CODE, LOWEST)
    head = header(table, pairs, velocity, code=CODE, ends=_ENDS)
    short = summary(pairs, velocity, code=CODE, ends=_ENDS, fragment=FRAGMENT)
    return {
        FRAGMENT: commented(head, "#") + _fragment(pairs, velocity),
        COLLISION: commented(short, "#") + _collision(table, pairs, velocity),
    }


def _fragment(pairs: list[Pair], velocity: float) -> str:
    spheres = [pair for pair in pairs if not pair.wall]
    walls = [pair for pair in pairs if pair.wall]
    lines = [
        "",
        "# To include after create_box, with `units si` and `atom_style sphere`.",
        f"# {PLACEHOLDER}",
        "# E and nu of a pair are those with its E* and G*; not those of one of its materials.",
    ]
    if spheres:
        lines += ["pair_style granular", *map(_pair_coeff, spheres)]
    else:
        lines.append("# Laws with walls only: no pair_style, give your own between spheres.")
    if walls:
        lines += [
            "# Walls: one fix for each type of sphere and each wall, on the group of that type, as",
            *(
                f"#   group type_{p.i} type {p.i}\n"
                f"#   fix floor_{p.i}_{p.j} type_{p.i} wall/gran "
                f"${{wall_{p.i}_{p.j}}} zplane 0.0 NULL"
                for p in walls
            ),
            *(f'variable wall_{p.i}_{p.j} string "granular {_model(p)}"' for p in walls),
        ]
    return "\n".join([*lines, *mdr_lines(pairs, velocity)]) + "\n"


def _model(pair: Pair) -> str:
    E, nu = pair.twin
    return (
        f"hertz/material {number(E)} {number(pair.restitution)} {number(nu)} "
        f"tangential mindlin NULL 1.0 {FRICTION} damping coeff_restitution"
    )


def _pair_coeff(pair: Pair) -> str:
    return f"pair_coeff {pair.i} {pair.j} {_model(pair)}"


def _collision(table: PairTable, pairs: list[Pair], velocity: float) -> str:
    count = len(table.spheres)
    bodies = list(enumerate(table.particles, 1))
    densities = [(k, density_of(body)) for k, body in bodies if not body.wall]
    size = max(body.radius or 0.0 for body in table.spheres)
    lines = [
        "",
        "# One head-on collision of types I and J, I <= J"
        + (f"; J from {count + 1} on is a wall:" if table.walls else ":"),
        f"#   lmp -in {COLLISION} -var V {number(velocity)} "
        f"-var I {pairs[0].i} -var J {pairs[0].j}",
        f"# Time step: 1/{STEPS} of {TIME_STEP}",
        "# (1/50 gives it within 1 %).",
        f"variable V index {number(velocity)}",
        f"variable I index {pairs[0].i}",
        f"variable J index {pairs[0].j}",
        *(f"variable radius_{k} equal {number(body.radius or 0)}" for k, body in bodies),
        *(f"variable density_{k} equal {number(rho)}" for k, rho in densities),
        "# Elastic contact time (s) of the pairs at 1 m/s",
        *(f"variable contact_{p.i}_{p.j} equal {number(contact_time(p.law))}" for p in pairs),
        "variable contact equal v_contact_$I_$J*$V^(-0.2)",
        "variable rho_i equal v_density_$I",
        "variable rho_j equal v_density_$J",
        "variable Ri equal v_radius_$I",
        "variable Rj equal v_radius_$J",
        "",
        "units si",
        "atom_style sphere",
        "atom_modify map array",
        "boundary f f f",
        "comm_modify vel yes",
        "newton off",
        f"region box block {_box(size)} units box",
        f"create_box {count} box",
        f"include {FRAGMENT}",
        "",
        f"timestep $(v_contact/{STEPS})",
        f"variable apart equal 5*$V*v_contact/{STEPS}",
        "variable above equal v_Ri+v_apart",
        "create_atoms $I single 0 0 ${above} units box",
        "set atom 1 diameter $(2*v_Ri) density $(v_rho_i)",
    ]
    sphere = [
        "variable below equal -v_Rj",
        "create_atoms $J single 0 0 ${below} units box",
        "set atom 2 diameter $(2*v_Rj) density $(v_rho_j)",
        "velocity all set 0 0 $(v_V/2) units box",
        "group one id 1",
        "velocity one set 0 0 $(-v_V/2) units box",
        "variable gap equal z[1]-z[2]-v_Ri-v_Rj",
        "variable rebound equal vz[1]-vz[2]",
    ]
    wall = [
        "velocity all set 0 0 $(-v_V) units box",
        "variable gap equal z[1]-v_Ri",
        "variable rebound equal vz[1]",
    ]
    lines += _choice(f"$J <= {count}", sphere)
    if table.walls:
        lines += _choice(f"$J > {count}", wall)
    lines += [
        f'if "$I == {p.i} && $J == {p.j}" then &\n'
        f'  "fix wall all wall/gran ${{wall_{p.i}_{p.j}}} zplane 0.0 NULL"'
        for p in pairs
        if p.wall
    ]
    lines += [
        "fix move all nve/sphere",
        "variable parted equal (v_gap>0)*(v_rebound>0)",
        "fix stop all halt 1 v_parted > 0.5 error continue message no",
        "thermo 100000000",
        f"run {1000 * STEPS}",
        'if "${rebound} <= 0" then &',
        "  \"print 'the bodies did not part'\" &",
        '  "quit 1"',
        'print "restitution = $(v_rebound/v_V:%.6f)"',
    ]
    return "\n".join(lines) + "\n"


def _choice(condition: str, commands: list[str]) -> list[str]:
    quoted = [f'  "{command}"' for command in commands]
    return [" &\n".join([f'if "{condition}" then', *quoted])]


def _box(size: float) -> str:
    return " ".join(f"{number(-4 * size)} {number(4 * size)}" for _ in range(3))
