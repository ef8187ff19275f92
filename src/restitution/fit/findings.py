"""State in words whether a fit determines its parameters and explains the data."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.stats import chi2

from restitution.display import counted
from restitution.fit.fit import Fit
from restitution.fit.least_squares import DISTANCE, RANGE

WIDEST = 4.0
"""A parameter is not identifiable if its 95 % interval spans more than this factor."""
_CORRELATED = 0.99  # correlation above which two parameters cannot be told apart

# Doubling a parameter without effect changes the residuals by less than this number of deviations.
_NO_EFFECT = 0.3
# Another minimum is equally good if its χ² is larger by less than this value (times the reduced χ²
# if that is above 1): a parameter that is off by two standard deviations increases χ² by 4.
_AS_GOOD = 4.0
_SHARE = 0.1  # smallest exponent of a parameter in a combination
_UNLIKELY = 0.01  # probability of larger residuals below which the case does not explain the data


def identifiable(fit: Fit, parameter: int) -> bool:
    """Whether the 95 % interval of a parameter spans at most a factor of `WIDEST`."""
    return fit.uncertainty.halves[parameter] <= 0.5 * math.log(WIDEST)


def findings(fit: Fit) -> list[str]:
    return [
        *_not_identifiable(fit),
        *_correlated(fit),
        *_bounds(fit),
        *_other_minima(fit),
        *_unexplained(fit),
        *_unresolved(fit),
        *_unknown(fit),
    ]


def interval_in_words(fit: Fit, k: int, *, model: bool = False) -> str:
    """The 95 % interval of parameter `k`, with `model` including the error of the model."""
    uncertainty, x, parameter = fit.uncertainty, float(fit.x[k]), fit.parameters[k]
    half = (uncertainty.combined_halves if model else uncertainty.halves)[k]
    if math.isinf(half):
        return "unbounded"
    return f"{parameter.text(math.exp(x - half))} to {parameter.text(math.exp(x + half))}"


def combination(fit: Fit) -> tuple[dict[str, float], float] | None:
    """Find the product of powers of parameters that the data determine best.

    Returns the exponents by key, and the half-width of the 95 % interval of the logarithm of the
    product. Returns None for a single parameter, or if even this product is not identifiable.
    """
    direction = fit.uncertainty.best_direction
    half = fit.uncertainty.half(direction)
    if len(fit.parameters) < 2 or half > 0.5 * math.log(WIDEST):
        return None
    exponents = zip(
        (parameter.key for parameter in fit.parameters), direction.tolist(), strict=True
    )
    return {key: value for key, value in exponents if abs(value) >= _SHARE}, half


def _not_identifiable(fit: Fit) -> Iterator[str]:
    lost = [k for k in range(fit.x.size) if not identifiable(fit, k)]
    for k in lost:
        parameter = fit.parameters[k]
        if fit.uncertainty.effect(k) < _NO_EFFECT:
            yield (
                f"{parameter.key} is not identifiable from these data: restitution at these "
                f"velocities does not depend on it near {parameter.text(fit.factors[k])}"
            )
            continue
        half = fit.uncertainty.halves[k]
        spans = (
            "is unbounded" if math.isinf(half) else f"spans a factor of {math.exp(2 * half):.2g}"
        )
        yield (
            f"{parameter.key} is not identifiable from these data: its 95 % interval {spans} "
            f"({interval_in_words(fit, k)})"
        )
    known = combination(fit) if lost else None
    if known is not None and len(known[0]) > 1:
        yield f"the data determine only the combination {product_in_words(*known)}"


def product_in_words(exponents: dict[str, float], half: float) -> str:
    factors = [key if power == 1 else f"{key}^{power:.2f}" for key, power in exponents.items()]
    percent = 100 * (math.exp(half) - 1)
    return f"{' * '.join(factors)} (within {percent:.2g} %)"


def _correlated(fit: Fit) -> Iterator[str]:
    r = fit.uncertainty.correlation
    for i, j in np.argwhere(np.tril(np.abs(r) > _CORRELATED, -1)).tolist():
        if identifiable(fit, i) and identifiable(fit, j):
            one, other = fit.parameters[j].key, fit.parameters[i].key
            yield (
                f"{one} and {other} cannot be told apart by these data (correlation "
                f"{r[i, j]:.3f}): a change of one compensates for a change of the other"
            )


def _bounds(fit: Fit) -> Iterator[str]:
    for parameter, x in zip(fit.parameters, fit.x.tolist(), strict=True):
        if abs(x) > 0.99 * math.log(RANGE):  # x = ln(value/first guess)
            side = "above" if x > 0 else "below"
            yield (
                f"{parameter.key} ended at the limit of the search, a factor of {RANGE:g} {side} "
                f"its first guess {parameter.written}; write a better first guess"
            )


def _other_minima(fit: Fit) -> Iterator[str]:
    best = fit.minima[0]
    unit = max(best.squares / max(fit.freedom, 1), 1.0)
    for other in fit.minima[1:]:
        far = np.abs(other.x - best.x) > np.maximum(np.array(fit.uncertainty.halves), DISTANCE)
        if far.any() and other.squares - best.squares < _AS_GOOD * unit:
            values = ", ".join(
                f"{parameter.key} = {parameter.text(math.exp(x))}"
                for parameter, x in zip(fit.parameters, other.x.tolist(), strict=True)
            )
            yield (
                f"the fit is not unique: from another start the search found {values}, which "
                "explains the data equally well"
            )
            return


def _unexplained(fit: Fit) -> Iterator[str]:

    if fit.measured.deviation is None or fit.freedom < 1:
        return
    squares = (fit.residuals / np.hypot(fit.weights, fit.deviations.model)) ** 2
    if squares.sum() > chi2.ppf(1 - _UNLIKELY, fit.freedom):
        rms = math.sqrt(squares.mean())
        yield (
            f"the case does not explain the data: residuals are {rms:.2g} times their standard "
            "deviations, which include those due to surface, grid and model; check the values that "
            "are not free, such as elasticity, adhesion and the shape of the roughness"
        )


def _unresolved(fit: Fit) -> Iterator[str]:
    few = int((~fit.resolved).sum())
    if few:
        yield (
            f"the grid does not resolve the contact at {few} of "
            f"{counted(fit.resolved.size, 'measured point')}, and unresolved points get less "
            "weight; use grid.refine or a smaller grid.spacing"
        )


def _unknown(fit: Fit) -> Iterator[str]:
    if fit.deviations.grid is None:
        yield (
            "the intervals do not include the error of the grid, because the case could not be "
            "solved on cells twice as large"
        )
