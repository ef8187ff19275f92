"""Persson (2001): contact area of nominally flat elastic bodies with random roughness."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from ._inputs import Array, PositiveFields, Values, scalar_or_array, touching

_erf = np.vectorize(math.erf, otypes=[np.float64])


@dataclass(frozen=True, eq=False)
class Persson(PositiveFields):
    """Nominally flat elastic bodies with random roughness: A/A₀ = erf(√2 p/(E* h′)).

    At low pressure A/A₀ = κ p/(E* h′) with κ = √(8/π) = 1.60; numerical solutions have κ slightly
    above 2 (Prodanov, Dapp and Müser 2014, Tribol. Lett. 53, 433–448). Valid without adhesion and
    friction, for small slopes and roughness that spans many wavelengths.

    Attributes:
        rms_slope: Root mean square slope h′ of the composite roughness (dimensionless).
        contact_modulus: Contact modulus E* (Pa).

    Source:
        B. N. J. Persson, J. Chem. Phys. 115 (2001) 3840–3861, doi 10.1063/1.1388626.
    """

    rms_slope: Values
    contact_modulus: Values

    def relative_area(self, pressure: Values) -> Array:
        """Ratio of the real contact area to the nominal area (dimensionless)."""
        reduced = touching(pressure) / (self.contact_modulus * self.rms_slope)
        return scalar_or_array(_erf(math.sqrt(2) * reduced))

    def pressure_density(self, local: Values, pressure: Values) -> Array:
        """Distribution of the contact pressure, as a fraction of the nominal area per pressure.

        Args:
            local: Contact pressure p (Pa), positive.
            pressure: Nominal pressure p₀ (Pa).

        Returns:
            Density [exp(−(p − p₀)²/2s²) − exp(−(p + p₀)²/2s²)]/(s √(2π)) (1/Pa, SI), s = E* h′/2.
        """
        p, p_0 = np.asarray(local, dtype=float), np.asarray(touching(pressure), dtype=float)
        s = 0.5 * np.asarray(self.contact_modulus) * np.asarray(self.rms_slope)
        bells = np.exp(-0.5 * ((p - p_0) / s) ** 2) - np.exp(-0.5 * ((p + p_0) / s) ** 2)
        return scalar_or_array(bells / (math.sqrt(2 * math.pi) * s))
