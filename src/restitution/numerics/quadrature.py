"""Numerical integration of tabulated curves, and adaptive integration of expensive functions."""

from __future__ import annotations

import itertools
from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike


def integrate_curve(x: ArrayLike, f: ArrayLike) -> float:
    """Integral of the monotone cubic interpolant (PCHIP) of the points (x, f).

    Unlike the trapezoidal rule, PCHIP is not biased on a convex curve, and it never overshoots.
    """
    from scipy.interpolate import PchipInterpolator

    x, f = np.asarray(x, dtype=float), np.asarray(f, dtype=float)
    if x.size < 2:
        return 0.0
    if x[0] > x[-1]:
        return -integrate_curve(x[::-1], f[::-1])
    return float(PchipInterpolator(x, f).integrate(x[0], x[-1]))


def integrate_adaptively(
    f: Callable[[float], float],
    a: float,
    b: float,
    f_a: float,
    f_b: float,
    tolerance: float,
    *,
    depth: int = 12,
    panels: int = 1,
) -> tuple[float, float]:
    """Adaptive Simpson integral of `f` over [a, b], and an estimate of its error (Lyness 1969).

    For expensive integrands with known end values `f_a` and `f_b`. Intervals are processed from
    left to right, so that `f` may start from its previous result. `tolerance` is absolute. After
    `depth` bisections an interval is accepted even if its error is too large. More initial `panels`
    help an integrand that is zero up to first yield, whose error estimate may be wrongly zero.
    """
    edges = [*(a + (b - a) * k / panels for k in range(panels)), b]
    value, error, left = 0.0, 0.0, f_a
    for low, high in itertools.pairwise(edges):
        middle = f(0.5 * (low + high))
        right = f_b if high is b else f(high)
        part, part_error = _refine(f, low, high, left, middle, right, tolerance / panels, depth)
        value, error, left = value + part, error + part_error, right
    return value, error


def _refine(
    f: Callable[[float], float],
    a: float,
    b: float,
    f_a: float,
    f_m: float,
    f_b: float,
    tolerance: float,
    depth: int,
) -> tuple[float, float]:
    m, h = 0.5 * (a + b), b - a
    f_l, f_r = f(0.5 * (a + m)), f(0.5 * (m + b))
    whole = h / 6 * (f_a + 4 * f_m + f_b)
    halves = h / 12 * (f_a + 4 * f_l + 2 * f_m + 4 * f_r + f_b)
    # For a smooth integrand, the error of `halves` is |halves − whole|/15. The estimate below is
    # 15 times as large, because the integrand may have kinks.
    error = abs(halves - whole)
    if error <= tolerance or depth == 0:
        return halves + (halves - whole) / 15, error
    left = _refine(f, a, m, f_a, f_l, f_m, tolerance / 2, depth - 1)
    right = _refine(f, m, b, f_m, f_r, f_b, tolerance / 2, depth - 1)
    return left[0] + right[0], left[1] + right[1]
