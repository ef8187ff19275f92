"""Table of pairs that most DEM codes need: one law for each pair of particle types."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import combinations_with_replacement, product

from restitution.errors import CaseError
from restitution.laws.law import Law, Particle


@dataclass(frozen=True)
class PairTable:
    """Types of spheres and walls, and the law of every given pair.

    Types are numbered from 1, as in DEM codes; the numbers of walls follow those of spheres. The
    keys of `laws` are (i, j) with i ≤ j.
    """

    spheres: tuple[Particle, ...]
    walls: tuple[Particle, ...]
    laws: dict[tuple[int, int], Law]

    @property
    def particles(self) -> tuple[Particle, ...]:
        """All particles: the spheres, then the walls."""
        return self.spheres + self.walls

    @property
    def largest_radius(self) -> float:
        """The radius of the largest sphere, m."""
        return max(body.radius or 0.0 for body in self.spheres)

    def pairs(self) -> list[tuple[int, int, Law]]:
        """The type numbers and the law of every pair, in order."""
        return [(i, j, law) for (i, j), law in sorted(self.laws.items())]

    def require_spheres(self, code: str) -> None:
        """Raise `CaseError`, which names `code`, if a pair of two types of spheres has no law."""
        numbers = range(1, len(self.spheres) + 1)
        self._require(code, combinations_with_replacement(numbers, 2), "pair of particle types")

    def require_all(self, code: str) -> None:
        """Raise `CaseError`, which names `code`, if a pair with at least one sphere has no law."""
        self.require_spheres(code)
        spheres, last = len(self.spheres), len(self.particles)
        pairs = product(range(1, spheres + 1), range(spheres + 1, last + 1))
        self._require(code, pairs, "sphere on every wall")

    def _require(self, code: str, pairs: Iterable[tuple[int, int]], what: str) -> None:
        missing = [
            f"{self.particles[i - 1]} and {self.particles[j - 1]}"
            for i, j in pairs
            if (i, j) not in self.laws
        ]
        if missing:
            more = f" (and {len(missing) - 1} more)" if len(missing) > 1 else ""
            raise CaseError(
                f"{code} needs a separate law for every {what}, but the law for "
                f"{missing[0]}{more} is missing; compute missing laws with `restitution run` "
                "and `restitution fit-law`, and add them to the command"
            )


def pair_table(laws: Sequence[Law]) -> PairTable:
    """Make the table of pairs from `laws`. Bodies with equal values become one type.

    Raises `CaseError` if two of the laws are for the same pair.
    """
    bodies = list(dict.fromkeys(body for law in laws for body in (law.first, law.second)))
    spheres = tuple(body for body in bodies if not body.wall)
    walls = tuple(body for body in bodies if body.wall)
    number = {body: k for k, body in enumerate(spheres + walls, 1)}
    found: dict[tuple[int, int], Law] = {}
    for law in laws:
        i, j = sorted((number[law.first], number[law.second]))
        if (i, j) in found:
            raise CaseError(
                f"two laws are given for {law.pair}; give only one of them, or rename the particles"
            )
        found[i, j] = law
    return PairTable(spheres, walls, found)
