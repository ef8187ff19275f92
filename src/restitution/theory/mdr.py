"""MDR: LAMMPS' `pair_style granular mdr` for one contact of an elastic, perfectly plastic sphere.

W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492, as implemented in the source of
LAMMPS (release 22Jul2025). The law describes one sphere on a rigid flat, here without adhesion
(`dgamma` = 0) and without damping. δ is the indentation of the sphere, R its radius, m its mass and
V its impact velocity. E is Young's modulus, ν Poisson's ratio and Y the yield strength of a tensile
test. MDR stands for method of dimensionality reduction: the elastic half-space is replaced by a row
of independent springs, which is called the transformed half-space. With x = δ_max/R,
E* = E/(1 − ν²) and G = E/(2 + 2ν):

    pressure    p_Y = Y (1 + 1.75 exp(−4.4x)), the mean pressure of the yielded contact
    yield       at δ_Y, where Hertz's mean pressure 4E*(δ/R)^½/3π reaches p_Y
    loading     Hertz up to δ_Y, then  F = πp_Ya²,  a² = 2Rδ − δ² + δ_Y² − δ_YR
    unloading   An elliptical indenter of width 2a and height A = 4p_Ya/E* is pulled out of the
                transformed half-space. The penetration δ_e of the indenter starts at d_e = A/2
                under full load and falls as δ_e = ½A(1 − cos θ):
                F = ½E*Aa (θ − sin θ cos θ),  δ_e = d_e [1 − (δ_max − δ)/(d_e + δ_R)]
                The elastic recovery of the sphere is d_e + δ_R, where δ_R < 0 is a correction for
                the finite size of the sphere:
                δ_R = F_max [(1 − 2ν) z (s − z) − 2 (1 − ν) a²]/(2πGa²s),  z = R − δ_max + d_e,
                s² = a² + z²
    work        W_u = (1 + δ_R/d_e) 8p_Y²a³/3E*;  W_l = ∫F dδ by quadrature
    impact      ½ m V² = W_l, e² = W_u/W_l; the contact ends where F returns to zero

The contact stays elastic up to a mean pressure of almost 2.75 Y (a peak of 4.1 Y) and is then fully
plastic at once. If two spheres collide, LAMMPS places a rigid flat between them. Each of two equal
spheres hits this flat with half of the relative velocity. The law cannot describe a deformable
flat.

At yield the rebound changes abruptly from Hertz to the elliptical indenter. So e drops from 1 by at
least 5 %, and by more for a larger Y/E*. As V grows further, e first rises a little and then
decreases. LAMMPS shows the same behaviour.

These parts of the LAMMPS implementation are left out:

- The displaced volume increases the apparent radius of the sphere.
- Below δ_Y, LAMMPS uses an ellipse in place of Hertz's parabola.
- Spheres confined on all sides have a bulk response.

The first two effects are of relative order δ/R; they change e by 10⁻⁴ at δ = 0.01 R.

The result is NaN for δ > R.
Units, shapes and errors are those of `restitution.theory`.
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
    """Impact of one sphere on a rigid flat with the MDR law.

    The fields and arguments may be arrays and broadcast (see `restitution.theory`).

    Attributes:
        radius: Radius R of the sphere (m).
        youngs_modulus: Young's modulus E (Pa).
        poissons_ratio: Poisson's ratio ν (dimensionless), from 0 to ½ as in LAMMPS.
        yield_strength: Yield strength Y of a tensile test (Pa).

    Raises:
        CaseError: A field is not positive and finite, or Poisson's ratio is not from 0 to ½.

    Source:
        W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492.
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
        """Mean pressure of the yielded contact.

        As the indentation grows, the pressure falls from 2.75 times the yield strength Y towards Y.

        Args:
            indentation: Indentation δ of the sphere (m).

        Returns:
            Mean pressure p_Y (Pa).
        """
        falling = np.exp(-4.4 * touching(indentation) / self.radius)
        return self.yield_strength * (1 + 1.75 * falling)

    @cached_property
    def yield_indentation(self) -> Array:
        """Indentation δ_Y (m) at which the mean Hertz pressure reaches `yield_pressure`.

        With the contact modulus E*, δ_Y = s²R, where s is the root of
        s = c (1 + 1.75 exp(−4.4s²)) with c = 3πY/4E*.
        """
        nu = self.poissons_ratio
        c = 0.75 * np.pi * self.yield_strength * (1 - nu**2) / self.youngs_modulus
        s = increasing_root(lambda s: s - c * (1 + 1.75 * np.exp(-4.4 * s**2)), c, 2.75 * c)
        return scalar_or_array(s**2 * self.radius)

    def loading_force(self, indentation: Values) -> Array:
        """Normal force on first loading.

        Args:
            indentation: Indentation δ of the sphere (m).

        Returns:
            Normal force F (N); NaN if the indentation exceeds the radius of the sphere.
        """
        return scalar_or_array(self._force(self._inside(indentation)))

    def loading_work(self, indentation: Values) -> Array:
        """Work done from first touch to an indentation on first loading.

        Up to `yield_indentation` the work is the elastic energy of the Hertz contact. Beyond
        `yield_indentation` the force is integrated by Gauss–Legendre quadrature.

        Args:
            indentation: Indentation δ of the sphere (m).

        Returns:
            Loading work W_l = ∫F dδ (J); NaN if the indentation exceeds the radius of the sphere.
        """
        return scalar_or_array(self._work(self._inside(indentation)))

    def unloading_force(self, indentation: Values, maximum_indentation: Values) -> Array:
        """Normal force on unloading after first loading to `maximum_indentation`.

        Above `maximum_indentation` the force is `loading_force`.

        Args:
            indentation: Indentation δ of the sphere (m).
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Normal force F (N); 0 at and below `residual_indentation`, NaN if an indentation exceeds
            the radius of the sphere.
        """
        d, d_max = self._inside(indentation), self._inside(maximum_indentation)
        left = np.clip((d_max - d) / self._recovery(d_max), 0.0, 1.0)
        theta = np.arccos(left)  # `left` is cos θ: the recovery is proportional to 1 − cos θ
        relative = (theta - np.sin(theta) * np.cos(theta)) * 2 / np.pi
        onwards = (d > d_max) | (d_max <= self.yield_indentation)
        return scalar_or_array(np.where(onwards, self._force(d), relative * self._force(d_max)))

    def residual_indentation(self, maximum_indentation: Values) -> Array:
        """Indentation at which unloading ends.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Residual indentation (m), which is δ_max minus the elastic recovery; 0 up to yield.
        """
        d = self._inside(maximum_indentation)
        return scalar_or_array(np.where(d <= self.yield_indentation, 0.0, d - self._recovery(d)))

    def unloading_work(self, maximum_indentation: Values) -> Array:
        """Work that the contact returns on unloading from `maximum_indentation` to separation.

        Args:
            maximum_indentation: Indentation δ_max at which unloading began (m).

        Returns:
            Unloading work W_u (J); up to yield it equals the loading work.
        """
        return scalar_or_array(self._returned(self._inside(maximum_indentation)))

    def indentation_from_velocity(self, velocity: Values, mass: Values) -> Array:
        """Largest indentation of an impact on the flat.

        Args:
            velocity: Normal impact velocity V of the sphere (m/s).
            mass: Mass m of the sphere (kg).

        Returns:
            Indentation δ (m); NaN if it would exceed the radius of the sphere.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        K = impact_energy(velocity, mass)
        d = increasing_root(lambda d: self._work(d) - K, 0 * K, self.radius)
        d = np.where(self._work(self.radius) < K, np.nan, d)
        return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))

    def restitution(self, velocity: Values, mass: Values) -> Array:
        """Coefficient of restitution of the sphere after an impact on the flat.

        Args:
            velocity: Normal impact velocity V of the sphere (m/s). For two equal spheres, give half
                of their relative velocity.
            mass: Mass m of the sphere (kg).

        Returns:
            Coefficient of restitution e = (W_u/W_l)^½ (dimensionless), with the unloading work W_u
            and the loading work W_l; 1 up to yield, NaN if the indentation would exceed the radius
            of the sphere.

        Raises:
            CaseError: `mass` is not positive and finite.
        """
        d, d_Y = self.indentation_from_velocity(velocity, mass), self.yield_indentation
        e = (self._returned(d) / self._work(np.maximum(d, d_Y))) ** 0.5
        return scalar_or_array(np.where(d <= d_Y, 1.0, np.minimum(e, 1.0)))

    def _inside(self, indentation: Values) -> Array:
        """Indentation δ (m), with negative values set to 0 and values above the radius to NaN."""
        d = touching(indentation)
        return np.where(d > self.radius, np.nan, d)

    def _contact_radius(self, d: Values) -> Array:
        """Contact radius a (m) of the yielded contact at the indentation `d`.

        Up to `yield_indentation`, the result is the value at `yield_indentation`.
        """
        R, d_Y = self.radius, self.yield_indentation
        t = touching(d - d_Y)
        return (R * d_Y + t * (2 * (R - d_Y) - t)) ** 0.5

    def _force(self, d: Values) -> Array:
        """Normal force F (N) at the indentation `d` on first loading."""
        plastic = np.pi * self._contact_radius(d) ** 2 * self.yield_pressure(d)
        return np.where(d <= self.yield_indentation, self.elastic.force(d), plastic)

    def _work(self, d: Values) -> Array:
        """Loading work W_l (J) to the indentation `d`."""
        d_Y = self.yield_indentation
        half = touching(d - d_Y) / 2
        nodes = _NODES.reshape(-1, *(1 for _ in np.shape(half)))  # in front of all other axes
        forces = np.tensordot(_WEIGHTS, self._force(d_Y + half * (1 + nodes)), axes=1)
        return self.elastic.stored_energy(np.minimum(d, d_Y)) + half * forces

    def _elastic_depth(self, d: Values) -> Array:
        """Penetration d_e (m) of the indenter into the transformed half-space at full load.

        d_e is half the height of the elliptical indenter. `d` is the indentation of the sphere.
        """
        return 2 * self.yield_pressure(d) * self._contact_radius(d) / self.elastic.contact_modulus

    def _recovery(self, d: Values) -> Array:
        """Elastic recovery d_e + δ_R (m) on unloading from the indentation `d`.

        d_e is the penetration of the indenter at full load (`_elastic_depth`). δ_R is a correction
        for the finite size of the sphere. The code uses the identity
        F_max/(2πGa²) = d_e/(2a(1 − ν)).
        """
        a, d_e, nu = self._contact_radius(d), self._elastic_depth(d), self.poissons_ratio
        z = self.radius - d + d_e
        s = (a**2 + z**2) ** 0.5
        grip = (1 - 2 * nu) * z * (s - z) - 2 * (1 - nu) * a**2
        return d_e * (1 + grip / (2 * (1 - nu) * a * s))

    def _returned(self, d: Values) -> Array:
        """Unloading work W_u (J) from the indentation `d`.

        Up to yield W_u is the energy of the Hertz contact. Beyond yield
        W_u = (1 + δ_R/d_e) E*A²B/12, where A = 2d_e is the height of the elliptical indenter and
        B = 2a is its width. `_recovery` explains d_e, δ_R and the elastic recovery d_e + δ_R.
        """
        E_star = self.elastic.contact_modulus
        plastic = 2 / 3 * E_star * self._elastic_depth(d) * self._contact_radius(d)
        elastic = self.elastic.stored_energy(d)
        return np.where(d <= self.yield_indentation, elastic, plastic * self._recovery(d))
