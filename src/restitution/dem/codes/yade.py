"""YADE: `Ip2_FrictMat_FrictMat_MindlinPhys` with one `betan` a pair of materials, or e(V) itself.

YADE adds a damping 2β(m* dF/dδ)^½ dδ/dt to Hertz's F and does not let the sum pull: a contact ends
where the force is back to zero. Its own `en` becomes β by a fit (Thornton et al., Powder Technol.
233 (2013) 30, eqs. B6, B7) that returns 0.979 for 0.99 and 0.948 for 0.95; other releases do it in
other ways. So β (`betan`) is written, by a fit of ours to this equation of motion, for e from 0.01:

    β = L exp(Σ c_k L^k),  L = −ln e,  within 10⁻⁵ of e

E* is made of the two materials; R* on a wall is R/2 in YADE, which makes that contact softer by √2
and does not change e. `betan` is each contact's own, so that the law itself can be followed: it is
set at first touch, from the velocity there.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from restitution.dem.export_common import (
    FRICTION,
    PLACEHOLDER,
    TIME_STEP,
    Pair,
    commented,
    contact_time,
    density_of,
    header,
    identifier,
    number,
    pairs_at,
    summary,
)
from restitution.dem.pair_table import PairTable
from restitution.laws.law import Law, Particle

CODE = "YADE"
LOWEST = 0.01  # of the fit
FRAGMENT, COLLISION = "restitution_yade.py", "collision_yade.py"
_ENDS = (
    "the force is back to zero, before the overlap is: the damping does not pull. e is given as "
    "betan, not as en, of which YADE 2023.02a makes 0.979 for 0.99. On a wall YADE takes R*/2 for "
    "R*: the contact is softer by sqrt(2), with the same e."
)
_STEPS = 2000
_WALL_DENSITY = 1000.0  # of a wall without a density in the case: YADE asks for one
_SAMPLES = 4  # of the law between two velocities that were computed

_FIT = (-1.23589, 0.202669, 0.0108748, 0.000410051, -3.09169e-5, -1.19887e-6)

_MODULE = '''
from math import atan, exp, log
from warnings import warn

from yade import O, FrictMat, Ip2_FrictMat_FrictMat_MindlinPhys, MatchMaker

# {placeholder}
FRICTION = {friction}
# name, E (Pa), nu, density (kg/m^3; of walls {wall_density:g} where none is known)
MATERIALS = (
{materials}
)
# e by types at {velocity} m/s
RESTITUTION = {{
{restitution}
}}
# e against impact velocity (m/s) by types: the law itself, for `follow`
LAWS = {{
{laws}
}}
_told = set()  # pairs of types that `check` has warned of


def materials():
    """Append the materials; their ids, in the order of the types."""
    return [
        O.materials.append(
            FrictMat(
                label=name, young=E, poisson=nu, density=density, frictionAngle=atan(FRICTION)
            )
        )
        for name, E, nu, density in MATERIALS
    ]


def physics(ids):
    """The Ip2 functor with e constant, for the ids that `materials` gave."""
    matches = tuple((ids[i - 1], ids[j - 1], damping(e)) for (i, j), e in RESTITUTION.items())
    return Ip2_FrictMat_FrictMat_MindlinPhys(betan=MatchMaker(matches=matches))


def follow(beyond="warn"):
    """Give every new contact the e of its own velocity, from LAWS instead of RESTITUTION.

    To be called in each step, right after InteractionLoop (slow for large packings):
    PyRunner(iterPeriod=1, initRun=True,
             command="import restitution_yade; restitution_yade.follow()")
    Nothing was computed beyond the velocities in LAWS. There beyond="warn" takes the e of the
    first or last velocity and warns, once for each pair of types; beyond="raise" raises ValueError.
    """
    types = {{name: k for k, (name, *_) in enumerate(MATERIALS, 1)}}
    for contact in O.interactions:
        if not contact.isReal or contact.iterMadeReal != O.iter:
            continue
        one, two = O.bodies[contact.id1], O.bodies[contact.id2]
        pair = tuple(sorted(types[body.material.label] for body in (one, two)))
        approach = abs((one.state.vel - two.state.vel).dot(contact.geom.normal))
        check(pair, approach, beyond)
        contact.phys.betan = contact.phys.betas = damping(restitution(LAWS[pair], approach))


def check(pair, velocity, beyond="warn"):
    """Warn, once for each pair of types, or raise where the law of `pair` has no `velocity`."""
    if beyond not in ("warn", "raise"):
        raise ValueError("beyond: %r is not 'warn' or 'raise'" % (beyond,))
    low, high = LAWS[pair][0][0], LAWS[pair][-1][0]
    if low * (1 - 1e-6) <= velocity <= high * (1 + 1e-6):
        return
    said = (
        "types %d and %d meet at %.6g m/s, outside of the velocities that were computed "
        "(%.6g to %.6g m/s)" % (*pair, velocity, low, high)
    )
    if beyond == "raise":
        raise ValueError(said + "; compute the law further, or call follow() without beyond")
    if pair not in _told:
        _told.add(pair)
        warn(said + "; e of the nearest one is used, and this pair is not named again")


def restitution(law, velocity):
    """e at `velocity`: by straight lines in ln V, held beyond the ends (see `check`)."""
    below = [point for point in law if point[0] <= velocity]
    above = [point for point in law if point[0] > velocity]
    if not below or not above:
        return (below or above[:1])[-1][1]
    (a, e), (b, f) = below[-1], above[0]
    return e + (f - e) * log(velocity / a) / log(b / a)


def damping(e):
    """YADE's betan that returns e."""
    L = -log(min(e, 1))
    fit = {fit}
    return L * exp(sum(c * L**k for k, c in enumerate(fit)))
'''

_SCRIPT = """
# One head-on collision of types I and J, I <= J{walls}; with `law` at the end e is that
# of the velocity (`follow`), else that of RESTITUTION:
#   yade -n -x -j1 {collision} {velocity} {i} {j} [law]
# Time step: 1/{steps} of {time_step}.
import os
import sys

sys.path.insert(0, os.getcwd())
import restitution_yade
from yade import *
from yade import utils

given = sys.argv[1:] + ["{velocity}", "{i}", "{j}"][len(sys.argv) - 1 :]
V, I, J = float(given[0]), int(given[1]), int(given[2])
RADIUS = {radii}
CONTACT = {contact}  # elastic contact time at 1 m/s

O.reset()
ids = restitution_yade.materials()
upper = O.bodies.append(utils.sphere((0, 0, RADIUS[I]), RADIUS[I], material=ids[I - 1]))
if J in RADIUS:
    lower = O.bodies.append(utils.sphere((0, 0, -RADIUS[J]), RADIUS[J], material=ids[J - 1]))
    O.bodies[upper].state.vel = (0, 0, -V / 2)
    O.bodies[lower].state.vel = (0, 0, V / 2)
else:
    lower = O.bodies.append(utils.wall(0.0, axis=2, material=ids[J - 1]))
    O.bodies[upper].state.vel = (0, 0, -V)
follow = [
    PyRunner(
        iterPeriod=1,
        initRun=True,
        command="import restitution_yade; restitution_yade.follow()",
    )
]
O.engines = [
    ForceResetter(),
    InsertionSortCollider([Bo1_Sphere_Aabb(), Bo1_Wall_Aabb()]),
    InteractionLoop(
        [Ig2_Sphere_Sphere_ScGeom(), Ig2_Wall_Sphere_ScGeom()],
        [restitution_yade.physics(ids)],
        [Law2_ScGeom_MindlinPhys_Mindlin()],
    ),
    *(follow if given[3:] == ["law"] else []),
    NewtonIntegrator(damping=0, gravity=(0, 0, 0)),
]
O.dt = CONTACT[I, J] * V ** -0.2 / {steps}
rebound, touches = -V, True
for turn in range(100):
    O.run({steps}, True)
    rebound = O.bodies[upper].state.vel[2] - O.bodies[lower].state.vel[2]
    touches = any(contact.isReal for contact in O.interactions)
    if rebound > 0 and not touches:
        break
if rebound <= 0 or touches:
    sys.exit("the bodies did not part")
print("restitution = %.6f" % (rebound / V))
"""


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """The module to import and a collision that shows its e, as texts by file name.

    Raises `CaseError`, `DomainError`.
    """
    table.require_all(CODE)
    pairs = pairs_at(table, velocity, CODE, LOWEST)
    head = header(table, pairs, velocity, code=CODE, ends=_ENDS)
    short = summary(pairs, velocity, code=CODE, ends=_ENDS, fragment=FRAGMENT)
    return {
        FRAGMENT: commented(head, "#") + _module(table, pairs, velocity),
        COLLISION: commented(short, "#") + _collision(table, pairs, velocity),
    }


def _module(table: PairTable, pairs: list[Pair], velocity: float) -> str:
    bodies = list(enumerate(table.particles, 1))
    return _MODULE.format(
        placeholder=PLACEHOLDER,
        friction=FRICTION,
        velocity=number(velocity),
        wall_density=_WALL_DENSITY,
        fit=_FIT,
        materials=_entries(
            f'("{identifier(b, k)}", {number(b.youngs_modulus)}, {number(b.poissons_ratio)}, '
            f"{number(_density(b))})"
            for k, b in bodies
        ),
        restitution=_entries(f"({p.i}, {p.j}): {number(p.restitution)}" for p in pairs),
        laws="\n".join(f"    ({p.i}, {p.j}): (\n{_table(p.law)}\n    )," for p in pairs),
    )


def _collision(table: PairTable, pairs: list[Pair], velocity: float) -> str:
    count = len(table.spheres)
    radii = (f"{k}: {number(b.radius or 0)}" for k, b in enumerate(table.spheres, 1))
    times = (f"({p.i}, {p.j}): {number(_contact_time(p))}" for p in pairs)
    return _SCRIPT.format(
        walls=f"; J from {count + 1} on is a wall" if table.walls else "",
        collision=COLLISION,
        velocity=number(velocity),
        i=pairs[0].i,
        j=pairs[0].j,
        steps=_STEPS,
        time_step=TIME_STEP,
        radii="{" + ", ".join(radii) + "}",
        contact="{" + ", ".join(times) + "}",
    )


def _density(body: Particle) -> float:
    """Density (kg/m³); of a wall that has none, a number that moves nothing."""
    return _WALL_DENSITY if body.wall and body.density is None else density_of(body)


def _entries(items: Iterable[str]) -> str:
    return "\n".join(f"    {item}," for item in items)


def _table(law: Law) -> str:
    """The law between and at its points, near enough for straight lines; not below `LOWEST`."""
    V = law.column("velocity")
    fine = np.interp(
        np.arange((V.size - 1) * _SAMPLES + 1) / _SAMPLES, np.arange(V.size), np.log(V)
    )
    rows = [(v, max(law.at(v).restitution, LOWEST)) for v in np.exp(fine).tolist()]
    return "\n".join(f"        ({number(v)}, {e:.6f})," for v, e in rows)


def _contact_time(pair: Pair) -> float:
    """Elastic contact time at 1 m/s, with YADE's R/2 on a wall."""
    return contact_time(pair.law, pair.law.radius / (2 if pair.wall else 1))
