"""MDR, the law of LAMMPS' `pair_style granular mdr`: one elastic, perfectly plastic contact.

W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492, in the form in which LAMMPS evaluates
it (read in its source, release 22Jul2025): one sphere of radius R on a rigid flat, here without
adhesion (`dgamma` 0) and damping. With x = δ_max/R, E* = E/(1 − ν²) and G = E/(2 + 2ν):

    pressure    p_Y = Y (1 + 1.75 exp(−4.4x)), the mean pressure of the yielded contact
    yield       at δ_Y, where Hertz's mean pressure 4E*(δ/R)^½/3π reaches p_Y
    loading     Hertz up to δ_Y, then  F = πp_Ya²,  a² = 2Rδ − δ² + δ_Y² − δ_YR
    unloading   an elliptical indenter 2a wide and A = 4p_Ya/E* high leaves the transformed half
                space; with d = A/2, the depth at full load, and its depth δ_e = ½A(1 − cos θ),
                F = ½E*Aa (θ − sin θ cos θ),  δ_e = d [1 − (δ_max − δ)/(d + δ_R)]
                δ_R = F_max [(1 − 2ν) z (s − z) − 2 (1 − ν) a²]/(2πGa²s),  z = R − δ_max + d,
                s² = a² + z²: the recovery of the sphere's finite body, negative
    work        W_u = (1 + δ_R/d) 8p_Y²a³/3E*;  W_l = ∫F dδ by quadrature
    impact      ½ m V² = W_l, e² = W_u/W_l; separation is where F returns to zero

Y is the yield strength of a tensile test; the contact stays elastic up to a mean pressure of almost
2.75 Y, a peak of 4.1 Y, and then is fully plastic at once. δ, R and m are those of the one sphere.
LAMMPS puts a flat between two spheres: two equal ones that approach at V are two impacts on a flat
at V/2, each with the radius and mass of one sphere. A flat that yields or bends is not in the law.

At yield the rebound changes at once from Hertz's to the ellipse's: e falls from 1 by a step of 5 %
or more (more for a greater Y/E*), rises a little, and then decreases with V. So it does in LAMMPS.

Left out of LAMMPS: the growth of the apparent radius by the displaced volume and the ellipse in
place of Hertz's parabola below δ_Y, both of relative order δ/R (with them e differs by 10⁻⁴ at
δ = 0.01 R), and the bulk response of spheres confined on all sides. NaN beyond δ = R.
Units, shapes and errors are those of `restitution.theory`; here a Poisson ratio that is not from 0
to ½ raises `CaseError` too, as LAMMPS refuses it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ._inputs import (
    Array,
    Values,
    keep_between,
    keep_positive,
    positive,
    scalar_or_array,
    touching,
)
from ._roots import increasing_root
from .hertz import Hertz

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)  # exact to rounding for a smooth law


@dataclass(frozen=True, eq=False)
class MDR:
    """One sphere of `radius` R (m), `youngs_modulus` E and `yield_strength` Y (Pa) on a rigid flat.

    `poissons_ratio` ν is from 0 to ½.
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
        """The contact up to yield."""
        return Hertz(self.radius, self.youngs_modulus / (1 - self.poissons_ratio**2))

    def yield_pressure(self, indentation: Values) -> Array:
        """Mean pressure p_Y (Pa) of a yielded contact: 2.75 Y at first, falling to Y."""
        d = touching(indentation)
        return self.yield_strength * (1 + 1.75 * np.exp(-4.4 * d / self.radius))

    @cached_property
    def yield_indentation(self) -> Array:
        """Indentation δ_Y (m) at which the mean Hertz pressure reaches `yield_pressure`.

        s²R with s the root of s = c (1 + 1.75 exp(−4.4s²)), c = 3πY/4E*.
        """
        nu = self.poissons_ratio
        c = 0.75 * np.pi * self.yield_strength * (1 - nu**2) / self.youngs_modulus
        s = increasing_root(lambda s: s - c * (1 + 1.75 * np.exp(-4.4 * s**2)), c, 2.75 * c)
        return scalar_or_array(s**2 * self.radius)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force (N) on first loading; NaN beyond δ = R."""
        return scalar_or_array(self._force(self._inside(indentation)))

    def loading_work(self, indentation: Values) -> Array:
        """Work W_l = ∫F dδ (J) done from first touch to `indentation` on first loading.

        Hertz's up to δ_Y, Gauss–Legendre quadrature beyond; NaN beyond δ = R.
        """
        return scalar_or_array(self._work(self._inside(indentation)))

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

        Zero at and below `residual_indentation`. Above `maximum_indentation` the contact is loading
        again, and the force is `loading_force`. NaN beyond δ = R.
        """
        d, d_max = self._inside(indentation), self._inside(maximum_indentation)
        left = np.clip((d_max - d) / self._recovery(d_max), 0.0, 1.0)
        theta = np.arccos(left)  # δ_e/d = 1 − cos θ
        relative = (theta - np.sin(theta) * np.cos(theta)) * 2 / np.pi
        onwards = (d > d_max) | (d_max <= self.yield_indentation)
        return scalar_or_array(np.where(onwards, self._force(d), relative * self._force(d_max)))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation δ_max − (d + δ_R) (m) at which unloading ends; 0 if none yielded."""
        d = self._inside(maximum_indentation)
        return scalar_or_array(np.where(d <= self.yield_indentation, 0.0, d - self._recovery(d)))

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work W_u (J) given back from `maximum_indentation` to separation; W_l if none yielded."""
        return scalar_or_array(self._returned(self._inside(maximum_indentation)))

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation (m) of an impact at normal `velocity` (m/s); NaN where beyond R."""
        (m,) = positive(mass=mass)
        K = 0.5 * m * touching(velocity) ** 2
        d = increasing_root(lambda d: self._work(d) - K, 0 * K, self.radius)
        d = np.where(self._work(self.radius) < K, np.nan, d)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution e = (W_u/W_l)^½ of one sphere that meets a rigid flat.

        `velocity` (m/s) and `mass` (kg) are the sphere's; for two equal spheres give half their
        relative velocity. 1 up to yield; NaN where the indentation would exceed the radius.
        """
        d, d_Y = self.indentation_from_velocity(velocity, mass), self.yield_indentation
        e = (self._returned(d) / self._work(np.maximum(d, d_Y))) ** 0.5
        return scalar_or_array(np.where(d <= d_Y, 1.0, np.minimum(e, 1.0)))

    def _inside(self, indentation: Values) -> Array:
        """δ (m), zero where nothing touches and NaN beyond R."""
        d = touching(indentation)
        return np.where(d > self.radius, np.nan, d)

    def _contact_radius(self, d: Values) -> Array:
        """a (m) of the yielded contact, Hertz's at yield and held there below."""
        R, d_Y = self.radius, self.yield_indentation
        t = touching(d - d_Y)
        a: Array = (R * d_Y + t * (2 * (R - d_Y) - t)) ** 0.5
        return a

    def _force(self, d: Values) -> Array:
        """F (N) on first loading."""
        plastic = np.pi * self._contact_radius(d) ** 2 * self.yield_pressure(d)
        return np.where(d <= self.yield_indentation, self.elastic.force(d), plastic)

    def _work(self, d: Values) -> Array:
        """W_l (J)."""
        d_Y = self.yield_indentation
        half = touching(d - d_Y) / 2
        forces = sum(
            w * self._force(d_Y + half * (1 + node))
            for w, node in zip(_WEIGHTS, _NODES, strict=True)
        )
        return self.elastic.stored_energy(np.minimum(d, d_Y)) + half * forces

    def _elastic_depth(self, d: Values) -> Array:
        """d = A/2 (m), the transformed depth at full load."""
        return 2 * self.yield_pressure(d) * self._contact_radius(d) / self.elastic.contact_modulus

    def _recovery(self, d: Values) -> Array:
        """d + δ_R (m); F_max/(2πGa²d) = E*/(4Ga) = 1/(2a(1 − ν))."""
        a, d_e, nu = self._contact_radius(d), self._elastic_depth(d), self.poissons_ratio
        z = self.radius - d + d_e
        s = (a**2 + z**2) ** 0.5
        grip = (1 - 2 * nu) * z * (s - z) - 2 * (1 - nu) * a**2
        recovery: Array = d_e * (1 + grip / (2 * (1 - nu) * a * s))
        return recovery

    def _returned(self, d: Values) -> Array:
        """W_u (J): (1 + δ_R/d) E*A²B/12 with the indenter's height A = 2d and width B = 2a."""
        E_star = self.elastic.contact_modulus
        plastic = 2 / 3 * E_star * self._elastic_depth(d) * self._contact_radius(d)
        elastic = self.elastic.stored_energy(d)
        return np.where(d <= self.yield_indentation, elastic, plastic * self._recovery(d))
