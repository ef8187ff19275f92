"""A pair of particle types at the velocity of an export: its e, friction, moduli and times."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from restitution.errors import CaseError
from restitution.laws.law import FittedLaw, Law
from restitution.laws.particle import Particle
from restitution.theory import Hertz

# Factor on Mindlin's tangential stiffness (1949: 8 G* a): the edge of a real contact slides first,
# so the mean stiffness during an impact is smaller. In LAMMPS (`mindlin_rescale/force`), e_t of
# elastic spheres is then within 0.03 of `impacts.oblique` for ν from 0 to 0.45 and any angle; with
# the full stiffness it is up to 0.13 too large (evidence/oblique_stiffness).
STIFFNESS_SHARE = 0.8
FRICTION = 0.5  # coefficient of friction of pairs whose case gives none; users should replace it


@dataclass(frozen=True)
class ExportedPair:
    """A pair of particle types `i` ≤ `j`, with its e at the `velocity` (m/s) of an export."""

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
        """Contact time (s) of an elastic impact at `velocity`."""
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

        From E* = E/(2(1 − ν²)) and G* = E/(4(2 − ν)(1 + ν)).
        """
        k = self.shear_modulus / self.law.contact_modulus
        nu = min(max((1 - 4 * k) / (1 - 2 * k), 0.0), 0.5)
        return 2 * (1 - nu**2) * self.law.contact_modulus, nu

    def fitted(self, name: str) -> FittedLaw | None:
        """The force law `name` that was fitted to the law of the pair, or None."""
        return next((fit for fit in self.law.laws if fit.name == name), None)


def shear_modulus(first: Particle, second: Particle) -> float:
    """Mindlin's effective shear modulus G* (Pa) of two bodies."""
    return 1 / sum(
        2 * (2 - b.poissons_ratio) * (1 + b.poissons_ratio) / b.youngs_modulus
        for b in (first, second)
    )


def contact_time(law: Law, radius: float | None = None) -> float:
    """Contact time (s) of an elastic impact at 1 m/s; `radius` (m) replaces the R* of the law."""
    R = law.radius if radius is None else radius
    return float(Hertz(R, law.contact_modulus).duration(1.0, law.mass))


def adhesive_time(law: Law, force: float) -> float:
    """Half a period (s) on the stiffness at the indentation at which Hertz's force is `force`."""
    depth = float(Hertz(law.radius, law.contact_modulus).indentation(force))
    stiffness = 2 * law.contact_modulus * math.sqrt(law.radius * depth)
    return math.pi * math.sqrt(law.mass / stiffness)


def pull_off_force(law: Law, velocity: float) -> float:
    """Pull-off force (N) after an impact at `velocity` (m/s), linear in ln V; NaN if unknown."""
    V, forces = law.column("velocity"), law.column("pull_off_force")
    return float(np.interp(math.log(velocity), np.log(V), forces))


def unknown_pull_off(law: Law) -> CaseError:
    """The error of an export that needs the pull-off force of `law`."""
    return CaseError(
        f'{law.pair}: its pull-off force is not known; run the case with unloading.method = "path"'
    )
