"""State in words whether a fit determines its parameters and explains the data."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from restitution.display import counted
from restitution.fit.fit import Fit
from restitution.fit.least_squares import DISTANCE, RANGE

WIDEST = 4.0
"""A parameter is not identifiable if its 95 % interval spans more than this factor."""
_CORRELATED = 0.99  # correlation above which two parameters cannot be told apart

# A parameter has no effect if doubling it changes the residuals by less than this number of
# standard deviations.
_NO_EFFECT = 0.3
# Another minimum explains the data equally well if its χ² exceeds the χ² of the best minimum by
# less than this value. If the best minimum has a reduced χ² above 1, this value is multiplied by
# the reduced χ². The value is 4, because a parameter that is off by two standard deviations
# increases χ² by 4.
_AS_GOOD = 4.0
# A combination is a product of powers of parameters. It omits parameters whose exponent has a
# magnitude below this value.
_SHARE = 0.1
# The case does not explain the data if residuals at least as large as the actual ones have a
# probability below this value.
_UNLIKELY = 0.01


def identifiable(found: Fit, parameter: int) -> bool:
    """Whether the 95 % interval of a parameter spans at most a factor of `WIDEST`."""
    return found.uncertainty.halves[parameter] <= 0.5 * math.log(WIDEST)


def findings(found: Fit) -> list[str]:
    """Write one sentence for each problem of the fit, the most serious problem first."""
    return [
        *_not_identifiable(found),
        *_correlated(found),
        *_bounds(found),
        *_other_minima(found),
        *_unexplained(found),
        *_unresolved(found),
        *_unknown(found),
    ]


def interval_in_words(found: Fit, k: int, *, model: bool = False) -> str:
    """Format the 95 % interval of a parameter in the unit of the case file.

    With `model`, the interval includes the error of the model.
    """
    uncertainty, x, parameter = found.uncertainty, float(found.x[k]), found.parameters[k]
    half = (uncertainty.combined_halves if model else uncertainty.halves)[k]
    if math.isinf(half):
        return "unbounded"
    return f"{parameter.text(math.exp(x - half))} to {parameter.text(math.exp(x + half))}"


def combination(found: Fit) -> tuple[dict[str, float], float] | None:
    """Find the combination, a product of powers of parameters, that the data determine best.

    Returns a dictionary with the exponent of each key, and the half-width of the 95 % interval of
    the logarithm of the product. Returns None for a single parameter, or if even this product is
    not identifiable.
    """
    direction = found.uncertainty.best_direction
    half = found.uncertainty.half(direction)
    if len(found.parameters) < 2 or half > 0.5 * math.log(WIDEST):
        return None
    exponents = zip((each.key for each in found.parameters), direction.tolist(), strict=True)
    return {key: value for key, value in exponents if abs(value) >= _SHARE}, half


def _not_identifiable(found: Fit) -> Iterator[str]:
    lost = [k for k in range(found.x.size) if not identifiable(found, k)]
    for k in lost:
        parameter = found.parameters[k]
        if found.uncertainty.effect(k) < _NO_EFFECT:
            yield (
                f"{parameter.key} is not identifiable from these data: restitution at these "
                f"velocities does not depend on it near {parameter.text(found.factors[k])}"
            )
            continue
        half = found.uncertainty.halves[k]
        spans = (
            "is unbounded" if math.isinf(half) else f"spans a factor of {math.exp(2 * half):.2g}"
        )
        yield (
            f"{parameter.key} is not identifiable from these data: its 95 % interval {spans} "
            f"({interval_in_words(found, k)})"
        )
    known = combination(found) if lost else None
    if known is not None and len(known[0]) > 1:
        yield f"the data determine only the combination {product_in_words(*known)}"


def product_in_words(exponents: dict[str, float], half: float) -> str:
    """Format a product of powers of parameters, with its 95 % interval in percent.

    `half` is the half-width of the 95 % interval of the logarithm of the product.
    """
    factors = [key if power == 1 else f"{key}^{power:.2f}" for key, power in exponents.items()]
    percent = 100 * (math.exp(half) - 1)
    return f"{' * '.join(factors)} (within {percent:.2g} %)"


def _correlated(found: Fit) -> Iterator[str]:
    r = found.uncertainty.correlation
    for i, j in np.argwhere(np.tril(np.abs(r) > _CORRELATED, -1)).tolist():
        if identifiable(found, i) and identifiable(found, j):
            one, other = found.parameters[j].key, found.parameters[i].key
            yield (
                f"{one} and {other} cannot be told apart by these data (correlation "
                f"{r[i, j]:.3f}): a change of one compensates for a change of the other"
            )


def _bounds(found: Fit) -> Iterator[str]:
    for parameter, x in zip(found.parameters, found.x.tolist(), strict=True):
        if abs(x) > 0.99 * math.log(RANGE):  # x = ln(value/first guess)
            side = "above" if x > 0 else "below"
            yield (
                f"{parameter.key} ended at the limit of the search, a factor of {RANGE:g} {side} "
                f"its first guess {parameter.written}; write a better first guess"
            )


def _other_minima(found: Fit) -> Iterator[str]:
    """Report at most one other minimum of the search that explains the data equally well."""
    best = found.minima[0]
    unit = max(best.squares / max(found.freedom, 1), 1.0)
    for other in found.minima[1:]:
        far = np.abs(other.x - best.x) > np.maximum(np.array(found.uncertainty.halves), DISTANCE)
        if far.any() and other.squares - best.squares < _AS_GOOD * unit:
            values = ", ".join(
                f"{parameter.key} = {parameter.text(math.exp(x))}"
                for parameter, x in zip(found.parameters, other.x.tolist(), strict=True)
            )
            yield (
                f"the fit is not unique: from another start the search found {values}, which "
                "explains the data equally well"
            )
            return


def _unexplained(found: Fit) -> Iterator[str]:
    from scipy.stats import chi2

    if found.measured.deviation is None or found.freedom < 1:
        return
    squares = (found.residuals / np.hypot(found.weights, found.deviations.model)) ** 2
    if squares.sum() > chi2.ppf(1 - _UNLIKELY, found.freedom):
        rms = math.sqrt(squares.mean())
        yield (
            f"the case does not explain the data: residuals are {rms:.2g} times their standard "
            "deviations, which include those due to surface, grid and model; check the values that "
            "are not free, such as elasticity, adhesion and the shape of the roughness"
        )


def _unresolved(found: Fit) -> Iterator[str]:
    few = int((~found.resolved).sum())
    if few:
        yield (
            f"the grid does not resolve the contact at {few} of "
            f"{counted(found.resolved.size, 'measured point')}, and unresolved points get less "
            "weight; use grid.refine or a smaller grid.spacing"
        )


def _unknown(found: Fit) -> Iterator[str]:
    if found.deviations.grid is None:
        yield (
            "the intervals do not include the error of the grid, because the case could not be "
            "solved on cells twice as large"
        )
