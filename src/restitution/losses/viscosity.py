"""Internal friction of the bodies (Kuwabara and Kono 1987; Brilliantov et al. 1996)."""

from __future__ import annotations

from dataclasses import dataclass

# Dissipation time over tan δ and the duration of the impact: with it, F + A dF/dt loses the energy
# that a loss tangent equal at all frequencies takes from Hertz's pulse (docs/losses.md).
_OF_TANGENT = 0.2535


@dataclass(frozen=True)
class Friction:
    """Internal friction of one body: a relaxation time τ (s), or a loss tangent tan δ.

    τ is viscosity over modulus (Kelvin and Voigt). tan δ holds at the frequency 1/(2T) of an impact
    of duration T, and is taken as equal at all frequencies of the impact.
    """

    relaxation_time: float = 0.0
    loss_tangent: float = 0.0


@dataclass(frozen=True)
class Viscosity:
    """Two bodies whose contact resists with F + A dF/dt (dissipation time A).

    `bodies` has the friction of each body and its share of the compliance 1/E*.

    Source:
        G. Kuwabara, K. Kono, Jpn. J. Appl. Phys. 26, 1230 (1987); N. V. Brilliantov et al., Phys.
        Rev. E 53, 5382 (1996).
    """

    bodies: tuple[tuple[Friction, float], ...]

    @property
    def relaxation_time(self) -> float:
        """The part of A (s) that is the same for all impacts."""
        return sum(share * body.relaxation_time for body, share in self.bodies)

    @property
    def share_of_duration(self) -> float:
        """The part of A that grows with the duration of the impact, divided by it."""
        return _OF_TANGENT * sum(share * body.loss_tangent for body, share in self.bodies)
