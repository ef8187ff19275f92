"""Damping that KOKKOS has, as a second fragment of the export to LAMMPS.

LAMMPS 22Jul2025 has no KOKKOS variant of pair_style granular. The one of pull request 5187 has
hooke and hertz normal forces with velocity-based damping, linear and Mindlin tangential forces, and
needs newton off. gran/hooke/history/kk is older; it has one set of values for all pairs of types.

For each pair: Hertz with a constant damping coefficient (`damping velocity`,
`damping.hertz_damping`), whose e increases with the velocity as g ∝ V^{−⅕} decreases. For a single
type of particle, besides, a linear spring whose e is constant: its contact lasts as long as
Hertz's, and LAMMPS lets the damping pull until the overlap is zero, so that e = exp(−πζ/(1 −
ζ²)^½) (Schäfer, Dippel, Wolf, J. Phys. I France 6 (1996) 5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.damping import hertz_damping, hertz_restitution_at
from restitution.dem.export_common import Pair, contact_time


@dataclass(frozen=True)
class VelocityDamping:
    """Hertz with a constant damping coefficient (kg/s) for a pair, at `velocity` (m/s)."""

    pair: Pair
    velocity: float
    damping: float

    @property
    def normal_stiffness(self) -> float:
        """LAMMPS' Kn (Pa) of hertz."""
        return 4 / 3 * self.pair.law.contact_modulus

    @property
    def tangential_stiffness(self) -> float:
        """LAMMPS' Kt (Pa) of mindlin."""
        return 8 * self.pair.shear_modulus

    def restitution(self, share: float) -> float:
        """The e at `share` of the velocity of the export."""
        return hertz_restitution_at(self.pair.law, self.damping, share * self.velocity)


@dataclass(frozen=True)
class LinearSpring:
    """Kn (N/m) and gamma_n (1/s) of gran/hooke/history for a pair."""

    pair: Pair
    stiffness: float
    damping: float


def velocity_damping(pairs: list[Pair], velocity: float) -> list[VelocityDamping]:
    """The damping of every pair that returns its e at `velocity` (m/s)."""
    return [
        VelocityDamping(pair, velocity, hertz_damping(pair.law, velocity, pair.restitution))
        for pair in pairs
    ]


def linear_spring(pairs: list[Pair], velocity: float) -> LinearSpring | None:
    """The linear spring of the only pair of spheres; None where there are several, or none."""
    spheres = [pair for pair in pairs if not pair.wall]
    if len(spheres) != 1:
        return None
    (pair,) = spheres
    frequency = math.pi / (contact_time(pair.law) * velocity**-0.2)
    loss = -math.log(pair.restitution)
    ratio = loss / math.hypot(math.pi, loss)
    return LinearSpring(pair, pair.law.mass * frequency**2, 2 * ratio * frequency)
