"""The compact fit of a law: COR (e) against velocity (V) with a few coefficients.

    e² = Σ c_k L^k − s/V²,   L = ln(V/V₀)/w in [−1, 1]

V₀ is the geometric mean of the lowest and highest velocity, and w scales ln(V/V₀) to the interval
[−1, 1]. The term s/V² is the loss by adhesion, which is the same energy at every velocity. For an
elastic pair s is the square of the sticking velocity (Thornton & Ning 1998). The polynomial
describes the loss by yielding. Low velocities at which nothing is lost (e = 1) or the pair sticks
(e = 0) are excluded, except the highest of these velocities.

The fit is linear least squares in e². The error between the points is estimated by the larger of
two values: the largest residual, and the largest leave-one-out residual (as in PRESS, Allen 1974,
but with the maximum instead of the sum). The polynomial has the lowest degree whose error is below
0.001 or at most 1.1 times the smallest error of all degrees.
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from restitution.laws.law import CompactFit, Law

Array = NDArray[np.float64]

_HIGHEST_DEGREE = 8
_FEWEST = 4  # smallest number of points for a fit
_NO_LOSS = 1e-3  # a point counts as lossless if 1 − e² is below this value
_SIMPLER = 1.1  # a lower degree is preferred if its error is at most 1.1 times the smallest error
_GOOD = 1e-3  # a lower degree is always preferred if its error of e is below this value
_COUNTS = 0.01  # decrease of e² due to adhesion at the velocity `adhesive_below`


def compact_fit(law: Law) -> CompactFit | None:
    """Fit the compact formula to the resolved points of `law`; None if there are too few points."""
    V, ratio = law.column("velocity", resolved=True), law.column("ratio", resolved=True)
    lossless = law.work_of_adhesion == 0
    first = 0
    while lossless and first < V.size and ratio[first] > 1 - _NO_LOSS:
        first += 1
    # Keep the last lossless (or sticking) point, because it fixes the polynomial at the low end.
    first = max(first - 1, 0)
    sticks = law.sticks_below
    used = slice(first, None)
    if sticks is not None:
        used = slice(max(int(np.searchsorted(V, sticks)) - 1, 0), None)
    v, e2 = V[used], ratio[used]
    if v.size < _FEWEST:
        return None
    centre = math.sqrt(v[0] * v[-1])
    width = 0.5 * math.log(v[-1] / v[0])
    degree, adhesion = _best(v, e2, centre, width, law.work_of_adhesion > 0)
    solution = _solve(v, e2, centre, width, degree, adhesion)
    s = float(solution[-1]) if adhesion else 0.0
    fit = CompactFit(
        coefficients=tuple(float(c) for c in solution[: degree + 1]),
        centre=centre,
        width=width,
        adhesion=s,
        sticks_below=sticks,
        elastic_below=float(V[first]) if first else None,
        adhesive_below=math.sqrt(s / _COUNTS) if s > 0 else None,
        lowest=float(V[0]),
        highest=float(V[-1]),
        worst=0.0,
        between=_left_out(v, e2, centre, width, degree, adhesion),
    )
    worst = np.abs(fit.restitution(V) - law.column("restitution", resolved=True)).max()
    return fit.model_copy(update={"worst": float(worst), "between": max(fit.between, float(worst))})


def _best(v: Array, e2: Array, centre: float, width: float, adhesive: bool) -> tuple[int, bool]:
    """Choose the lowest degree with a small error, and whether to include the adhesion term."""
    errors = {
        (degree, adhesion): max(
            _left_out(v, e2, centre, width, degree, adhesion),
            _misfit(v, e2, centre, width, degree, adhesion),
        )
        for degree in range(min(_HIGHEST_DEGREE, v.size - 3) + 1)
        for adhesion in {False, adhesive}
        if _solve(v, e2, centre, width, degree, adhesion)[-1] >= 0 or not adhesion
    }
    good = max(_SIMPLER * min(errors.values()), _GOOD)
    return min(key for key, error in errors.items() if error <= good)


def _basis(v: Array, centre: float, width: float, degree: int, adhesion: bool) -> Array:
    L = np.log(v / centre) / width
    basis = np.vander(L, degree + 1, increasing=True)
    return np.column_stack([basis, -1 / v**2]) if adhesion else basis


def _solve(v: Array, e2: Array, centre: float, width: float, degree: int, adhesion: bool) -> Array:
    basis = _basis(v, centre, width, degree, adhesion)
    scale = np.abs(basis).max(axis=0)
    solution: Array = np.linalg.lstsq(basis / scale, e2, rcond=None)[0] / scale
    return solution


def _misfit(v: Array, e2: Array, centre: float, width: float, degree: int, adhesion: bool) -> float:
    """Largest residual of e at the points."""
    fitted = _basis(v, centre, width, degree, adhesion) @ _solve(
        v, e2, centre, width, degree, adhesion
    )
    return float(np.abs(np.sqrt(np.clip(fitted, 0, 1)) - np.sqrt(np.clip(e2, 0, 1))).max())


def _left_out(
    v: Array, e2: Array, centre: float, width: float, degree: int, adhesion: bool
) -> float:
    """Largest leave-one-out residual of e at the inner points."""
    worst = 0.0
    for k in range(1, v.size - 1):
        keep = np.arange(v.size) != k
        solution = _solve(v[keep], e2[keep], centre, width, degree, adhesion)
        e2_k = float((_basis(v[k : k + 1], centre, width, degree, adhesion) @ solution)[0])
        miss = math.sqrt(min(max(e2_k, 0.0), 1.0)) - math.sqrt(min(max(float(e2[k]), 0.0), 1.0))
        worst = max(worst, abs(miss))
    return worst
