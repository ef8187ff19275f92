"""The compact fit of a law: e² = Σ c_k L^k − s/V², L = ln(V/V₀)/w in [−1, 1].

V₀ is the geometric mean of the ends. s/V² is a loss by adhesion, the polynomial the loss by
yielding. The fit is linear least squares in e²; its error between the points is the larger of the
largest residual and the largest leave-one-out residual (as in PRESS, Allen 1974, but the maximum).
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from restitution.laws.law import Array, CompactFit, Law

_HIGHEST_DEGREE = 8
FEWEST = 4
"""Smallest number of points for a fit."""
_NO_LOSS = 1e-3  # a point counts as lossless if 1 − e² is below this value
# The fit uses the lowest degree whose error in e is at most `_GOOD`, or at most `_SIMPLER` times
# the smallest error of all degrees.
_SIMPLER = 1.1
_GOOD = 1e-3
_COUNTS = 0.01  # at the velocity `adhesive_below`, adhesion lowers e² by this value


def compact_fit(law: Law) -> CompactFit | None:
    """Fit the points of `law` that the grid resolves; None if there are too few."""
    V, ratio = law.column("velocity", resolved=True), law.column("ratio", resolved=True)
    lossless = int(np.append(ratio <= 1 - _NO_LOSS, True).argmax())  # number of lossless points
    # Keep the last lossless (or sticking) point, because it ties the polynomial to e = 1 (or e = 0)
    # at the lowest velocities.
    first = max(lossless - 1, 0) if law.work_of_adhesion == 0 else 0
    sticks = law.sticks_below
    begin = first if sticks is None else max(int(np.searchsorted(V, sticks)) - 1, 0)
    v, e2 = V[begin:], ratio[begin:]
    if v.size < FEWEST:
        return None
    centre = math.sqrt(v[0] * v[-1])
    width = 0.5 * math.log(v[-1] / v[0])
    L = np.log(v / centre) / width
    degree, adhesion = _best(v, L, e2, law.work_of_adhesion > 0)
    basis = _basis(v, L, degree, adhesion)
    solution = _solve(basis, e2)
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
        between=_left_out(basis, e2),
    )
    worst = np.abs(fit.restitution(V) - law.column("restitution", resolved=True)).max()
    return replace(fit, worst=float(worst), between=max(fit.between, float(worst)))


def _best(v: Array, L: Array, e2: Array, adhesive: bool) -> tuple[int, bool]:
    bases = {
        (degree, adhesion): _basis(v, L, degree, adhesion)
        for degree in range(min(_HIGHEST_DEGREE, v.size - 3) + 1)
        for adhesion in {False, adhesive}
    }
    errors = {
        key: max(_left_out(basis, e2), _misfit(basis @ _solve(basis, e2), e2))
        for key, basis in bases.items()
        if _solve(basis, e2)[-1] >= 0 or not key[1]
    }
    good = max(_SIMPLER * min(errors.values()), _GOOD)
    return min(key for key, error in errors.items() if error <= good)


def _basis(v: Array, L: Array, degree: int, adhesion: bool) -> Array:
    basis = np.vander(L, degree + 1, increasing=True)
    return np.column_stack([basis, -1 / v**2]) if adhesion else basis


def _solve(basis: Array, e2: Array) -> Array:
    scale = np.abs(basis).max(axis=0)
    solution: Array = np.linalg.lstsq(basis / scale, e2, rcond=None)[0] / scale
    return solution


def _misfit(fitted: Array, e2: Array) -> float:
    return float(np.abs(np.sqrt(np.clip(fitted, 0, 1)) - np.sqrt(np.clip(e2, 0, 1))).max())


def _left_out(basis: Array, e2: Array) -> float:
    worst = 0.0
    for k in range(1, e2.size - 1):
        others = np.arange(e2.size) != k
        fitted = basis[k : k + 1] @ _solve(basis[others], e2[others])
        worst = max(worst, _misfit(fitted, e2[k : k + 1]))
    return worst
