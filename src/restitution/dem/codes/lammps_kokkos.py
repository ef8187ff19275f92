"""Second fragment of the export to LAMMPS, with damping models for LAMMPS' package KOKKOS.

LAMMPS 22Jul2025 has no KOKKOS variant of pair_style granular. Pull request 5187 adds a variant with
hooke and hertz normal forces, velocity-based damping, and linear and Mindlin tangential forces.
This variant needs the setting `newton off`. The older gran/hooke/history/kk has only one set of
values for all pairs of types.

Each pair gets a Hertz force with a constant damping coefficient (`damping velocity` in LAMMPS).
The function `hertz_damping` of the module `damping` computes the coefficient. In this model, the
coefficient of restitution e increases with the velocity V. The reason is that the dimensionless
damping g (defined in `damping`) is proportional to V^{−⅕}.

If there is a single type of particle, the fragment also offers a linear spring, whose e is
constant. A contact with this spring lasts as long as a Hertz contact. LAMMPS applies the damping
force until the overlap is zero, even if the total force is then tensile. Under this condition, the
damping ratio ζ gives e = exp(−πζ/(1 − ζ²)^½) (Schäfer, Dippel, Wolf, J. Phys. I France 6 (1996) 5).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from restitution.dem.damping import hertz_damping, hertz_restitution_at
from restitution.dem.pair import Pair


@dataclass(frozen=True)
class VelocityDamping:
    """Hertz force with a constant `damping` coefficient (kg/s) that gives the e of `pair`."""

    pair: Pair
    damping: float

    @property
    def normal_stiffness(self) -> float:
        """The coefficient Kn (Pa) of LAMMPS' normal model `hertz`."""
        return 4 / 3 * self.pair.law.contact_modulus

    def restitution(self, share: float) -> float:
        """Return COR at `share` times `pair.velocity`, the impact velocity of the export."""
        return hertz_restitution_at(self.pair.law, self.damping, share * self.pair.velocity)


def velocity_damping(pair: Pair) -> VelocityDamping:
    """Compute the damping of `pair` at the impact velocity for which the law is exported.

    With this damping, LAMMPS gives the coefficient of restitution of the law at this velocity.
    """
    return VelocityDamping(pair, hertz_damping(pair.law, pair.velocity, pair.restitution))


def linear_spring(pair: Pair) -> tuple[float, float]:
    """Coefficients Kn (N/m) and gamma_n (1/s) of `gran/hooke/history` that give the e of `pair`."""
    frequency = math.pi / pair.contact_time
    loss = -math.log(pair.restitution)
    ratio = loss / math.hypot(math.pi, loss)
    return pair.law.mass * frequency**2, 2 * ratio * frequency
