"""Second fragment of the export to LAMMPS, with damping models that its package KOKKOS supports.

LAMMPS 22Jul2025 has no KOKKOS variant of pair_style granular. Pull request 5187 adds a variant with
hooke and hertz normal forces, velocity-based damping, and linear and Mindlin tangential forces.
This variant needs the setting `newton off`. The older gran/hooke/history/kk has only one set of
values for all pairs of types.

Each pair gets a Hertz force with a constant damping coefficient (`damping velocity`,
`damping.hertz_damping`). Its coefficient of restitution e increases with the velocity V, because
the dimensionless damping g (`damping`) decreases as V^{−⅕}. If there is a single type of particle,
the fragment also offers a linear spring, whose e is constant. Its contact lasts as long as a Hertz
contact. In LAMMPS the damping force may be tensile until the overlap is zero, so the damping ratio
ζ gives e = exp(−πζ/(1 − ζ²)^½) (Schäfer, Dippel, Wolf, J. Phys. I France 6 (1996) 5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.damping import hertz_damping, hertz_restitution_at
from restitution.dem.export_common import Pair, contact_time
from restitution.dem.friction import mindlin_stiffness


@dataclass(frozen=True)
class VelocityDamping:
    """Hertz force with a constant `damping` coefficient (kg/s), chosen at `velocity` (m/s)."""

    pair: Pair
    velocity: float
    damping: float

    @property
    def normal_stiffness(self) -> float:
        """The coefficient Kn (Pa) of the style `hertz` of LAMMPS."""
        return 4 / 3 * self.pair.law.contact_modulus

    @property
    def tangential_stiffness(self) -> float:
        """The coefficient Kt (Pa) of the style `mindlin` of LAMMPS."""
        return mindlin_stiffness(self.pair)

    def restitution(self, share: float) -> float:
        """Return the coefficient of restitution at `share` times the velocity of the export."""
        return hertz_restitution_at(self.pair.law, self.damping, share * self.velocity)


@dataclass(frozen=True)
class LinearSpring:
    """The coefficients Kn (N/m) and gamma_n (1/s) of `gran/hooke/history` for a pair."""

    pair: Pair
    stiffness: float
    damping: float


def velocity_damping(pairs: list[Pair], velocity: float) -> list[VelocityDamping]:
    """Compute the damping that gives every pair the COR of its law at `velocity` (m/s)."""
    return [
        VelocityDamping(pair, velocity, hertz_damping(pair.law, velocity, pair.restitution))
        for pair in pairs
    ]


def linear_spring(pairs: list[Pair], velocity: float) -> LinearSpring | None:
    """Compute the linear spring of the only pair of spheres; None if there is not exactly one."""
    spheres = [pair for pair in pairs if not pair.wall]
    if len(spheres) != 1:
        return None
    (pair,) = spheres
    frequency = math.pi / (contact_time(pair.law) * velocity**-0.2)
    loss = -math.log(pair.restitution)
    ratio = loss / math.hypot(math.pi, loss)
    return LinearSpring(pair, pair.law.mass * frequency**2, 2 * ratio * frequency)
