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


def resolved(law: Law, name: str) -> Array:
    """Values of the field `name` at the points that the grid resolves."""
    return law.column(name, resolved=True)


def stiffness(law: Law, exponent: float) -> float:
    """Stiffness k₁ (N/mⁿ) of a spring with F = k₁δⁿ, where n is `exponent`.

    The geometric mean over the points, from F^{1+1/n} = (n + 1) k₁^{1/n} W with the loading work W.
    """
    force, work, n = resolved(law, "force"), resolved(law, "loading_work"), exponent
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

    `restitution` may return several rows, each compared with the points; `others` has more
    residuals.
    """
    V, e = resolved(law, "velocity"), resolved(law, "restitution")

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

    The sum can have several minima, and be constant near `start`: without yielding, COR does not
    depend on the yield pressure. So the sum is computed at many points, and the best ones start a
    search.
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
    """Compare `restitution` of a fitted law with the COR of `law`."""
    V = law.column("velocity")
    fitted = np.where(law.fits_hold_at(V), restitution(V), np.nan)
    miss = fitted - law.column("restitution")
    miss = miss[np.isfinite(fitted) & law.column("resolved").astype(bool)]
    if not miss.size:
        miss, note = np.ones(1), "has no value at these velocities"
    return FittedLaw(
        name=name,
        source=source,
        fitted_to=fitted_to,
        parameters=parameters,
        ends=ends,
        restitution=tuple(None if math.isnan(e) else float(e) for e in fitted),
        rms=float(np.sqrt(np.mean(miss**2))),
        worst=float(np.abs(miss).max()),
        note=note,
    )
