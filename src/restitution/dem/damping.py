"""Damping parameters with which simple contact laws have a given coefficient of restitution e.

* Linear spring and dashpot without tension, with the damping ratio ζ: e = exp(−2ζ arccos ζ/(1 −
  ζ²)^½); for ζ > 1, arccosh and ζ² − 1 (T. Schwager, T. Pöschel, Granular Matter 9 (2007) 465).
* Hunt and Crossley, F = f(x)(1 + d x′): c (1 + e) = ln((1 + c)/(1 − ec)) with c = dV, for any f
  (K. H. Hunt, F. R. E. Crossley, J. Appl. Mech. 42 (1975) 440; D. W. Marhefka, D. E. Orin, IEEE
  Trans. Syst. Man Cybern. A 29 (1999) 566).
* Hertz with a constant damping γ until x = 0: in units of L = (mV²/((4/3)E* R*^½))^⅖ and L/V, x″ =
  −x^{3/2} − g x′ with g = γL/(mV), which is proportional to V^{−⅕}; integrated numerically.
* Hertz with a damping η m a, a the contact radius (viscoelastic: N. V. Brilliantov et al., Phys.
  Rev. E 53 (1996) 5382), until x = 0: x″ = −x^{3/2} − g x^{1/2} x′, g = η (R* L)^½ L/V ∝ V^⅕.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache

import numpy as np
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

from restitution.laws.law import Array, Law

# The equation for c = dV is given at the top of this file. If 1 − e is below this value, the
# logarithm in this equation is replaced by the first terms of its power series in c.
_NEARLY_ELASTIC = 1e-4
_TOLERANCE = 1e-12  # tolerance of root finding
# If the dissipation d times the impact velocity V is below this value, the series e = 1 − ⅔ dV is
# used. It omits terms of the order (dV)². If the equation were solved for e instead, the rounding
# errors would be larger than these terms.
_SMALL = 1e-6
# Largest ζ in the search for a given e; e is below 0.001 for ζ = 20.
_LARGEST_DAMPING = 20.0
# Range of g of the viscoelastic Hertz contact: e is 0.9999 and 1e-4 at its ends.
_LEAST, _MOST = 1e-4, 30.0


def dashpot_restitution(ratio: float) -> float:
    """e of a linear spring and dashpot without tension; `ratio` is the damping ratio ζ."""
    if ratio == 1:
        return math.exp(-2)
    root = math.sqrt(abs(1 - ratio**2))
    phase = math.acos(ratio) if ratio < 1 else math.acosh(ratio)
    return math.exp(-2 * ratio * phase / root)


def dashpot_ratio(restitution: float) -> float:
    """The damping ratio ζ of a linear spring and dashpot, never tensile, with the restitution e."""
    return _root(dashpot_restitution, restitution, _LARGEST_DAMPING)


def hunt_crossley_dissipation(restitution: float) -> float:
    """Dissipation times impact velocity dV (dimensionless) for the restitution e > 0."""
    e = restitution
    if 1 - e < _NEARLY_ELASTIC:
        return 1.5 * (1 - e**2) / (1 + e**3)

    # Let c = dV. For small e, e·c is so close to 1 that 1 − e·c has a large rounding error.
    # Therefore solve for u with e·c = 1 − exp(−u).
    def excess(u: float) -> float:
        c = -math.expm1(-u) / e
        return c * (1 + e) - math.log1p(c) - u

    u = float(brentq(excess, 0.5 * e * (1 - e), 1 + 1 / e, xtol=_TOLERANCE * e, rtol=_TOLERANCE))
    return -math.expm1(-u) / e


def hunt_crossley_restitution(dissipation: float) -> float:
    """e from dissipation times impact velocity dV (dimensionless)."""
    c = dissipation
    if c < _SMALL:
        return 1.0 - 2 / 3 * c

    def excess(u: float) -> float:
        return c - math.expm1(-u) - math.log1p(c) - u

    u: float = brentq(excess, 0.0, 1 + c, xtol=_TOLERANCE * c, rtol=_TOLERANCE)
    return -math.expm1(-u) / c


def hertz_restitution(damping: float, power: float = 0.0) -> float:
    """e of a Hertz contact with the dimensionless damping g x^`power`; 0 if there is no rebound."""

    def slope(_: float, y: tuple[float, float]) -> list[float]:
        x = max(y[0], 0.0)
        return [y[1], -(x**1.5) - damping * x**power * y[1]]

    def parted(t: float, y: tuple[float, float]) -> float:
        return y[0] if t > 0 else 1.0

    parted.terminal, parted.direction = True, -1  # type: ignore[attr-defined]
    path = solve_ivp(slope, (0, 100), [0.0, 1.0], "DOP853", rtol=1e-9, atol=1e-12, events=parted)
    return float(-path.y[1, -1]) if path.status == 1 else 0.0


def hertz_damping(law: Law, velocity: float, restitution: float) -> float:
    """Damping γ (kg/s) with which a Hertz contact has `restitution` at `velocity` (m/s)."""
    g = _root(hertz_restitution, restitution, 2.0)
    return g * law.mass * velocity / _length(law, velocity)


def hertz_restitution_at(law: Law, damping: float, velocity: float) -> float:
    """e of a Hertz contact with the damping coefficient γ (kg/s) at `velocity` (m/s)."""
    return hertz_restitution(damping * _length(law, velocity) / (law.mass * velocity))


def viscoelastic_restitution_at(law: Law, damping: float, velocity: Array) -> Array:
    """e of a Hertz contact with the viscoelastic damping η (1/(m s)) at `velocity` (m/s)."""
    length = np.array([_length(law, V) for V in np.ravel(velocity).tolist()])
    g = damping * np.sqrt(law.radius * length) * length / np.ravel(velocity)
    return np.asarray(_viscoelastic_curve()(np.log(np.clip(g, _LEAST, _MOST))))


def viscoelastic_damping(law: Law) -> float:
    """The η (1/(m s)) closest to e of the resolved points of `law` in least squares."""
    V, e = (law.column(name, resolved=True) for name in ("velocity", "restitution"))
    if not V.size:
        return 0.0
    length = _length(law, float(V[-1]))
    scale = float(V[-1] / (math.sqrt(law.radius * length) * length))  # g = 1 at the highest V

    def miss(logarithm: float) -> float:
        return float(
            np.sum((viscoelastic_restitution_at(law, scale * math.exp(logarithm), V) - e) ** 2)
        )

    start = min(np.linspace(-9, 3, 49).tolist(), key=miss)
    best = minimize_scalar(miss, bounds=(start - 0.3, start + 0.3), method="bounded")
    return float(scale * math.exp(best.x))


@cache
def _viscoelastic_curve() -> CubicSpline:
    """e against ln g."""
    g = np.geomspace(_LEAST, _MOST, 48)
    return CubicSpline(np.log(g), [hertz_restitution(x, 0.5) for x in g.tolist()])


def _length(law: Law, velocity: float) -> float:
    stiffness = 4 / 3 * law.contact_modulus * math.sqrt(law.radius)
    return float((law.mass * velocity**2 / stiffness) ** 0.4)


def _root(restitution_of: Callable[[float], float], restitution: float, largest: float) -> float:
    if restitution >= 1:
        return 0.0
    return float(brentq(lambda x: restitution_of(x) - restitution, 0.0, largest, xtol=_TOLERANCE))
