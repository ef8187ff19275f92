"""LAMMPS' `pair_style granular mdr` for one contact of an elastic, perfectly plastic sphere."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import (
    Array,
    Values,
    keep_between,
    keep_positive,
    scalar_or_array,
    touching,
)
from ._roots import increasing_root
from .hertz import Hertz
from .law import impact_energy

# With 16 nodes, the error of the loading work is not larger than rounding errors.
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


@dataclass(frozen=True, eq=False)
class MDR:
    """One sphere on a rigid flat as in LAMMPS' `pair_style granular mdr`, dry and without damping.

    First loading is Hertz up to δ_Y, where the mean pressure reaches p_Y; then F = πp_Ya² with a² =
    2Rδ − δ² + δ_Y² − δ_YR. On unloading, an elliptical indenter of width 2a is pulled out of a row
    of independent springs. At yield the rebound changes abruptly, so e drops from 1 by at least 5
    %, as in LAMMPS. Between two spheres LAMMPS places a rigid flat.

    Left out: the apparent radius from displaced volume and the ellipse below δ_Y (both of order
    δ/R; 10⁻⁴ in e at δ = 0.01 R), and the bulk response. The result is NaN for δ > R.

    Attributes:
        radius: Radius R of the sphere (m).
        youngs_modulus: Young's modulus E (Pa).
        poissons_ratio: Poisson's ratio ν (dimensionless), from 0 to ½ as in LAMMPS.
        yield_strength: Yield strength Y of a tensile test (Pa).

    Source:
        W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492; LAMMPS, release 22Jul2025.
    """

    radius: Values
    youngs_modulus: Values
    poissons_ratio: Values
    yield_strength: Values

    def __post_init__(self) -> None:
        keep_positive(self, "radius", "youngs_modulus", "yield_strength")
        keep_between(self, "poissons_ratio", 0.0, 0.5)

    @cached_property
    def elastic(self) -> Hertz:
        """Hertz contact that the law follows up to yield."""
        return Hertz(self.radius, self.youngs_modulus / (1 - self.poissons_ratio**2))

    def yield_pressure(self, indentation: Values) -> Array:
        """Mean pressure p_Y = Y (1 + 1.75 exp(−4.4δ/R)) (Pa) of the yielded contact."""
        falling = np.exp(-4.4 * touching(indentation) / self.radius)
        return self.yield_strength * (1 + 1.75 * falling)

    @cached_property
    def yield_indentation(self) -> Array:
        """Indentation δ_Y (m) at which the mean Hertz pressure reaches `yield_pressure`."""
        nu = self.poissons_ratio
        c = 0.75 * np.pi * self.yield_strength * (1 - nu**2) / self.youngs_modulus
        s = increasing_root(lambda s: s - c * (1 + 1.75 * np.exp(-4.4 * s**2)), c, 2.75 * c)
        return scalar_or_array(s**2 * self.radius)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force F (N) on first loading."""
        return scalar_or_array(self._force(self._inside(indentation)))

    def loading_work(self, indentation: Values) -> Array:
        """Loading work W_l = ∫F dδ (J)."""
        return scalar_or_array(self._work(self._inside(indentation)))

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force F (N) on unloading from `maximum_indentation`; above it, `loading_force`."""
        d, d_max = self._inside(indentation), self._inside(maximum_indentation)
        left = np.clip((d_max - d) / self._recovery(d_max), 0.0, 1.0)
        theta = np.arccos(left)  # `left` is cos θ: the recovery is proportional to 1 − cos θ
        relative = (theta - np.sin(theta) * np.cos(theta)) * 2 / np.pi
        onwards = (d > d_max) | (d_max <= self.yield_indentation)
        return scalar_or_array(np.where(onwards, self._force(d), relative * self._force(d_max)))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation (m) at which unloading ends; 0 up to yield."""
        d = self._inside(maximum_indentation)
        return scalar_or_array(np.where(d <= self.yield_indentation, 0.0, d - self._recovery(d)))

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) returned on unloading to separation."""
        return scalar_or_array(self._returned(self._inside(maximum_indentation)))

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation δ (m) of an impact of the sphere, with its own velocity and mass."""
        K = impact_energy(velocity, mass)
        d = increasing_root(lambda d: self._work(d) - K, 0 * K, self.radius)
        d = np.where(self._work(self.radius) < K, np.nan, d)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution of the sphere after an impact on the flat.

        Args:
            velocity: Normal impact velocity V of the sphere (m/s); for two equal spheres, half of
                their relative velocity.
            mass: Mass m of the sphere (kg).

        Returns:
            Coefficient of restitution e = (W_u/W_l)^½ (dimensionless).
        """
        d, d_Y = self.indentation_from_velocity(velocity, mass), self.yield_indentation
        e = (self._returned(d) / self._work(np.maximum(d, d_Y))) ** 0.5
        return scalar_or_array(np.where(d <= d_Y, 1.0, np.minimum(e, 1.0)))

    def _inside(self, indentation: Values) -> Array:
        d = touching(indentation)
        return np.where(d > self.radius, np.nan, d)

    def _contact_radius(self, d: Values) -> Array:
        """Contact radius a (m) of the yielded contact, at least its value at first yield."""
        R, d_Y = self.radius, self.yield_indentation
        t = touching(d - d_Y)
        return (R * d_Y + t * (2 * (R - d_Y) - t)) ** 0.5

    def _force(self, d: Values) -> Array:
        plastic = np.pi * self._contact_radius(d) ** 2 * self.yield_pressure(d)
        return np.where(d <= self.yield_indentation, self.elastic.force(d), plastic)

    def _work(self, d: Values) -> Array:
        d_Y = self.yield_indentation
        half = touching(d - d_Y) / 2
        nodes = _NODES.reshape(-1, *(1 for _ in np.shape(half)))  # in front of all other axes
        forces = np.tensordot(_WEIGHTS, self._force(d_Y + half * (1 + nodes)), axes=1)
        return self.elastic.stored_energy(np.minimum(d, d_Y)) + half * forces

    def _elastic_depth(self, d: Values) -> Array:
        """Penetration d_e (m) of the indenter at full load, half the height of the ellipse."""
        return 2 * self.yield_pressure(d) * self._contact_radius(d) / self.elastic.contact_modulus

    def _recovery(self, d: Values) -> Array:
        """Elastic recovery d_e + δ_R (m), with the correction δ_R for the size of the sphere.

        δ_R = F_max [(1 − 2ν) z (s − z) − 2 (1 − ν) a²]/(2πGa²s), z = R − δ_max + d_e, s² = a² + z²,
        where F_max/(2πGa²) = d_e/(2a(1 − ν)).
        """
        a, d_e, nu = self._contact_radius(d), self._elastic_depth(d), self.poissons_ratio
        z = self.radius - d + d_e
        s = (a**2 + z**2) ** 0.5
        grip = (1 - 2 * nu) * z * (s - z) - 2 * (1 - nu) * a**2
        return d_e * (1 + grip / (2 * (1 - nu) * a * s))

    def _returned(self, d: Values) -> Array:
        """Unloading work W_u (J); beyond yield (1 + δ_R/d_e) E*A²B/12 with A = 2d_e and B = 2a."""
        E_star = self.elastic.contact_modulus
        plastic = 2 / 3 * E_star * self._elastic_depth(d) * self._contact_radius(d)
        elastic = self.elastic.stored_energy(d)
        return np.where(d <= self.yield_indentation, elastic, plastic * self._recovery(d))
