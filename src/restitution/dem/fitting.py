"""Least squares of force laws to the resolved points of a computed law."""

from __future__ import annotations

import math
from collections.abc import Callable
from itertools import product
from operator import attrgetter

import numpy as np

from restitution.laws.law import Array, FittedLaw, Law

Parameters = dict[str, float]
_MOST = 1e6  # largest ratio of unloading to loading stiffness
# Possible starting points of the searches. Only the best _SEARCHES of these points are used. If the
# fit has one parameter, the points vary this parameter (_SHIFTS); otherwise they vary the first two
# (_FEWER_SHIFTS). The values are natural logarithms of the parameter divided by its first guess.
_SHIFTS = tuple(np.linspace(-7.0, 7.0, 71))
_FEWER_SHIFTS = (-4.5, -3.0, -1.5, 0.0, 1.5, 3.0), (-4.0, -2.0, 0.0, 1.0, 2.0)
_SEARCHES = 3, 15  # with one parameter and with several parameters


def seen(law: Law, name: str) -> Array:
    """Values of the field `name` at the points that the grid resolves."""
    return law.column(name, resolved=True)


def stiffness(law: Law, exponent: float) -> float:
    """Stiffness k₁ (N/mⁿ) of a spring with the loading curve F = k₁δⁿ, where n is `exponent`.

    At each resolved point, k₁ follows from the maximum force F and the loading work W:
    F^{1+1/n} = (n + 1) k₁^{1/n} W. The result is the geometric mean over the points.
    """
    force, work, n = seen(law, "force"), seen(law, "loading_work"), exponent
    some = (force > 0) & (work > 0)
    k1 = (force[some] ** (1 + 1 / n) / ((n + 1) * work[some])) ** n
    return float(np.exp(np.log(k1).mean()))


def fit_restitution(
    law: Law,
    restitution: Callable[[Array, Array], Array],
    start: list[float],
    low: list[float],
    others: Callable[[Array], Array] | None = None,
    high: list[float] | None = None,
) -> Array:
    """Fit the parameters x of restitution(V, x) to the COR of the resolved points of `law`.

    The parameters stay within `low` and `high`. `restitution` may return several rows with one
    value for each point. Each row is then compared with the COR of the points.
    `others` returns further residuals.
    """
    V, e = seen(law, "velocity"), seen(law, "restitution")

    def misfit(x: Array) -> Array:
        residuals = np.ravel(np.nan_to_num(restitution(V, x)) - e)
        return residuals if others is None else np.append(residuals, np.nan_to_num(others(x)))

    return least_squares_from(misfit, start, low, high)


def least_squares_from(
    misfit: Callable[[Array], Array],
    start: list[float],
    low: list[float] | None = None,
    high: list[float] | None = None,
) -> Array:
    """Minimise the sum of squares of `misfit`, with searches from several starting points.

    The sum can have several minima, because `misfit` is not smooth. It can also be constant near
    `start`: without yielding, for example, COR does not depend on the yield pressure. Therefore,
    the sum is first computed at many points around `start`, and the searches begin at those with
    the smallest sums.
    """
    from scipy.optimize import least_squares

    low = [-np.inf] * len(start) if low is None else low
    high = [math.log(_MOST) if bound > -20 else np.inf for bound in low] if high is None else high
    shifts = [_SHIFTS] if len(start) == 1 else [*_FEWER_SHIFTS, *[(0.0,)] * (len(start) - 2)]
    begins = [np.clip(np.add(start, shift), low, high) for shift in product(*shifts)]
    begins.sort(key=lambda x: float(np.sum(misfit(x) ** 2)))
    fits = (
        least_squares(misfit, begin, bounds=(low, high), x_scale="jac", xtol=1e-10)
        for begin in begins[: _SEARCHES[len(start) > 1]]
    )
    x: Array = min(fits, key=attrgetter("cost")).x
    return x


def judged(
    law: Law,
    name: str,
    restitution: Callable[[Array], Array],
    parameters: Parameters,
    *,
    source: str,
    ends: str,
    fitted_to: str = "the coefficient of restitution",
    note: str = "",
) -> FittedLaw:
    """Make the fitted law, with its COR at the velocities of `law` and its deviations from `law`.

    `ends` states at which force or indentation the contact of the force law ends.
    """
    V = law.column("velocity")
    found = np.where(law.fits_hold_at(V), restitution(V), np.nan)
    miss = found - law.column("restitution")
    miss = miss[np.isfinite(found) & law.column("resolved").astype(bool)]
    if not miss.size:
        miss, note = np.ones(1), "has no value at these velocities"
    return FittedLaw(
        name=name,
        source=source,
        fitted_to=fitted_to,
        parameters=parameters,
        ends=ends,
        restitution=tuple(None if math.isnan(e) else float(e) for e in found),
        rms=float(np.sqrt(np.mean(miss**2))),
        worst=float(np.abs(miss).max()),
        note=note,
    )
