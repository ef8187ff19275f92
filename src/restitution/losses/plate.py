"""Bending waves that an impact sends into a thin wall (Zener 1941)."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Plate:
    """An infinite plate, which moves at the velocity αF under a force F (`mobility` α).

    SI units. Valid while the contact lasts longer than waves need to cross the thickness
    (`round_trip`), and until bending waves return from an edge (`reach`).

    Source:
        C. Zener, Phys. Rev. 59, 669 (1941).
    """

    thickness: float
    youngs_modulus: float
    poissons_ratio: float
    density: float

    @property
    def mobility(self) -> float:
        """α = 1/(8 √(Dρh)) (m/(N s)), with the bending stiffness D = Eh³/(12 (1 − ν²))."""
        return 1 / (8 * math.sqrt(self._stiffness * self.density * self.thickness))

    @property
    def round_trip(self) -> float:
        """Time (s) of a compression wave across the thickness and back."""
        nu = self.poissons_ratio
        # M = E (1 − ν)/((1 + ν)(1 − 2ν)); an incompressible plate has no compression waves.
        softness = (1 + nu) * (1 - 2 * nu) / (1 - nu) / self.youngs_modulus
        return 2 * self.thickness * math.sqrt(self.density * max(softness, 0.0))

    def reach(self, duration: float) -> float:
        """Distance (m) of edges whose bending waves return within the `duration` (s) of a contact.

        The waves of frequency 1/(2 duration) run there and back at their group velocity
        2 (Dω²/(ρh))^¼.
        """
        omega = math.pi / duration
        speed: float = 2 * (self._stiffness * omega**2 / (self.density * self.thickness)) ** 0.25
        return 0.5 * speed * duration

    @property
    def _stiffness(self) -> float:
        return self.youngs_modulus * self.thickness**3 / (12 * (1 - self.poissons_ratio**2))
