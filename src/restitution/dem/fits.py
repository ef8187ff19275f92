"""Force laws of DEM codes, fitted to a computed law.

The fits use the resolved points, which are the impact velocities at which the grid resolves the
contact. The force laws are fitted to COR by least squares, except `thornton-ning-force`, which is
fitted to the maximum forces. Models with adhesion (`luding`, `eepa`) are also fitted to the pull-
off forces. COR does not determine the loading stiffness of spring models. This stiffness is chosen
such that the model and the computation have the same geometric mean of the maximum forces. The
duration and depth of contacts then agree on average, too. The parameters of a fitted law are stored
together with its COR at the points.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from functools import partial
from itertools import product
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from restitution.laws.compact_fit import FEWEST, compact_fit
from restitution.laws.from_results import bare_law
from restitution.laws.law import LOSS, Array, FittedLaw, Law
from restitution.theory import EEPA, JKR, MDR, Luding, ThorntonNing, WaltonBraun

NAMES = (
    "constant",
    "thornton-ning-force",
    "thornton-ning",
    "walton-braun",
    "luding",
    "eepa",
    "lammps-mdr",
)
"""The force laws, in the order in which they are fitted."""
Parameters = dict[str, float]
Begin = Callable[[str, int, int], None]
"""Called before each fit: name of the force law, number of the fit (from 1), number of fits."""

# COR of mdr jumps at the velocity of first yield. In LAMMPS this velocity differs slightly from
# that of `theory.MDR`. Each point is therefore compared with COR of mdr at three velocities: that
# of the point, and those smaller and larger by this fraction.
_JUMP = 0.02
# In the fits of adhesive models, a relative difference of the pull-off force counts as much as this
# multiple of it in e: 10 % of the force as 0.01 of e.
_PULL_OFF = 0.1
_ZERO = 1e-9  # adhesive parameters below this share of their scale are 0
_AT_FORCE_ZERO = "separation, where the force is back to zero"
_MOST = 1e6  # largest ratio of unloading to loading stiffness
# Possible starting points of the searches. Only the best _SEARCHES of these points are used. If the
# fit has one parameter, the points vary this parameter (_SHIFTS); otherwise they vary the first two
# (_FEWER_SHIFTS). The values are natural logarithms of the parameter divided by its first guess.
_SHIFTS = tuple(np.linspace(-7.0, 7.0, 71))
_FEWER_SHIFTS = (-4.5, -3.0, -1.5, 0.0, 1.5, 3.0), (-4.0, -2.0, 0.0, 1.0, 2.0)
_SEARCHES = 3, 15  # with one parameter and with several parameters


def fit_law(out: Path, begin: Begin | None = None) -> Law:
    """Make the law of the results in the folder `out`, with its compact fit and its force laws.

    Raises the errors of `bare_law`.
    """
    law = bare_law(out)
    return replace(law, fit=compact_fit(law), laws=fitted_laws(law, begin))


def fitted_laws(law: Law, begin: Begin | None = None) -> tuple[FittedLaw, ...]:
    """Fit all applicable force laws to `law`.

    The fits use only the points that the grid resolves. The result is empty if there are no such
    points, or if COR is 1 at all of them.
    """
    if _seen(law, "restitution").min(initial=1.0) > 1 - LOSS:
        return ()
    fits, found = _all(law), []
    for number, name in enumerate(NAMES, 1):
        if begin is not None:
            begin(name, number, len(NAMES))
        if (each := next(fits, None)) is None:
            break
        found.append(each)
    return tuple(found)


def too_few_points(law: Law) -> str:
    """Warn if force laws are fitted to fewer points than a compact fit needs; "" otherwise."""
    count = _seen(law, "velocity").size
    if not law.laws or count >= FEWEST:
        return ""
    return (
        f"the force laws are fitted to {count} resolved velocities, "
        f"but a reliable fit needs {FEWEST} or more; give more velocities, or resolve more of them "
        'with grid.refine = "auto" or a smaller grid.spacing, and run the case again'
    )


def _all(law: Law) -> Iterator[FittedLaw]:
    yield _constant(law)
    if _seen(law, "restitution").max() < LOSS or _seen(law, "force").max() <= 0:
        return  # the other laws can fit neither a sticking pair nor purely tensile forces
    yield from _thornton_ning(law)
    yield _walton_braun(law)
    yield _luding(law)
    yield _eepa(law)
    if (found := _mdr(law)) is not None:
        yield found


def _constant(law: Law) -> FittedLaw:
    mean = float(_seen(law, "restitution").mean())
    return _judged(
        law,
        "constant",
        lambda V: np.full_like(V, mean),
        {"restitution": mean},
        source="one coefficient of restitution for all velocities, as in most contact models",
        ends="as defined by the DEM code",
    )


def _thornton_ning(law: Law) -> Iterator[FittedLaw]:
    """Fit the yield pressure p_y in two ways: to the maximum forces, and to COR."""
    smooth = law.radius, law.contact_modulus
    V, force = _seen(law, "velocity"), _seen(law, "force")

    def forces(x: Array) -> Array:
        bodies = ThorntonNing(*smooth, math.exp(x[0]))
        F = bodies.loading_force(bodies.indentation_from_velocity(V, law.mass))
        return np.asarray(np.log(F / np.maximum(force, 1e-300)))[force > 0]

    def restitution(velocity: Array, p_y: float, V_s: float) -> Array:
        e_p = ThorntonNing(*smooth, p_y).restitution(velocity, law.mass)
        return np.asarray(np.sqrt(np.maximum(e_p**2 - (V_s / velocity) ** 2, 0.0)))

    source = "C. Thornton, Z. Ning, Powder Technology 99 (1998) 154-162"
    begin = math.log(law.yield_pressure or 0.01 * law.contact_modulus)
    V_s = law.sticks_below or law.smooth_sticking_velocity or 0.0

    p_y = math.exp(_least_squares(forces, [begin])[0])
    yield _judged(
        law,
        "thornton-ning-force",
        lambda v: restitution(v, p_y, V_s),
        {"yield_pressure_Pa": p_y, **_adhesion_of(law, V_s)},
        source=source,
        ends=_AT_FORCE_ZERO,
        fitted_to="the largest force at each velocity",
    )

    scale = law.lowest
    adhesive = V_s > 0
    x = _fit_restitution(
        law,
        lambda v, x: restitution(v, math.exp(x[0]), scale * x[1] if adhesive else 0.0),
        [begin, V_s / scale][: 1 + adhesive],
        [-np.inf, 0.0][: 1 + adhesive],
    )
    found = scale * float(x[1]) if adhesive else 0.0
    yield _judged(
        law,
        "thornton-ning",
        lambda v: restitution(v, math.exp(x[0]), found),
        {"yield_pressure_Pa": math.exp(x[0]), **_adhesion_of(law, found)},
        source=source,
        ends=_AT_FORCE_ZERO,
    )


def _adhesion_of(law: Law, V_s: float) -> Parameters:
    """Sticking velocity V_s, and the work of adhesion of smooth elastic bodies with this V_s.

    The result is empty if V_s is 0.
    """
    if V_s <= 0:
        return {}
    unit = JKR(law.radius, law.contact_modulus, 1.0).sticking_velocity(law.mass)
    return {
        "sticking_velocity_m_per_s": V_s,
        "work_of_adhesion_J_per_m2": float((V_s / unit) ** 1.2),
    }


def _walton_braun(law: Law) -> FittedLaw:
    k1 = _stiffness(law, exponent=1.0)
    # Hardening increases the unloading stiffness with the velocity. With the hardening `scale`, the
    # increase at the highest velocity is k1.
    scale = math.sqrt(k1 / law.mass) / law.highest

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m": k1,
            "unloading_stiffness_N_per_m": k1 * math.exp(x[0]),
            "hardening_per_m": scale * float(x[1]) ** 2,
        }

    return _fitted_springs(
        law,
        "walton-braun",
        WaltonBraun,
        springs,
        [0.1, 1.0],
        [0.0, 0.0],
        source="O. R. Walton, R. L. Braun, J. Rheology 30 (1986) 949-980; k2 = k_u + S F_max",
        ends=_AT_FORCE_ZERO,
    )


def _luding(law: Law) -> FittedLaw:
    k1 = _stiffness(law, exponent=1.0)
    deepest = law.highest * math.sqrt(law.mass / k1)

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m": k1,
            "limit_stiffness_N_per_m": k1 * math.exp(x[0]),
            "adhesive_stiffness_N_per_m": k1 * _or_zero(x[2]) if adhesive else 0.0,
            "plasticity_depth": deepest / (2 * law.radius) * math.exp(x[1]),
        }

    adhesive = [0.1] if law.work_of_adhesion > 0 else []
    stiff = -2 * math.log(max(float(_seen(law, "restitution").mean()), 0.05))
    return _fitted_springs(
        law,
        "luding",
        partial(Luding, law.radius),
        springs,
        [stiff, -2.0, *adhesive],
        [1e-9, -15.0, *(0.0 for _ in adhesive)],
        source="S. Luding, Granular Matter 10 (2008) 235-246; plasticity depth of 2 R*",
        ends="indentation zero" if adhesive else _AT_FORCE_ZERO,
    )


def _eepa(law: Law) -> FittedLaw:
    n = 1.5
    k1 = _stiffness(law, exponent=n)
    known, pulls = _pull_off(law)
    force = float(pulls.mean()) if known.size else float(np.abs(_seen(law, "force")).min()) or 1.0

    def springs(x: Array) -> Parameters:
        return {
            "loading_stiffness_N_per_m_n": k1,
            "unloading_stiffness_N_per_m_n": k1 * math.exp(x[0]),
            "adhesive_stiffness_N_per_m_n": k1 * _or_zero(x[1]) if adhesive else 0.0,
            "constant_force_N": -force * _or_zero(x[2]) if adhesive else 0.0,
            "exponent": n,
        }

    adhesive = [0.01, 0.5 if known.size else 0.01] if law.work_of_adhesion > 0 else []
    return _fitted_springs(
        law,
        "eepa",
        EEPA,
        springs,
        [1.0, *adhesive],
        [0.0, *(0.0 for _ in adhesive)],
        source="S. C. Thakur et al., Granular Matter 16 (2014) 383-400; exponent fixed at 3/2",
        ends="indentation zero" if adhesive else _AT_FORCE_ZERO,
        note="" if adhesive else "without adhesion e is the same at every velocity",
    )


def _fitted_springs(
    law: Law,
    name: str,
    theory: Callable[..., Any],
    springs: Callable[[Array], Parameters],
    start: list[float],
    low: list[float],
    **words: str,
) -> FittedLaw:
    """Fit a spring model to COR and, if it has adhesion, to the pull-off forces of the points.

    `springs` computes the parameters of the model, in the order of the arguments of `theory`, from
    an array of unknowns. The fit begins with the values `start` and keeps them at or above `low`.
    `words` are passed to `judged`.
    """

    def model(x: Array) -> Any:
        return theory(*springs(x).values())

    def pull_off(x: Array) -> Array:
        """Fitted divided by computed pull-off force, minus 1, at the points that have one."""
        fitted = model(x)
        deepest = fitted.indentation_from_velocity(known, law.mass)
        return np.asarray(fitted.pull_off_force(deepest) / pulls - 1)

    known, pulls = _pull_off(law)
    # Walton and Braun's springs know no adhesion.
    adhesive = (
        law.work_of_adhesion > 0
        and known.size > 0
        and hasattr(model(np.array(start)), "pull_off_force")
    )
    x = _fit_restitution(
        law,
        lambda V, x: model(x).restitution(V, law.mass),
        start,
        low,
        others=(lambda x: _PULL_OFF * pull_off(x)) if adhesive else None,
    )
    fit = _judged(law, name, lambda V: model(x).restitution(V, law.mass), springs(x), **words)
    if not adhesive:
        return fit
    worst = float(np.abs(pull_off(x)).max())
    note = f"the pull-off force is within {100 * worst:.2g} % of the computed one"
    return replace(
        fit,
        fitted_to="the coefficient of restitution and the pull-off force",
        pull_off_misfit=worst,
        note="; ".join(filter(None, (fit.note, note))),
    )


def _pull_off(law: Law) -> tuple[Array, Array]:
    """Velocities (m/s) of the resolved points with a pull-off force, and these forces (N)."""
    V, forces = _seen(law, "velocity"), _seen(law, "pull_off_force")
    known = forces > 0
    return V[known], forces[known]


def _or_zero(share: float) -> float:
    """A parameter in units of its scale; 0 if it has no effect."""
    return float(share) if share > _ZERO else 0.0


def _mdr(law: Law) -> FittedLaw | None:
    """Fit the model mdr of LAMMPS. Returns None for two unlike spheres.

    The model describes a sphere on a rigid flat. Two equal spheres act like two such contacts in
    series.
    """
    sphere = law.second if law.first.wall else law.first  # a pair has at most one wall
    nu = max(sphere.poissons_ratio, 0.0)
    E = law.contact_modulus * (1 - nu**2)
    if law.first.wall or law.second.wall:
        share, mass = 1.0, law.mass
    elif law.first.may_equal(law.second):
        share, mass, E = 0.5, 2 * law.mass, 2 * E
    else:
        return None

    def restitution(V: Array, x: Array) -> Array:
        return MDR(sphere.radius or math.nan, E, nu, math.exp(x[0])).restitution(share * V, mass)

    def restitution_near_jump(V: Array, x: Array) -> Array:
        return restitution(np.array([[1 - _JUMP], [1.0], [1 + _JUMP]]) * V, x)

    start = math.log((law.yield_pressure or 0.03 * law.contact_modulus) / 2.8)
    x = _fit_restitution(law, restitution_near_jump, [start], [start - 7], high=[start + 7])
    return _judged(
        law,
        "lammps-mdr",
        lambda V: restitution(V, x),
        {"yield_strength_Pa": math.exp(x[0]), "youngs_modulus_Pa": E, "poissons_ratio": nu},
        source="W. Zunker, K. Kamrin, J. Mech. Phys. Solids 183 (2024) 105492, as in LAMMPS",
        ends=_AT_FORCE_ZERO,
        note="without the adhesion of the model" if law.work_of_adhesion > 0 else "",
    )


def _seen(law: Law, name: str) -> Array:
    """Values of the field `name` at the points that the grid resolves."""
    return law.column(name, resolved=True)


def _stiffness(law: Law, exponent: float) -> float:
    """Stiffness k₁ (N/mⁿ) of a spring with the loading curve F = k₁δⁿ, where n is `exponent`.

    At each resolved point, k₁ follows from the maximum force F and the loading work W:
    F^{1+1/n} = (n + 1) k₁^{1/n} W. The result is the geometric mean over the points.
    """
    force, work, n = _seen(law, "force"), _seen(law, "loading_work"), exponent
    some = (force > 0) & (work > 0)
    k1 = (force[some] ** (1 + 1 / n) / ((n + 1) * work[some])) ** n
    return float(np.exp(np.log(k1).mean()))


def _fit_restitution(
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
    V, e = _seen(law, "velocity"), _seen(law, "restitution")

    def misfit(x: Array) -> Array:
        residuals = np.ravel(np.nan_to_num(restitution(V, x)) - e)
        return residuals if others is None else np.append(residuals, np.nan_to_num(others(x)))

    return _least_squares(misfit, start, low, high)


def _least_squares(
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


def _judged(
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
