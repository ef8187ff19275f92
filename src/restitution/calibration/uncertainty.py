"""How well measured restitution determines parameters: covariance, intervals, combinations.

Parameters are logarithms. A deviation ΔCOR of data or model moves them by P ΔCOR, where
P = (AᵀA)⁻¹Aᵀ/σ is the pseudo-inverse of the scaled Jacobian A = J/σ. With deviations that are
independent between points, those of other surfaces and that of the grid,

    C = P diag(s²) Pᵀ + 2 S/n + (P Δ_grid)(P Δ_grid)ᵀ,  S = Σ (P Δ)(P Δ)ᵀ/(n − 1),

where Δ are the differences of n surfaces from their mean, which was fitted. The second term is the
variance of the difference between two such means, the fitted one and that over n places of impact.
If all impacts met one place, it would be (1 + 1/n) S. Intervals take Student's t, with degrees of
freedom after Welch and Satterthwaite (Satterthwaite 1946).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 0.95
# Singular values of A count as this at least: such a direction is known within a factor e^1000.
_LEAST = 1e-3
_UNBOUNDED = math.log(1e6)  # of a half interval


@dataclass(frozen=True)
class Deviations:
    """What moves COR away from the fitted curve, at the measured velocities.

    `random` are standard deviations of the points, shape (points,), known from `freedom` degrees
    of freedom. `surfaces` are differences of each surface from their mean, shape (surfaces,
    points), and `grid` is the difference on cells twice as large, None if unknown. `model` is the
    error by the model of plasticity, which intervals do not include.
    """

    random: Array
    freedom: float
    surfaces: Array
    grid: Array | None
    model: Array

    @property
    def by_surface(self) -> Array:
        """Deviations of COR with covariance 2 S/n, shape (surfaces, points).

        This is the covariance of the difference between two means over n surfaces; S is the
        covariance of COR between single surfaces.
        """
        n = len(self.surfaces)
        return self.surfaces * math.sqrt(2 / (n * max(n - 1, 1)))

    @property
    def by_grid(self) -> Array:
        """The difference on cells twice as large; zero if unknown."""
        return np.zeros(self.random.size) if self.grid is None else self.grid

    @property
    def systematic(self) -> Array:
        """Standard deviations of COR by surface and grid, and `random`."""
        squares = self.random**2 + (self.by_surface**2).sum(axis=0) + self.by_grid**2
        return np.asarray(np.sqrt(squares))


@dataclass(frozen=True)
class Uncertainty:
    """The uncertainty of the logarithms of parameters; `scaled` is the Jacobian A."""

    scaled: Array
    sensitivity: Array
    deviations: Deviations

    @classmethod
    def of(cls, jacobian: Array, weights: Array, deviations: Deviations) -> Uncertainty:
        """The uncertainty for ∂COR/∂x `jacobian` and the deviations σ that weighed the points."""
        scaled = jacobian / weights[:, None]
        U, s, Vt = np.linalg.svd(scaled, full_matrices=False)
        P = Vt.T @ np.diag(1 / np.maximum(s, _LEAST)) @ U.T / weights
        return cls(scaled, np.asarray(P), deviations)

    @cached_property
    def parts(self) -> dict[str, Array]:
        """The covariances by noise, surface and grid."""
        P, by = self.sensitivity, self.deviations
        surfaces = by.by_surface @ P.T
        return {
            "noise": self._unknown + (P * by.random**2) @ P.T,
            "surface": surfaces.T @ surfaces,
            "grid": np.outer(P @ by.by_grid, P @ by.by_grid),
        }

    @cached_property
    def _unknown(self) -> Array:
        """The covariance along directions that change COR by nothing at all."""
        _, s, Vt = np.linalg.svd(self.scaled, full_matrices=False)
        lost = Vt[s < _LEAST]
        return np.asarray(lost.T @ lost / _LEAST**2)

    @cached_property
    def covariance(self) -> Array:
        """C, shape (parameters, parameters)."""
        return np.asarray(sum(self.parts.values()))

    @cached_property
    def correlation(self) -> Array:
        """The correlations of C."""
        deviation = np.sqrt(np.diag(self.covariance))
        safe = np.where(deviation > 0, deviation, 1.0)
        found = self.covariance / np.outer(safe, safe)
        np.fill_diagonal(found, 1.0)
        return np.asarray(found)

    def half(self, direction: Array) -> float:
        """Half of the 95 % interval of the logarithm along `direction`; inf beyond a factor 1e6."""
        from scipy.stats import t

        variances = {name: float(direction @ C @ direction) for name, C in self.parts.items()}
        whole = sum(variances.values())
        if whole <= 0:
            return 0.0
        freedom = {
            "noise": self.deviations.freedom,
            "surface": max(len(self.deviations.surfaces) - 1, 1),
            "grid": math.inf,
        }
        lost = sum((variances[name] / whole) ** 2 / freedom[name] for name in variances)
        n = math.inf if lost == 0 else 1 / lost
        half = float(t.ppf(0.5 * (1 + CONFIDENCE), n)) * math.sqrt(whole)
        return half if half < _UNBOUNDED else math.inf

    @cached_property
    def halves(self) -> list[float]:
        """Half of the 95 % interval of the logarithm of each parameter."""
        return [self.half(axis) for axis in np.eye(self.scaled.shape[1])]

    def deviation(self, part: str) -> Array:
        """The standard deviation of each logarithm by a part of the covariance."""
        return np.asarray(np.sqrt(np.diag(self.parts[part])))

    @cached_property
    def by_model(self) -> Array:
        """How far each logarithm moves if COR of the model is off by its error at every point."""
        return np.asarray(np.abs(self.sensitivity @ self.deviations.model))

    @cached_property
    def by_one_place(self) -> Array:
        """Standard deviation of each logarithm if all impacts met one and the same place."""
        n = len(self.deviations.surfaces)
        return np.asarray(math.sqrt((n + 1) / 2) * self.deviation("surface"))

    @cached_property
    def best_direction(self) -> Array:
        """The direction of the logarithms that the data determine best, its largest entry 1."""
        _, _, Vt = np.linalg.svd(self.scaled, full_matrices=False)
        direction: Array = Vt[0]
        return np.asarray(direction / direction[np.abs(direction).argmax()])

    def effect(self, parameter: int) -> float:
        """Standard deviations by which the residuals move when a parameter is doubled."""
        return math.log(2) * float(np.linalg.norm(self.scaled[:, parameter]))

    def band(self, jacobian: Array) -> Array:
        """Half of the 95 % interval of the fitted COR, for ∂COR/∂x `jacobian` at other points."""
        noise = (jacobian @ self.sensitivity * self.deviations.random) ** 2
        whole = noise.sum(axis=1)
        for each in (*self.deviations.by_surface, self.deviations.by_grid):
            whole = whole + (jacobian @ (self.sensitivity @ each)) ** 2
        return np.asarray(1.96 * np.sqrt(whole))
