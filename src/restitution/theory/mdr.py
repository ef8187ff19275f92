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

import numpy as np

from . import hertz
from ._inputs import Array, Values, between, positive, scalar_or_array, touching
from ._roots import increasing_root

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)  # exact to rounding for a smooth law


def yield_pressure(indentation: Values, radius: Values, yield_strength: Values) -> Array:
    """Mean pressure p_Y (Pa) of a yielded contact: 2.75 Y at first, falling to Y as it deepens."""
    R, Y = positive(radius=radius, yield_strength=yield_strength)
    return Y * (1 + 1.75 * np.exp(-4.4 * touching(indentation) / R))


def yield_indentation(
    radius: Values, youngs_modulus: Values, poissons_ratio: Values, yield_strength: Values
) -> Array:
    """Indentation δ_Y (m) at which the mean Hertz pressure reaches `yield_pressure`.

    s²R with s the root of s = c (1 + 1.75 exp(−4.4s²)), c = 3πY/4E*.
    """
    (E,) = positive(youngs_modulus=youngs_modulus)
    (nu,) = between(0.0, 0.5, poissons_ratio=poissons_ratio)
    R, Y = positive(radius=radius, yield_strength=yield_strength)
    c = 0.75 * np.pi * Y * (1 - nu**2) / E
    s = increasing_root(lambda s: s - c * (1 + 1.75 * np.exp(-4.4 * s**2)), c, 2.75 * c)
    return scalar_or_array(s**2 * R)


def loading_force(
    indentation: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
) -> Array:
    """Normal force (N) on first loading; NaN beyond δ = R."""
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    return scalar_or_array(sphere.force(sphere.depth(indentation)))


def loading_work(
    indentation: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
) -> Array:
    """Work W_l = ∫F dδ (J) done from first touch to `indentation` on first loading.

    Hertz's up to δ_Y, Gauss–Legendre quadrature beyond; NaN beyond δ = R.
    """
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    return scalar_or_array(sphere.work(sphere.depth(indentation)))


def unloading_force(
    indentation: Values,
    maximum_indentation: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
) -> Array:
    """Normal force (N) at `indentation` after first loading to `maximum_indentation` (both m).

    Zero at and below `residual_indentation`. Above `maximum_indentation` the contact is loading
    again, and the force is `loading_force`. NaN beyond δ = R.
    """
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    d, d_max = sphere.depth(indentation), sphere.depth(maximum_indentation)
    left = np.clip((d_max - d) / sphere.recovery(d_max), 0.0, 1.0)
    theta = np.arccos(left)  # δ_e/d = 1 − cos θ
    relative = (theta - np.sin(theta) * np.cos(theta)) * 2 / np.pi
    onwards = (d > d_max) | (d_max <= sphere.depth_at_yield)
    return scalar_or_array(np.where(onwards, sphere.force(d), relative * sphere.force(d_max)))


def residual_indentation(
    maximum_indentation: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
) -> Array:
    """Indentation δ_max − (d + δ_R) (m) at which unloading ends; 0 if none yielded."""
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    d_max = sphere.depth(maximum_indentation)
    return scalar_or_array(
        np.where(d_max <= sphere.depth_at_yield, 0.0, d_max - sphere.recovery(d_max))
    )


def unloading_work(
    maximum_indentation: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
) -> Array:
    """Work W_u (J) given back from `maximum_indentation` to separation; W_l if none yielded."""
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    return scalar_or_array(sphere.returned(sphere.depth(maximum_indentation)))


def indentation_from_velocity(
    velocity: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
    mass: Values,
) -> Array:
    """Largest indentation (m) of an impact at normal `velocity` (m/s); NaN where beyond δ = R."""
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    (m,) = positive(mass=mass)
    K = 0.5 * m * touching(velocity) ** 2
    d = increasing_root(lambda d: sphere.work(d) - K, 0 * K, sphere.R)
    d = np.where(sphere.work(sphere.R) < K, np.nan, d)
    return scalar_or_array(np.where(np.asarray(velocity) <= 0, 0.0, d))


def restitution(
    velocity: Values,
    radius: Values,
    youngs_modulus: Values,
    poissons_ratio: Values,
    yield_strength: Values,
    mass: Values,
) -> Array:
    """Coefficient of restitution e = (W_u/W_l)^½ of one sphere that meets a rigid flat.

    `velocity` (m/s), `radius` (m) and `mass` (kg) are the sphere's; for two equal spheres give half
    their relative velocity. 1 up to yield; NaN where the indentation would exceed the radius.
    """
    sphere = _sphere(radius, youngs_modulus, poissons_ratio, yield_strength)
    material = radius, youngs_modulus, poissons_ratio, yield_strength
    d = indentation_from_velocity(velocity, *material, mass)
    e = (sphere.returned(d) / sphere.work(np.maximum(d, sphere.depth_at_yield))) ** 0.5
    return scalar_or_array(np.where(d <= sphere.depth_at_yield, 1.0, np.minimum(e, 1.0)))


@dataclass(frozen=True)
class _Sphere:
    """The law of one sphere at depths δ ≤ R already checked."""

    R: Array
    E_star: Array
    nu: Array
    Y: Array
    depth_at_yield: Array

    def depth(self, indentation: Values) -> Array:
        """δ (m), zero where nothing touches and NaN beyond R."""
        d = touching(indentation)
        return np.where(d > self.R, np.nan, d)

    def pressure(self, d: Array) -> Array:
        """p_Y (Pa)."""
        return yield_pressure(d, self.R, self.Y)

    def contact_radius(self, d: Array) -> Array:
        """a (m) of the yielded contact, Hertz's at yield and held there below."""
        t = touching(d - self.depth_at_yield)
        a: Array = (
            self.R * self.depth_at_yield + t * (2 * (self.R - self.depth_at_yield) - t)
        ) ** 0.5
        return a

    def force(self, d: Array) -> Array:
        """F (N) on first loading."""
        plastic = np.pi * self.contact_radius(d) ** 2 * self.pressure(d)
        return np.where(d <= self.depth_at_yield, hertz.force(d, self.R, self.E_star), plastic)

    def work(self, d: Array) -> Array:
        """W_l (J)."""
        half = touching(d - self.depth_at_yield) / 2
        depths = (self.depth_at_yield + half * (1 + node) for node in _NODES)
        forces = sum(w * self.force(x) for w, x in zip(_WEIGHTS, depths, strict=True))
        return (
            hertz.stored_energy(np.minimum(d, self.depth_at_yield), self.R, self.E_star)
            + half * forces
        )

    def elastic_depth(self, d: Array) -> Array:
        """d = A/2 (m), the transformed depth at full load."""
        return 2 * self.pressure(d) * self.contact_radius(d) / self.E_star

    def recovery(self, d: Array) -> Array:
        """d + δ_R (m); F_max/(2πGa²d) = E*/(4Ga) = 1/(2a(1 − ν))."""
        a, d_e = self.contact_radius(d), self.elastic_depth(d)
        z = self.R - d + d_e
        s = (a**2 + z**2) ** 0.5
        grip = (1 - 2 * self.nu) * z * (s - z) - 2 * (1 - self.nu) * a**2
        recovery: Array = d_e * (1 + grip / (2 * (1 - self.nu) * a * s))
        return recovery

    def returned(self, d: Array) -> Array:
        """W_u (J): (1 + δ_R/d) E*A²B/12 with the indenter's height A = 2d and width B = 2a."""
        plastic = 2 / 3 * self.E_star * self.elastic_depth(d) * self.contact_radius(d)
        elastic = hertz.stored_energy(d, self.R, self.E_star)
        return np.where(d <= self.depth_at_yield, elastic, plastic * self.recovery(d))


def _sphere(
    radius: Values, youngs_modulus: Values, poissons_ratio: Values, yield_strength: Values
) -> _Sphere:
    (E,) = positive(youngs_modulus=youngs_modulus)
    (nu,) = between(0.0, 0.5, poissons_ratio=poissons_ratio)
    R, Y = positive(radius=radius, yield_strength=yield_strength)
    depth_at_yield = yield_indentation(radius, youngs_modulus, poissons_ratio, yield_strength)
    return _Sphere(R, E / (1 - nu**2), nu, Y, depth_at_yield)
