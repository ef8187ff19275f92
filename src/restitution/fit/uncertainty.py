"""Uncertainty of fitted parameters, as a covariance of their logarithms x = ln(value/first guess).

With J = ∂COR/∂x, weights σ, A = J/σ and P = (AᵀA)⁻¹Aᵀ/σ, a deviation ΔCOR changes x by P ΔCOR:

    C = P diag(s²) Pᵀ + 2 S/n + (P Δ_grid)(P Δ_grid)ᵀ,  S = Σ (P Δ)(P Δ)ᵀ/(n − 1),

where s are errors that are independent between points and Δ are n surfaces minus their mean. The
measured COR is taken as a mean over n places, too; if all impacts hit one place, (1 + 1/n) S
replaces 2 S/n. Intervals use Student's t and the degrees of freedom of Satterthwaite (1946). The
model error M is not random; 95 % of fits to the finite-element curves are off by at most the share
`MODEL_SHARES` of P M (docs/studies/fit_model_error.py), which is added in quadrature.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t

Array = NDArray[np.float64]

CONFIDENCE = 0.95
MODEL_SHARES = {"equilibrium": 0.9, "truncated": 0.8, "expanding-cavity": 0.45}
"""For each model of plasticity: see the top of this file."""
# Singular values of A are at least _LEAST. The standard deviation of a combination of parameters
# that the data do not determine is then at least 1/_LEAST: a factor of e^1000 remains possible.
_LEAST = 1e-3
# Half-width from which an interval counts as infinite.
_UNBOUNDED = math.log(1e6)


@dataclass(frozen=True)
class Deviations:
    """Deviations of COR from the fitted curve at the measured velocities, by cause.

    Attributes:
        random: Standard deviations, shape (points,).
        freedom: Degrees of freedom of the estimate of `random`.
        surfaces: COR of each surface minus their mean, shape (surfaces, points).
        grid: Change of COR on cells twice as large; None if the case cannot be solved on them.
        model: Model error of COR.
        model_share: Share of the effect of `model` that the combined intervals include.
    """

    random: Array
    freedom: float
    surfaces: Array
    grid: Array | None
    model: Array
    model_share: float = 1.0

    @property
    def by_surface(self) -> Array:
        """`surfaces`, scaled so that the outer products of the rows add up to 2 V/n.

        V is the covariance of COR for one surface, and 2 V/n that of the difference of two means.
        """
        n = len(self.surfaces)
        return self.surfaces * math.sqrt(2 / (n * max(n - 1, 1)))

    @property
    def by_grid(self) -> Array:
        return np.zeros(self.random.size) if self.grid is None else self.grid

    @property
    def systematic(self) -> Array:
        squares = self.random**2 + (self.by_surface**2).sum(axis=0) + self.by_grid**2
        return np.asarray(np.sqrt(squares))


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of the logarithms of parameters: `scaled` is A and `sensitivity` is P."""

    scaled: Array
    sensitivity: Array
    deviations: Deviations

    @classmethod
    def of(cls, jacobian: Array, weights: Array, deviations: Deviations) -> Uncertainty:
        """Compute A and P from the Jacobian J, shape (points, parameters), and the weights σ."""
        scaled = jacobian / weights[:, None]
        U, s, Vt = np.linalg.svd(scaled, full_matrices=False)
        P = Vt.T @ np.diag(1 / np.maximum(s, _LEAST)) @ U.T / weights
        return cls(scaled, np.asarray(P), deviations)

    @cached_property
    def parts(self) -> dict[str, Array]:
        P, by = self.sensitivity, self.deviations
        surfaces = by.by_surface @ P.T
        return {
            "noise": self._unknown + (P * by.random**2) @ P.T,
            "surface": surfaces.T @ surfaces,
            "grid": np.outer(P @ by.by_grid, P @ by.by_grid),
        }

    @cached_property
    def _unknown(self) -> Array:
        """Large covariance of the combinations of parameters that hardly change COR."""
        _, s, Vt = np.linalg.svd(self.scaled, full_matrices=False)
        lost = Vt[s < _LEAST]
        return np.asarray(lost.T @ lost / _LEAST**2)

    @cached_property
    def covariance(self) -> Array:
        return np.asarray(sum(self.parts.values()))

    @cached_property
    def correlation(self) -> Array:
        deviation = np.sqrt(np.diag(self.covariance))
        safe = np.where(deviation > 0, deviation, 1.0)
        correlation = self.covariance / np.outer(safe, safe)
        np.fill_diagonal(correlation, 1.0)
        return np.asarray(correlation)

    def half(self, direction: Array) -> float:
        """Half-width of the 95 % interval of Σ cᵢ ln pᵢ, where `direction` holds the cᵢ."""

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
        """Half-width of the 95 % interval of the logarithm of each parameter."""
        return [self.half(axis) for axis in np.eye(self.scaled.shape[1])]

    @cached_property
    def combined_halves(self) -> list[float]:
        by_model = self.deviations.model_share * self.by_model
        halves = np.hypot(self.halves, by_model).tolist()
        return [half if half < _UNBOUNDED else math.inf for half in halves]

    def deviation(self, part: str) -> Array:
        """Standard deviation of each logarithm due to "noise", "surface" or "grid"."""
        return np.asarray(np.sqrt(np.diag(self.parts[part])))

    @cached_property
    def by_model(self) -> Array:
        """Change of each logarithm if COR deviates by its full model error at every velocity."""
        return np.asarray(np.abs(self.sensitivity @ self.deviations.model))

    @cached_property
    def by_one_place(self) -> Array:
        """Standard deviation of each logarithm due to (1 + 1/n) S: all impacts hit one place."""
        n = len(self.deviations.surfaces)
        return np.asarray(math.sqrt((n + 1) / 2) * self.deviation("surface"))

    @cached_property
    def best_direction(self) -> Array:
        """Coefficients of the combination of logarithms that the data determine best; largest 1."""
        direction = np.linalg.svd(self.scaled, full_matrices=False).Vh[0]
        return np.asarray(direction / direction[np.abs(direction).argmax()])

    def effect(self, parameter: int) -> float:
        """Norm of the change of the weighted residuals when a parameter is doubled."""
        return math.log(2) * float(np.linalg.norm(self.scaled[:, parameter]))

    def band(self, jacobian: Array) -> Array:
        """Half-width, at most 1, of the 95 % interval of the fitted COR for each row of ∂COR/∂x."""
        return np.array([min(self.half(row), 1.0) for row in jacobian])
