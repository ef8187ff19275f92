"""Johnson's translations: change the skewness and kurtosis of a normally distributed variable.

    unbounded (SU):  x = sinh((z + γ)/δ)        bounded (SB):  x = 1/(1 + exp(−(z − γ)/δ))

Each form covers one region of skewness and kurtosis (3 for a normal variable, as in ISO 25178);
between them lies the lognormal distribution. Sources: Johnson (1949), Biometrika 36, 149–176; Hill,
Hill and Holder (1976), Applied Statistics 25, 180–189 (AS 99).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product

import numpy as np

from restitution.surfaces.surface import Array

_Form = Callable[..., Array]

# Smallest allowed value of kurtosis − skewness². For any distribution this difference is at least
# 1. Near 1, nearly all heights take one of two values.
LEAST_KURTOSIS = 1.1
_ABSCISSAE, _WEIGHTS = np.polynomial.hermite_e.hermegauss(201)
# The search ends if the misfits of skewness and kurtosis are both below _EXACT. Otherwise the best
# fit is accepted if both misfits are at most _CLOSE. _CLOSE is larger than _EXACT, because neither
# form fits a lognormal distribution exactly.
_EXACT, _CLOSE = 1e-6, 2e-3
_STARTS = ((0.0, 0.0), (0.5, 0.3), (1.5, 0.5), (3.0, 0.8), (0.5, -0.7), (1.2, -1.2), (2.5, -1.5))


def possible(skewness: float, kurtosis: float) -> bool:
    """Whether this package can construct a distribution with this skewness and kurtosis."""
    return math.isfinite(skewness) and skewness**2 + LEAST_KURTOSIS <= kurtosis < math.inf


def translation(skewness: float, kurtosis: float) -> Callable[[Array], Array] | None:
    """Increasing function that gives a standard normal variable these moments, mean 0, variance 1.

    None if no parameters give the skewness within 0.002 and the kurtosis within 0.2 %.
    """
    if skewness == 0 and kurtosis == 3:
        return np.array
    if not possible(skewness, kurtosis):
        return None
    sign = -1.0 if skewness < 0 else 1.0
    miss, form, shape = _best_fit(abs(skewness), kurtosis)
    if miss > _CLOSE:
        return None
    mean, deviation, _, _ = _moments(form, shape)
    return lambda z: sign * (form(sign * z, *shape) - mean) / deviation


def _unbounded(z: Array, gamma: float, log_delta: float) -> Array:
    return np.asarray(np.sinh((z + gamma) / math.exp(log_delta)))


def _bounded(z: Array, gamma: float, log_delta: float) -> Array:
    from scipy.special import expit

    return np.asarray(expit((z - gamma) / math.exp(log_delta)))


def _moments(form: _Form, shape: Array) -> tuple[float, float, float, float]:
    weight = _WEIGHTS / _WEIGHTS.sum()
    x = form(_ABSCISSAE, *shape)
    mean = float(weight @ x)
    x = x - mean
    variance = float(weight @ x**2)
    return (
        mean,
        math.sqrt(variance),
        float(weight @ x**3) / variance**1.5,
        float(weight @ x**4) / variance**2,
    )


def _best_fit(skewness: float, kurtosis: float) -> tuple[float, _Form, Array]:
    best = math.inf, _unbounded, np.zeros(2)
    for form, start in product((_unbounded, _bounded), _STARTS):
        shape, miss = _fitted(form, start, skewness, kurtosis)
        if miss < best[0]:
            best = miss, form, shape
        if miss < _EXACT:
            break
    return best


def _fitted(
    form: _Form, start: tuple[float, float], skewness: float, kurtosis: float
) -> tuple[Array, float]:
    """Parameters (γ, ln δ) of a form, fitted from `start`, and their misfit."""
    from scipy.optimize import least_squares

    def miss(shape: Array) -> Array:
        _, _, skew, kurt = _moments(form, shape)
        # Long tails have a very large kurtosis. The logarithm limits its weight in the fit.
        return np.array([skew - skewness, math.log(kurt / kurtosis)])

    with np.errstate(over="ignore", invalid="ignore"):
        fit = least_squares(miss, start, bounds=([-30, -2.5], [30, 4]), xtol=1e-12, ftol=1e-14)
    return fit.x, float(np.abs(fit.fun).max())
