"""The problem: material and profile, meshes, and the depths that are loaded to."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np


@dataclass(frozen=True)
class Model:
    """Deformable half-space and rigid profile.

    Args:
        youngs_modulus: Young's modulus E (Pa).
        poissons_ratio: Poisson's ratio ν.
        yield_strength: initial uniaxial yield strength S_y (Pa); None: elastic.
        hardening_modulus: slope dσ/dε_p of linear isotropic hardening (Pa).
        hardening_exponent: exponent n of σ = S_y (1 + E ε_p/S_y)^n; 0: linear hardening.
        radius: radius R of the rigid parabola (m).
        wave_amplitude: amplitude A of concentric waves (m).
        wavelength: wavelength λ of the waves (m).
    """

    youngs_modulus: float = 210e9
    poissons_ratio: float = 0.3
    yield_strength: float | None = 1e9
    hardening_modulus: float = 0.0
    hardening_exponent: float = 0.0
    radius: float = 500e-6
    wave_amplitude: float = 0.0
    wavelength: float = 0.0

    @property
    def contact_modulus(self) -> float:
        """Contact modulus E* = E/(1 − ν²) (Pa)."""
        return self.youngs_modulus / (1 - self.poissons_ratio**2)

    @property
    def critical_indentation(self) -> float:
        """Indentation δ_c at first yield of the smooth sphere (m), Jackson and Green (2005)."""
        strength = 1e9 if self.yield_strength is None else self.yield_strength
        c = 1.295 * np.exp(0.736 * self.poissons_ratio)
        return (np.pi * c * strength / (2 * self.contact_modulus)) ** 2 * self.radius

    def profile(self, r: np.ndarray) -> np.ndarray:
        """Gap g(r) of the undeformed surfaces at first touch (m) at radii r (m)."""
        g = r**2 / (2 * self.radius)
        if self.wave_amplitude:
            g = g + self.wave_amplitude * (1 - np.cos(2 * np.pi * r / self.wavelength))
        return g

    def profile_slopes(self, r: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return g'(r) (-) and g''(r) (1/m) at radii r (m)."""
        first, second = r / self.radius, np.full_like(r, 1 / self.radius)
        if self.wave_amplitude:
            k = 2 * np.pi / self.wavelength
            first = first + self.wave_amplitude * k * np.sin(k * r)
            second = second + self.wave_amplitude * k**2 * np.cos(k * r)
        return first, second

    @property
    def crest_radius(self) -> float:
        """Radius of curvature of the profile at r = 0 (m)."""
        curvature = 1 / self.radius
        if self.wave_amplitude:
            curvature += self.wave_amplitude * (2 * np.pi / self.wavelength) ** 2
        return 1 / curvature


@dataclass(frozen=True)
class MeshSpec:
    """Tensor-product mesh: uniform near the contact, then two geometric gradings.

    Args:
        element_size: edge of the elements below the contact (m).
        uniform_radius: radius to which elements keep this width (m).
        uniform_depth: depth to which elements keep this height (m).
        fine_extent: radius and depth to which the first grading goes (m).
        domain: radius and depth of the domain (m).
        grading_r: ratio of neighbouring widths in the first grading.
        grading_z: ratio of neighbouring heights in the first grading.
        grading_far: ratio of neighbouring sizes in the second grading.
        crest_spacing: distance of crests (m); 0: all elements below the contact are equally wide.
        crest_width: elements have the width `element_size` up to this distance from a crest (m).
    """

    element_size: float
    uniform_radius: float
    uniform_depth: float
    fine_extent: float
    domain: float
    grading_r: float = 1.10
    grading_z: float = 1.06
    grading_far: float = 1.25
    crest_spacing: float = 0.0
    crest_width: float = 0.0


def crest_coordinates(spec: MeshSpec) -> np.ndarray:
    """Return r of the nodes (m) up to `uniform_radius`: fine at the crests, wider between them.

    The width grows with the distance from a crest by `grading_r` per element, to at most four
    times `element_size`.
    """
    h, x = spec.element_size, [0.0]
    while x[-1] < spec.uniform_radius:
        nearest = abs(x[-1] - spec.crest_spacing * round(x[-1] / spec.crest_spacing))
        beyond = max(nearest - spec.crest_width, 0.0)
        x.append(x[-1] + min(h + (spec.grading_r - 1) * beyond, 4 * h))
    return np.array(x)


def graded_coordinates(spec: MeshSpec, uniform: float, grading: float) -> np.ndarray:
    """Return node coordinates (m) along one axis: uniform, graded, then graded faster."""
    h = spec.element_size
    x = list(np.arange(round(uniform / h) + 1) * h)
    if spec.crest_spacing and uniform == spec.uniform_radius:
        x = list(crest_coordinates(spec))
        h = x[-1] - x[-2]
    while x[-1] < spec.domain:
        h *= grading if x[-1] < spec.fine_extent else spec.grading_far
        x.append(x[-1] + h)
    return np.array(x)


def hemisphere(x: np.ndarray, y: np.ndarray, radius: float) -> tuple[np.ndarray, np.ndarray]:
    """Map the unit square onto a hemisphere that is loaded at its pole; return r and depth (m).

    The side y = 0 becomes the sphere up to 45° from the pole, x = 1 the rest of the sphere, and
    y = 1 the equator. Near the pole the map only scales.
    """
    top, side = x * np.pi / 4, (1 + y) * np.pi / 4
    r = (1 - y) * np.sin(top) + y * x + x * np.sin(side) - x * ((1 - y) * np.sqrt(0.5) + y)
    depth = (1 - y) * (1 - np.cos(top)) + (1 - x) * y + x * (1 - np.cos(side))
    depth -= x * (1 - y) * (1 - np.sqrt(0.5))
    return radius * r, radius * depth


def smooth_mesh(
    model: Model, omega_max: float, elements: float = 60, refinement: int = 1
) -> MeshSpec:
    """Return a mesh with about `elements` over the contact radius at ω = `omega_max`.

    Args:
        model: material and profile.
        omega_max: largest indentation over δ_c.
        elements: elements over the expected contact radius before refinement.
        refinement: divisor of all element sizes.
    """
    # a² / (Rδ) grows from 1 (elastic) to about 2 (fully plastic)
    growth = min(1.0 + 0.115 * np.log(max(omega_max, 1.0)), 1.50)
    if model.yield_strength is None:
        growth = 1.0
    a = growth * np.sqrt(model.radius * omega_max * model.critical_indentation)
    k = 1 / refinement
    return MeshSpec(a / elements * k, 1.08 * a, 0.5 * a, 3 * a, 100 * a, 1.10**k, 1.06**k, 1.25**k)


def wave_mesh(model: Model, omega_max: float, per_wave: float, refinement: int = 1) -> MeshSpec:
    """Return a mesh with `per_wave` elements per wavelength over the contact at `omega_max`."""
    depth = omega_max * model.critical_indentation
    a = 1.15 * np.sqrt(model.radius * depth)
    k = 1 / refinement
    return MeshSpec(
        model.wavelength / per_wave * k,
        1.1 * a,
        0.3 * model.wavelength,
        3 * a,
        100 * a,
        1.10**k,
        1.06**k,
        1.25**k,
    )


def crest_mesh(model: Model, omega_max: float, per_wave: float, refinement: int = 1) -> MeshSpec:
    """Return a mesh like `wave_mesh`, but fine only near the crests of the waves."""
    return replace(
        wave_mesh(model, omega_max, per_wave, refinement),
        uniform_depth=0.12 * model.wavelength,
        crest_spacing=model.wavelength,
        crest_width=0.12 * model.wavelength,
    )


def load_steps(start: float, low: float, omegas, coarse: float, fine: float):
    """Return geometric steps of ω from `start`: `coarse` below `low`, `fine` above.

    Args:
        start: first ω.
        low: ω where the fine steps begin.
        omegas: values of ω that must be met.
        coarse: relative step below `low`.
        fine: relative step above `low`.
    """
    steps = [start]
    for stop in sorted({w for w in (low, *omegas) if w > start * 1.0001}):
        size = fine if stop > low * 1.0001 else coarse
        count = max(1, int(np.ceil(np.log(stop / steps[-1]) / np.log1p(size) - 1e-9)))
        steps += list(steps[-1] * (stop / steps[-1]) ** (np.arange(1, count + 1) / count))
        steps[-1] = stop
    return np.array(steps)
