"""A pair of particle types at the velocity of an export: its e, friction, moduli and times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.laws.law import FittedLaw, Law
from restitution.laws.particle import Particle

STIFFNESS_SHARE = 0.8  # factor on Mindlin's tangential stiffness; `Export.friction_note` says why
FRICTION = 0.5  # coefficient of friction of pairs whose case gives none; users should replace it


@dataclass(frozen=True)
class ExportedPair:
    """A pair of particle types `i` ≤ `j` in an export.

    `restitution` is e at `velocity` (m/s), which is the impact velocity of the export.
    """

    i: int
    j: int
    first: Particle
    second: Particle
    law: Law
    velocity: float
    restitution: float

    @property
    def wall(self) -> bool:
        """Whether the second body is a wall."""
        return self.second.wall

    @property
    def friction(self) -> float:
        """The coefficient of friction of the case, or the placeholder `FRICTION`."""
        return FRICTION if self.law.friction is None else self.law.friction

    @property
    def contact_time(self) -> float:
        """Contact time (s) of an elastic impact at the velocity of the export."""
        return float(contact_time(self.law) * self.velocity**-0.2)

    @property
    def shear_modulus(self) -> float:
        """Mindlin's effective shear modulus G* (Pa): 1/G* = Σ 2 (2 − ν)(1 + ν)/E of both bodies."""
        return shear_modulus(self.first, self.second)

    @property
    def mindlin_stiffness(self) -> float:
        """Mindlin's tangential stiffness divided by the contact radius: 8 G* (Pa)."""
        return 8 * self.shear_modulus

    @property
    def twin(self) -> tuple[float, float]:
        """E (Pa) and ν of a material that, used for both bodies, gives the E* and G* of this pair.

        E and ν follow from E* = E/(2(1 − ν²)) and G* = E/(4(2 − ν)(1 + ν)). ν lies between the
        Poisson's ratios of the two materials of the pair.
        """
        k = self.shear_modulus / self.law.contact_modulus
        nu = min(max((1 - 4 * k) / (1 - 2 * k), 0.0), 0.5)
        return 2 * (1 - nu**2) * self.law.contact_modulus, nu

    def fitted(self, name: str) -> FittedLaw | None:
        """Return the force law `name` that was fitted to the law of the pair, or None."""
        return next((fit for fit in self.law.laws if fit.name == name), None)


def shear_modulus(first: Particle, second: Particle) -> float:
    """Mindlin's effective shear modulus G* (Pa) of two bodies (`ExportedPair.shear_modulus`)."""
    return 1 / sum(
        2 * (2 - b.poissons_ratio) * (1 + b.poissons_ratio) / b.youngs_modulus
        for b in (first, second)
    )


def contact_time(law: Law, radius: float | None = None) -> float:
    """Contact time (s) of an elastic impact at 1 m/s.

    It is 2.87 (m*²/(R* E*² V))^⅕ with V = 1 m/s (Johnson 1985, eq. 11.24). `radius` (m),
    if given, replaces the R* of the law.
    """
    R = law.radius if radius is None else radius
    return float(2.87 * (law.mass**2 / (R * law.contact_modulus**2)) ** 0.2)


def pull_off_force(law: Law, velocity: float) -> float:
    """Pull-off force (N) after an impact at `velocity` (m/s).

    The force is interpolated between the computed points, linearly in the logarithm of the
    velocity. NaN if one of the two neighbouring points has no pull-off force.
    """
    V, forces = law.column("velocity"), law.column("pull_off_force")
    return float(np.interp(math.log(velocity), np.log(V), forces))
