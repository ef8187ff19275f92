"""Uncertainty of fitted parameters: covariance, intervals, and combinations.

Here, the parameters x are logarithms: ln(value/first guess). J = ∂COR/∂x is the Jacobian, and σ are
the standard deviations that weight the points. A = J/σ is the scaled Jacobian. If the measured or
the computed COR deviates by ΔCOR, the fitted parameters deviate by P ΔCOR. Here P = (AᵀA)⁻¹Aᵀ/σ is
the pseudo-inverse of A divided by σ. Three kinds of deviations contribute to the covariance C of
the parameters:

    C = P diag(s²) Pᵀ + 2 S/n + (P Δ_grid)(P Δ_grid)ᵀ,  S = Σ (P Δ)(P Δ)ᵀ/(n − 1).

In the first term, s are the standard deviations of errors that are independent between points. In
the second term, Δ is the COR of one computed surface minus the mean COR of n computed surfaces. S
is the resulting covariance of the parameters for a single surface. The computed mean COR is fitted
to the measured COR, which is assumed to be a mean over n places of impact. The computed and the
measured mean contribute S/n each. If all impacts hit the same place, the measured COR contributes
S, so the second term is (1 + 1/n) S instead. In the third term, Δ_grid is the deviation of COR due
to the grid.

The model error of COR is not random. If COR deviated by its full model error M at every velocity,
the logarithms would change by P M. Fits to the finite-element curves of the validation change by
less: 95 % of them by at most the share `MODEL_SHARES` of P M (evidence/fit/fit_model_error.py). The
combined interval of a parameter adds this part to the interval of the data in quadrature.

Intervals are computed with Student's t distribution, with the degrees of freedom according to Welch
and Satterthwaite (Satterthwaite 1946).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

CONFIDENCE = 0.95
MODEL_SHARES = {"equilibrium": 0.9, "truncated": 0.8, "expanding-cavity": 0.45}
"""For each model of plasticity: see the top of this file."""
# Singular values of the scaled Jacobian A below _LEAST are set to _LEAST. The data do not determine
# the corresponding combinations of parameters. The standard deviation of the logarithm of such a
# combination is then at least 1/_LEAST = 1000, so changes by a factor of e^1000 remain possible.
_LEAST = 1e-3
# The interval of a parameter counts as infinite if the half-width of the interval of its logarithm
# is at least this value.
_UNBOUNDED = math.log(1e6)


@dataclass(frozen=True)
class Deviations:
    """Deviations of COR from the fitted curve at the measured velocities, one field for each cause.

    `random` are the standard deviations of COR at the points, shape (points,), estimated with
    `freedom` degrees of freedom. `surfaces` is the COR of each surface minus the mean over the
    surfaces, shape (surfaces, points). `grid` is the change of COR if the cells are twice as
    large as those of the case. It is None if the case cannot be solved on these cells. `model` is
    the model error of COR (`contact.model_error`), and `model_share` the share of its effect that
    the combined intervals include.
    """

    random: Array
    freedom: float
    surfaces: Array
    grid: Array | None
    model: Array
    model_share: float = 1.0

    @property
    def by_surface(self) -> Array:
        """The field `surfaces` times a factor, shape (surfaces, points).

        Let n be the number of surfaces, and let V be the covariance matrix of COR for one surface.
        The difference of two means of COR, each over n surfaces, has the covariance matrix 2 V/n.
        The factor is chosen so that the outer products of the rows add up to this matrix.
        """
        n = len(self.surfaces)
        return self.surfaces * math.sqrt(2 / (n * max(n - 1, 1)))

    @property
    def by_grid(self) -> Array:
        """Change of COR if the cells are twice as large as those of the case, shape (points,).

        It is the field `grid`, or zeros if `grid` is None.
        """
        return np.zeros(self.random.size) if self.grid is None else self.grid

    @property
    def systematic(self) -> Array:
        """Standard deviations of COR: root sum of squares of `random`, `by_surface` and `by_grid`.

        The result contains the noise of the measurements if `random` contains it.
        """
        squares = self.random**2 + (self.by_surface**2).sum(axis=0) + self.by_grid**2
        return np.asarray(np.sqrt(squares))


@dataclass(frozen=True)
class Uncertainty:
    """Uncertainty of the logarithms of parameters.

    `scaled` is the scaled Jacobian A. `sensitivity` is the matrix P, by which deviations of COR are
    multiplied to obtain the changes of the logarithms.
    """

    scaled: Array
    sensitivity: Array
    deviations: Deviations

    @classmethod
    def of(cls, jacobian: Array, weights: Array, deviations: Deviations) -> Uncertainty:
        """Compute the uncertainty.

        `jacobian` is ∂COR/∂x at the measured points, with x = ln(value/first guess) for each
        parameter. `weights` are the standard deviations σ of the points. In the fit, each residual
        is divided by its σ.
        """
        scaled = jacobian / weights[:, None]
        U, s, Vt = np.linalg.svd(scaled, full_matrices=False)
        P = Vt.T @ np.diag(1 / np.maximum(s, _LEAST)) @ U.T / weights
        return cls(scaled, np.asarray(P), deviations)

    @cached_property
    def parts(self) -> dict[str, Array]:
        """The parts of the covariance C due to noise, surface and grid."""
        P, by = self.sensitivity, self.deviations
        surfaces = by.by_surface @ P.T
        return {
            "noise": self._unknown + (P * by.random**2) @ P.T,
            "surface": surfaces.T @ surfaces,
            "grid": np.outer(P @ by.by_grid, P @ by.by_grid),
        }

    @cached_property
    def _unknown(self) -> Array:
        """Large covariance that is added for combinations of parameters that hardly change COR.

        The data do not determine these combinations.
        """
        _, s, Vt = np.linalg.svd(self.scaled, full_matrices=False)
        lost = Vt[s < _LEAST]
        return np.asarray(lost.T @ lost / _LEAST**2)

    @cached_property
    def covariance(self) -> Array:
        """Covariance C of the parameters, shape (parameters, parameters)."""
        return np.asarray(sum(self.parts.values()))

    @cached_property
    def correlation(self) -> Array:
        """Correlation matrix of the parameters."""
        deviation = np.sqrt(np.diag(self.covariance))
        safe = np.where(deviation > 0, deviation, 1.0)
        found = self.covariance / np.outer(safe, safe)
        np.fill_diagonal(found, 1.0)
        return np.asarray(found)

    def half(self, direction: Array) -> float:
        """Half-width of the 95 % interval of Σ cᵢ ln pᵢ, with the fitted parameters pᵢ.

        `direction` contains the coefficients cᵢ. The result is inf if the half-width is at least
        ln 10⁶.
        """
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
        """Half-width of the 95 % interval of the logarithm of each parameter."""
        return [self.half(axis) for axis in np.eye(self.scaled.shape[1])]

    @cached_property
    def combined_halves(self) -> list[float]:
        """Half-width of the 95 % interval that includes the error of the model, by parameter."""
        by_model = self.deviations.model_share * self.by_model
        halves = np.hypot(self.halves, by_model).tolist()
        return [half if half < _UNBOUNDED else math.inf for half in halves]

    def deviation(self, part: str) -> Array:
        """Standard deviation of the logarithm of each parameter due to one source of error.

        `part` names the source: "noise", "surface" or "grid".
        """
        return np.asarray(np.sqrt(np.diag(self.parts[part])))

    @cached_property
    def by_model(self) -> Array:
        """Change of the logarithm of each parameter due to the model error (absolute value).

        COR is assumed to deviate by its full model error at every velocity.
        """
        return np.asarray(np.abs(self.sensitivity @ self.deviations.model))

    @cached_property
    def by_one_place(self) -> Array:
        """Standard deviation of the logarithm of each parameter if all impacts hit one place.

        The differences between surfaces then contribute (1 + 1/n) S to the covariance of the
        parameters (see the top of this file). The result contains only this contribution, and
        neither the noise nor the error of the grid.
        """
        n = len(self.deviations.surfaces)
        return np.asarray(math.sqrt((n + 1) / 2) * self.deviation("surface"))

    @cached_property
    def best_direction(self) -> Array:
        """The linear combination of the parameters' logarithms that the data determine best.

        Returns its coefficients, one for each parameter. The coefficient of largest magnitude is 1.
        """
        direction = np.linalg.svd(self.scaled, full_matrices=False).Vh[0]
        return np.asarray(direction / direction[np.abs(direction).argmax()])

    def effect(self, parameter: int) -> float:
        """Norm of the change of the weighted residuals when a parameter is doubled."""
        return math.log(2) * float(np.linalg.norm(self.scaled[:, parameter]))

    def band(self, jacobian: Array) -> Array:
        """Half-width of the 95 % interval of the fitted COR, one value for each row of `jacobian`.

        Each row of `jacobian` is ∂COR/∂x at one velocity, with x = ln(value/first guess) for each
        parameter. The half-width is at most 1, the range of COR.
        """
        return np.array([min(self.half(row), 1.0) for row in jacobian])
