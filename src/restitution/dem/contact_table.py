"""A law as tables of one contact: loading, loss, and the end of unloading (docs/any-code.md)."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from restitution.dem.pair import unknown_pull_off
from restitution.errors import CaseError
from restitution.impacts.stored_force import loading_force
from restitution.laws.law import Array, Law

_BETWEEN = 6  # nodes of the loading curve in the interval of two points
_START = np.linspace(0, 1, 13)[:-1] ** 2  # its nodes below the first point
_SAMPLES = 8  # energies in the interval of two points
_POWER = 1.5  # F ∝ sⁿ on unloading where the indentation at separation is not stored (Hertz)


@dataclass(frozen=True, eq=False)
class ContactTable:
    """Force and losses of a pair, in SI units.

    `force` against `depth` is the loading curve, from first touch. An impact of the energy `work`
    loses `lost`. Unloading from the indentation `deepest` ends at the indentation `end`, with the
    tension `pull` before it.
    """

    depth: Array
    force: Array
    work: Array
    lost: Array
    deepest: Array
    end: Array
    pull: Array


def contact_table(law: Law) -> ContactTable:
    """The tables of `law`. Raises `CaseError` if its indentations or pull-off forces do not do."""
    depth, force, work = (law.column(name) for name in ("indentation", "force", "loading_work"))
    if not (depth[0] > 0 and (np.diff(depth) > 0).all()):
        raise CaseError(
            f"{law.pair}: the indentations of its law do not increase with the velocity, so it "
            "has no force; run the case again, with other velocities"
        )
    at = loading_force(depth, force, work)
    nodes = [depth[0] * _START[1:]]
    for below, above in pairwise(depth.tolist()):
        nodes.append(np.geomspace(below, above, _BETWEEN, endpoint=False))
    x = np.concatenate([*nodes, depth[-1:]])
    # At first touch an attraction jumps; the force is linear from there (`loading_force`).
    touch = min(at(1e-12 * depth[0]), 0.0) if law.work_of_adhesion > 0 else 0.0
    end, pull = _ends(law)
    adhesive = law.work_of_adhesion > 0
    return ContactTable(
        depth=np.append(0.0, x),
        force=np.append(touch, [at(d) for d in x.tolist()]),
        work=0.5 * law.mass * (V := _velocities(law)) ** 2,
        lost=0.5 * law.mass * V**2 * (1 - np.array([_ratio(law, v) for v in V.tolist()])),
        deepest=np.append(0.0, depth),
        end=np.append(min(end[0], 0.0) if adhesive else 0.0, end),
        pull=np.append(pull[0], pull),
    )


def _velocities(law: Law) -> Array:
    V = law.column("velocity")
    if V.size == 1:
        return V
    places = np.arange((V.size - 1) * _SAMPLES + 1) / _SAMPLES
    fine = np.exp(np.interp(places, np.arange(V.size), np.log(V)))
    start = law.sticks_below
    return fine if start is None else np.union1d(fine, [start])


def _ratio(law: Law, velocity: float) -> float:
    """e², and W_u/W_l (negative) where the pair sticks."""
    e = law.at(velocity).restitution
    return e**2 if e > 0 else min(law.curve().at(velocity), 0.0)


def _ends(law: Law) -> tuple[Array, Array]:
    """Indentation (m) at separation after each point, and the pull-off force (N)."""
    V, depth, force = (law.column(name) for name in ("velocity", "indentation", "force"))
    pull = np.zeros_like(depth)
    if law.work_of_adhesion > 0:
        stored = law.column("pull_off_force")
        known = np.isfinite(stored)
        if not known.any():
            raise unknown_pull_off(law)
        pull = np.interp(np.log(V), np.log(V[known]), stored[known])
    energy = law.column("loading_work") * [_ratio(law, v) for v in V.tolist()]
    share = law.column("separation") / depth
    known = np.isfinite(share)
    if known.any():
        return np.interp(np.log(depth), np.log(depth[known]), share[known]) * depth, pull
    stiff = np.maximum(force - _POWER * pull, 0.1 * force)
    span = np.divide(energy * (_POWER + 1), stiff, out=depth.copy(), where=stiff > 0)
    floor = np.divide(-1.5 * energy, pull, out=np.zeros_like(pull), where=pull > 0)
    return depth - np.maximum(span, floor), pull
