"""The table of pairs that most DEM codes need: one law for each pair of particle types."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations_with_replacement, product

import numpy as np

from restitution.dem.units import coarse_grained
from restitution.display import quantity
from restitution.errors import CaseError
from restitution.laws.law import Law
from restitution.laws.particle import Particle

# Largest difference of e at which two laws of the same pair, such as those of the same case with
# `first` and `second` exchanged, count as one.
_EQUAL = 1e-5


@dataclass(frozen=True)
class PairTable:
    """Types of spheres and walls, and the law of every given pair.

    Types are numbered from 1, spheres first. The keys of `laws` are (i, j) with i ≤ j. Bodies and
    laws are those of particles `size` times as large as the computed ones.
    """

    spheres: tuple[Particle, ...]
    walls: tuple[Particle, ...]
    laws: dict[tuple[int, int], Law]
    size: float = 1.0

    @property
    def particles(self) -> tuple[Particle, ...]:
        """The spheres, then the walls."""
        return self.spheres + self.walls

    @property
    def largest_radius(self) -> float:
        """The radius of the largest sphere (m)."""
        return max(body.radius or 0.0 for body in self.spheres)

    @property
    def walls_only(self) -> bool:
        """Whether every law is that of a sphere on a wall."""
        return all(j > len(self.spheres) for _, j in self.laws)

    def pairs(self) -> list[tuple[int, int, Law]]:
        """The type numbers and the law of every pair, in order."""
        return [(i, j, law) for (i, j), law in sorted(self.laws.items())]

    def missing_spheres(self) -> list[tuple[int, int]]:
        """The pairs of two types of spheres that have no law."""
        numbers = range(1, len(self.spheres) + 1)
        pairs = combinations_with_replacement(numbers, 2)
        return [pair for pair in pairs if pair not in self.laws]

    def require_spheres(self, code: str) -> None:
        """Raise `CaseError` if a pair of types of spheres has no law, unless all laws are of walls.

        An export then leaves e of the pairs of spheres to the user.
        """
        if not self.walls_only:
            reason = "spheres of any two types can touch"
            self._require(code, self.missing_spheres(), "pair of particle types", reason)

    def require_all(self, code: str) -> None:
        """Raise `CaseError` if a sphere has no law with a wall, and as `require_spheres`."""
        self.require_spheres(code)
        spheres, last = len(self.spheres), len(self.particles)
        pairs = product(range(1, spheres + 1), range(spheres + 1, last + 1))
        reason = f"walls are types in {code}, and its input has a value for every pair of types"
        missing = [pair for pair in pairs if pair not in self.laws]
        self._require(code, missing, "sphere on every wall", reason)

    def _require(
        self, code: str, missing: Sequence[tuple[int, int]], what: str, reason: str
    ) -> None:
        if not missing:
            return
        i, j = missing[0]
        more = f" (and {len(missing) - 1} more)" if len(missing) > 1 else ""
        raise CaseError(
            f"{code} needs a separate law for every {what}, because {reason}, but the law for "
            f"{self.particles[i - 1]} and {self.particles[j - 1]}{more} is missing; compute "
            "missing laws with `restitution run` and `restitution fit-law`, and add them to the "
            "command"
        )


def pair_table(laws: Sequence[Law], size: float = 1.0) -> PairTable:
    """Make the table of pairs from `laws`. Bodies with equal values become one type.

    A value that only one of two bodies has does not make them different. `size` is that of
    coarse-grained particles. Raises `CaseError` if a body may be either of two types, or if two
    laws of one pair differ.
    """
    if size != 1:
        laws = [coarse_grained(law, size) for law in laws]
    distinct = list(dict.fromkeys(body for law in laws for body in (law.first, law.second)))
    types, kind = _types(distinct)
    # Types in the order of their first appearance, walls last.
    order = sorted(dict.fromkeys(kind[body] for body in distinct), key=lambda k: types[k].wall)
    ordered = [_named(types[k]) for k in order]
    table: dict[tuple[int, int], Law] = {}
    for law in laws:
        i, j = sorted(order.index(kind[body]) + 1 for body in (law.first, law.second))
        if (i, j) in table and not _equal(table[i, j], law):
            raise CaseError(
                f"two laws are given for {ordered[i - 1]} and {ordered[j - 1]}, and they differ; "
                "give only one of them, or, if the bodies are not the same, write their "
                "yield_strength or hardness into [first] and [second] of the cases"
            )
        table.setdefault((i, j), law)
    return PairTable(
        tuple(body for body in ordered if not body.wall),
        tuple(body for body in ordered if body.wall),
        table,
        size,
    )


def _types(bodies: Sequence[Particle]) -> tuple[list[Particle], dict[Particle, int]]:
    """Merge bodies that may be equal; return the types, and the index of the type of each body."""
    types: list[Particle] = []
    kind: dict[Particle, int] = {}
    for body in sorted(bodies, key=_unknown):  # bodies with the most known values first
        same = [k for k, known in enumerate(types) if known.may_equal(body)]
        if len(same) > 1:
            one, other, *_ = (types[k].described() for k in same)
            raise CaseError(
                f"{body}: has the radius and the elastic constants of both {one} and {other}; "
                "write the material, yield_strength or hardness of one of them into its case"
            )
        if same:
            kind[body] = same[0]
            types[same[0]] = types[same[0]].merged(body)
        else:
            kind[body] = len(types)
            types.append(body)
    return types, kind


def _unknown(body: Particle) -> int:
    return sum(value is None for value in body.distinguishing)


def _named(body: Particle) -> Particle:
    if body.material is not None:
        return body
    kind = "wall" if body.wall else "sphere"
    return replace(body, name=f"{kind}, E = {quantity(body.youngs_modulus, 'Pa')}")


def _equal(one: Law, other: Law) -> bool:
    V, W = one.column("velocity"), other.column("velocity")
    e, f = one.column("restitution"), other.column("restitution")
    return (
        one.friction == other.friction
        and V.shape == W.shape
        and bool(np.allclose(V, W, rtol=1e-3, atol=0))
        and bool(np.allclose(e, f, rtol=0, atol=_EQUAL))
    )
