"""Waves that an impact sends into a thick wall (Lamb 1904; Miller and Pursey 1955)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property


@dataclass(frozen=True)
class HalfSpace:
    """An elastic half-space under a force F(t), which loses the energy γ∫Ḟ²dt (`radiation` γ).

    SI units. Valid while the contact is small beside the waves: V is far below the speed of sound.

    Source:
        H. Lamb, Phil. Trans. R. Soc. A 203, 1 (1904); G. F. Miller and H. Pursey, Proc. R. Soc. A
        233, 55 (1955). S. C. Hunter, J. Mech. Phys. Solids 5, 162 (1957) for Hertzian impacts.
    """

    youngs_modulus: float
    poissons_ratio: float
    density: float

    @property
    def radiation(self) -> float:
        """γ = (bulk + surface)/(2πρc_s³) (s/(kg/s)), with the speed of shear waves c_s."""
        shear = self.youngs_modulus / (2 * (1 + self.poissons_ratio))
        speed = math.sqrt(shear / self.density)
        return sum(self._parts) / (2 * math.pi * self.density * speed**3)

    @property
    def bulk_share(self) -> float:
        """Share of bulk waves in the lost energy; Rayleigh waves carry the rest."""
        bulk, surface = self._parts
        return bulk / (bulk + surface)

    @cached_property
    def _parts(self) -> tuple[float, float]:
        """Imaginary part of Lamb's integral ∫ ξ√(ξ² − n²)/R(ξ) dξ: of ξ < 1, and of the pole.

        ξ is the wave number over that of shear waves, n the ratio of the wave speeds, and R(ξ) =
        (2ξ² − 1)² − 4ξ²√(ξ² − n²)√(ξ² − 1).
        """
        from scipy.integrate import quad
        from scipy.optimize import brentq

        n2 = (1 - 2 * self.poissons_ratio) / (2 * (1 - self.poissons_ratio))
        n = math.sqrt(n2)

        def longitudinal(x: float) -> float:
            p, q = math.sqrt(n2 - x * x), math.sqrt(1 - x * x)
            return x * p / ((2 * x * x - 1) ** 2 + 4 * x * x * p * q)

        def shear(x: float) -> float:
            p2, q2 = x * x - n2, 1 - x * x
            return 4 * x**3 * p2 * math.sqrt(q2) / ((2 * x * x - 1) ** 4 + 16 * x**4 * p2 * q2)

        def rayleigh(x: float) -> float:
            return (2 * x * x - 1) ** 2 - 4 * x * x * math.sqrt((x * x - n2) * (x * x - 1))

        bulk = quad(longitudinal, 0, n)[0] + quad(shear, n, 1)[0]
        x = float(brentq(rayleigh, 1 + 1e-12, 2.0, xtol=1e-14))
        p, q = math.sqrt(x * x - n2), math.sqrt(x * x - 1)
        slope = 8 * x * (2 * x * x - 1) - 8 * x * p * q - 4 * x**3 * (p / q + q / p)
        return bulk, math.pi * x * p / abs(slope)
