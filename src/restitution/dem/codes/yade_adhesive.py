"""YADE: Hertz with DMT's constant attraction, and a damping by impact velocity.

With `includeAdhesion`, YADE 2023.02a subtracts a constant force from Hertz's while the spheres
overlap, and limits a tensile damping force to the same size. This attraction loses no energy, so
the damping of every contact is looked up at its first touch: e(V) is that of the law, and below the
sticking velocity the damping holds the spheres. On a wall YADE uses half of R*.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from restitution.dem.codes.yade import CODE, SETTING, inputs
from restitution.dem.damped_adhesion import DampedAdhesion, known_pull_off, require_adhesion
from restitution.dem.export_common import Export, law_points
from restitution.dem.pair import ExportedPair, adhesive_time, contact_time
from restitution.dem.pair_table import PairTable
from restitution.laws.law import Array, Law
from restitution.theory import Hertz

_ENDS = (
    "the overlap is back to zero. The force is tensile before, by the constant attraction and by "
    "at most as much damping. On a wall YADE uses half of R*, which makes the contact softer."
)
# Measured with lactose of 2 um.
_ACCURACY = (
    "Then e is 0.02 too low at 1.2 times the sticking velocity, and within 0.004 from twice it on."
)
_NODES = 3000
_NEAR = (1.0, 1.003, 1.01, 1.03, 1.06, 1.12, 1.25)  # further velocities, over the sticking velocity
_ABOVE = 1.05  # velocities whose e is stated, over the sticking velocity
_STICKS = 1.03  # damping where the pair sticks, over the least that holds the spheres
_MOST = 4.0  # largest betan
_HALVINGS = 26


@dataclass(frozen=True, eq=False)
class Attraction:
    """The attraction `force` (N) of a pair, and `damping` (betan) against `velocity` (m/s).

    `worst` is the largest difference of e between the velocities, from 1.05 times the sticking
    velocity on.
    """

    force: float
    velocity: Array
    damping: Array
    worst: float

    @property
    def points(self) -> list[tuple[float, float]]:
        """Velocity and damping, one row for each velocity."""
        return list(zip(self.velocity.tolist(), self.damping.tolist(), strict=True))

    def said(self, law: Law) -> str:
        """The pull-off force, and how far e(V) is off."""
        sticks = f"sticks below {law.sticks_below:.3g} m/s as the law; " if law.sticks_below else ""
        return (
            f"pull-off force {self.force:.4g} N as computed; {sticks}above, e is off by up to "
            f"{self.worst:.1g}"
        )


def write(table: PairTable, velocity: float) -> dict[str, str]:
    """A module, a test collision and notes; names and texts. Raises `CaseError`, `DomainError`."""
    table.require_all(CODE)
    require_adhesion(table.laws.values(), "yade")
    export = Export(
        table,
        velocity,
        CODE,
        0.0,
        _ENDS,
        constant=False,
        setting=SETTING,
        adhesive=True,
        steps=500,
        accuracy=_ACCURACY,
    )
    attractions = {
        (pair.i, pair.j): attraction(pair) for pair in export.pairs if pair.law.work_of_adhesion > 0
    }
    said = [
        f"Pair {i} {j}: {found.said(table.laws[i, j])}." for (i, j), found in attractions.items()
    ]
    values: dict[str, Any] = {"attractions": attractions, "misfits": said}
    return inputs(export, values) | export.notes()


def attraction(pair: ExportedPair) -> Attraction:
    """The damping with which YADE's e is that of the law of `pair` at each of its velocities."""
    law = pair.law
    force = known_pull_off(law, pair.velocity)
    radius = law.radius / (2 if pair.wall else 1)
    model = _model(law, force, radius)
    V_s = law.highest if law.sticks_everywhere else law.sticks_below or 0.0
    V = np.array([v for v, _ in law_points(law, 0.0)])
    near = [V_s * share for share in _NEAR if law.lowest <= V_s * share <= law.highest]
    V = np.union1d(V[V_s <= V], near or V[:1])

    def restitution(velocity: Array, betan: Array) -> Array:
        elastic = contact_time(law, radius) * velocity**-0.2
        time = np.minimum(elastic, adhesive_time(law, force))
        return model.restitution(velocity, law.mass, betan, time)

    e = law.restitution(V)
    low, high = np.zeros_like(V), np.full_like(V, _MOST)
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        off = restitution(V, middle) <= e
        low, high = np.where(off, low, middle), np.where(off, middle, high)
    betan = np.where(e > 0, 0.5 * (low + high), _STICKS * high)
    between = np.sqrt(V[1:] * V[:-1])
    between = between[between >= _ABOVE * V_s]
    there = np.interp(np.log(between), np.log(V), betan)
    miss = np.abs(restitution(between, there) - law.restitution(between))
    worst = float(np.max(miss, initial=0.001))
    return Attraction(force, V, betan, worst)


def _model(law: Law, force: float, radius: float) -> DampedAdhesion:
    hertz = Hertz(radius, law.contact_modulus)
    deepest = float(law.column("indentation").max()) * (law.radius / radius) ** 0.2
    top = 3 * max(deepest, float(hertz.indentation(force)))
    depth = top * np.linspace(0, 1, _NODES) ** 2
    scale = 2 * math.sqrt(2 * law.contact_modulus * law.mass)
    return DampedAdhesion(
        depth,
        np.asarray(hertz.force(depth) - force),
        scale * (radius * depth) ** 0.25,
        _MOST,
        cap=force,
    )
